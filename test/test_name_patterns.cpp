// Names in rules and restrictions, as patterns of the shell.
#include <gtest/gtest.h>

#include "collision_pairs/scene_settings.h"

namespace collision_pairs::test_name_patterns {

TEST(NamePatterns, AreThoseOfTheShell) {
  EXPECT_TRUE(matches("left_*", "left_elbow"));
  EXPECT_TRUE(matches("*", "left/elbow"));
  EXPECT_TRUE(matches("finger_?", "finger_1"));
  EXPECT_TRUE(matches("finger_[12]", "finger_2"));
  EXPECT_FALSE(matches("finger_?", "finger_12"));
  EXPECT_FALSE(matches("elbow", "elbow_2"));
  EXPECT_TRUE(isPattern("a*"));
  EXPECT_FALSE(isPattern("a-b.c/d"));
}

TEST(NamePatterns, MeanTheNameThatTheyAreToo) {
  for (const char* name : {"box[1]", "what?", "a\\b", "["})
    EXPECT_TRUE(matches(name, name)) << name;
  EXPECT_TRUE(matches("box[1]", "box1"));
  EXPECT_FALSE(matches("a\\b", "ab"));
}

}  // namespace collision_pairs::test_name_patterns
