#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs::test_input_error {

std::string said(const std::string& message) { return InputError(message).what(); }

TEST(InputErrors, AreOneLineThatNoTerminalObeys) {
  EXPECT_EQ(said("link 'a\x1b[2J\nb\x7f': Zähler 3 µm"), "link 'a [2J b ': Zähler 3 µm");
  EXPECT_EQ(said(std::string("a\0b", 3)), "a b");
}

TEST(InputErrors, OfALongValueKeepBothEndsAndWholeCharacters) {
  for (int shift = 0; shift < 2; ++shift) {
    std::string value(static_cast<std::size_t>(shift), 'x');
    for (int i = 0; i < 100000; ++i) value += "ä";
    const std::string text = said("file line 3: '" + value + "' is not a number");
    EXPECT_LE(text.size(), 1000u);
    EXPECT_THAT(text, testing::StartsWith("file line 3: '"));
    EXPECT_THAT(text, testing::EndsWith("' is not a number"));
    EXPECT_THAT(text, testing::HasSubstr("ä … ä"));
  }
  const std::string short_enough(1000, 'x');
  EXPECT_EQ(said(short_enough), short_enough);
  EXPECT_EQ(said(short_enough + 'x').size(), 1000u);  // no byte is lost that has a place
}

}  // namespace collision_pairs::test_input_error
