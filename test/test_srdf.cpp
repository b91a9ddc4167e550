#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/srdf.h"
#include "refusal.h"

namespace collision_pairs::test_srdf {

using Pairs = std::set<Srdf::LinkPair>;
const std::vector<std::string> LINKS = {"a", "b", "c", "d"};

Srdf parsed(const std::string& inner) {
  return Srdf::fromXml("<robot name='r'>" + inner + "</robot>");
}

TEST(Srdf, DisabledPairsAreOrderedAndRepeatsDoNotMatter) {
  const Srdf srdf = parsed(
      "<disable_collisions link1='c' link2='a'/><disable_collisions link1='a' link2='c'/>"
      "<disable_collisions link1='b' link2='b'/>");
  EXPECT_EQ(srdf.switchedOff(LINKS), (Pairs{{"a", "c"}}));
}

TEST(Srdf, FollowsMoveItsOrderOfDefaultEnableDisable) {
  const Srdf srdf = parsed(
      "<disable_collisions link1='a' link2='c'/>"
      "<enable_collisions link1='a' link2='b'/><enable_collisions link1='c' link2='a'/>"
      "<disable_default_collisions link='a'/>");
  EXPECT_EQ(srdf.switchedOff(LINKS), (Pairs{{"a", "c"}, {"a", "d"}}));
}

TEST(Srdf, UnknownLinksAreListedOnce) {
  const Srdf srdf =
      parsed("<disable_collisions link1='a' link2='x'/><disable_collisions link1='x' link2='y'/>");
  EXPECT_EQ(srdf.unknownLinks(LINKS), (std::vector<std::string>{"x", "y"}));
}

TEST(Srdf, BrokenTextIsRefusedWithItsLine) {
  const auto refused = [](const std::string& xml) { return refusal([&] { Srdf::fromXml(xml); }); };
  EXPECT_THAT(refused("<robot name='r'>\n<disable_collisions link1='a'/></robot>"),
              testing::HasSubstr("SRDF line 2: <disable_collisions> has no link2"));
  EXPECT_THAT(refused("<robot"), testing::HasSubstr("not well-formed"));
  EXPECT_THAT(refused(""), testing::HasSubstr("empty"));
  EXPECT_EQ(refused("<robot name='r'>\n<link name='a'/></robot>"),
            "SRDF line 2: it has a <link>, so it is a URDF");
}

}  // namespace collision_pairs::test_srdf
