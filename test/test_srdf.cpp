// SRDF as it is read, and as generate_srdf writes it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/srdf.h"
#include "generated_srdf.h"
#include "refusal.h"

namespace collision_pairs::test_srdf {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
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

const std::vector<SrdfLine> LINES = {{"in contact in 0 of 9 states", "a", "b", "Never"},
                                     {"only a remark", "", "", ""}};

TEST(GeneratedSrdf, WithoutAGivenOneIsADocumentOfThatRobot) {
  const std::string text = srdfWithLines("", "arm", LINES);
  EXPECT_THAT(text, HasSubstr("<robot name=\"arm\">"));
  EXPECT_THAT(text, HasSubstr("<!-- in contact in 0 of 9 states -->"));
  EXPECT_THAT(text, HasSubstr("reason=\"Never\""));
  EXPECT_THAT(text, HasSubstr("<!-- only a remark -->"));
  EXPECT_THAT(Srdf::fromXml(text).disabled_pairs, ElementsAre(Pair("a", "b")));
}

TEST(GeneratedSrdf, WithoutLinesIsStillADocument) {
  EXPECT_TRUE(Srdf::fromXml(srdfWithLines("", "arm", {})).disabled_pairs.empty());
}

TEST(GeneratedSrdf, KeepsEverythingThatWasGivenInItsOrder) {
  const std::string given =
      "<?xml version='1.0'?>\n<!-- head -->\n<robot name='arm' xmlns:x='y'>\n"
      "  <group name='all'><chain base_link='a' tip_link='c'/></group>\n  <!-- why -->\n"
      "  <disable_collisions link1='b' link2='c' reason='By &lt;hand&gt;'/>\n"
      "  <enable_collisions link1='a' link2='c'/>\n  <other x='1'>text</other>\n"
      "</robot>\n<!-- tail -->\n";
  const std::string text = srdfWithLines(given, "ignored", LINES);
  std::size_t last = 0;
  for (const char* piece :
       {"<!-- head -->", "<robot name=\"arm\" xmlns:x=\"y\">", "<group name=\"all\">",
        "<chain base_link=\"a\" tip_link=\"c\"/>", "<!-- why -->", "reason=\"By &lt;hand&gt;\"",
        "<enable_collisions link1=\"a\" link2=\"c\"/>", "<other x=\"1\">text</other>",
        "link1=\"a\" link2=\"b\"", "</robot>", "<!-- tail -->"}) {
    const std::size_t here = text.find(piece, last);
    ASSERT_NE(here, std::string::npos) << piece << " in " << text;
    last = here;
  }
}

TEST(GeneratedSrdf, AddingNothingChangesNothingASecondTime) {
  const std::string once =
      srdfWithLines("<robot name='arm'><a><b/></a><!-- c --></robot>", "", LINES);
  EXPECT_EQ(srdfWithLines(once, "", {}), once);
}

TEST(GeneratedSrdf, NamesOfLinksCannotEndACommentOrAnAttribute) {
  const std::string name = "a--b\"<&-->-";
  const std::string text = srdfWithLines("", "arm", {{name, name, "z", "Never"}});
  EXPECT_THAT(Srdf::fromXml(text).disabled_pairs, ElementsAre(Pair(name, "z")));
  const std::size_t begin = text.find("<!--") + 4, end = text.find("-->", begin);
  EXPECT_EQ(text.substr(begin, end - begin).find("--"), std::string::npos);
}

TEST(GeneratedSrdf, ABrokenOneIsRefusedWithItsLine) {
  const char* broken = "<robot name='arm'>\n<group>\n</robot>";
  EXPECT_THAT(refusal([&] { srdfWithLines(broken, "arm", LINES); }), HasSubstr("SRDF line"));
}

}  // namespace collision_pairs::test_srdf
