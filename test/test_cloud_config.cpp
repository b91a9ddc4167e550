#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud_config.h"
#include "collision_pairs/input_error.h"
#include "documented_defaults.h"
#include "refusal.h"

namespace collision_pairs::test_cloud_config {

using testing::AllOf;
using testing::HasSubstr;

std::vector<CloudConfig> clouds(const std::string& yaml) { return readClouds(YAML::Load(yaml)); }

std::string refusal(const std::string& yaml) {
  return collision_pairs::refusal([&] { clouds(yaml); });
}

TEST(CloudConfig, ReadsEveryKey) {
  const auto found = clouds(R"(
- {topic: /camera/points, voxel_size: 0.01, max_range: 3, min_points: 2, min_valid_points: 3, decay: 0.7, replace: true,
   box: [-1, -2, 0.1, 1, 2, 3], max_voxels: 5000, source_timeout: 0.25, self_filter_padding: 0.03,
   touch_links: [base, "wheel_*"]}
- {topic: lidar}
)");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].topic, "/camera/points");
  EXPECT_EQ(found[0].name(), "camera/points");
  EXPECT_EQ(found[0].voxel_size, 0.01);
  EXPECT_EQ(found[0].max_range, 3.0);
  EXPECT_EQ(found[0].min_points, 2);
  EXPECT_EQ(found[0].min_valid_points, 3);
  EXPECT_EQ(found[0].decay, 0.7);
  EXPECT_TRUE(found[0].replace);
  ASSERT_TRUE(found[0].box);
  EXPECT_EQ(found[0].box->min(), Eigen::Vector3d(-1, -2, 0.1));
  EXPECT_EQ(found[0].box->max(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(found[0].max_voxels, 5000);
  EXPECT_EQ(found[0].source_timeout, 0.25);
  EXPECT_EQ(found[0].self_filter_padding, 0.03);
  EXPECT_EQ(found[0].touch_links, (std::vector<std::string>{"base", "wheel_*"}));
  CloudConfig lidar;
  lidar.topic = "lidar";
  EXPECT_TRUE(found[1] == lidar);
  EXPECT_FALSE(found[0] == lidar);
  EXPECT_TRUE(clouds("[]").empty());
}

/// A cloud is compared to find out whether it has to be set up anew.
TEST(CloudConfig, CloudsThatDifferInOneKeyAreNotTheSame) {
  const std::string first =
      "topic: a, voxel_size: 0.01, max_range: 3, min_points: 2, "
      "min_valid_points: 3, decay: 0.7, replace: true, box: [-1, -2, 0.1, 1, 2, 3], max_voxels: "
      "5000, "
      "source_timeout: 0.25, self_filter_padding: 0.03, touch_links: [base]";
  const CloudConfig whole = clouds("[{" + first + "}]")[0];
  EXPECT_TRUE(whole == clouds("[{" + first + "}]")[0]);
  for (const std::string other :
       {"topic: b", "voxel_size: 0.1", "max_range: 4", "min_points: 3", "min_valid_points: 2",
        "decay: 0.25", "replace: false", "box: []", "box: [-1, -2, 0.1, 1, 2, 4]",
        "box: [-1, -1, 0.1, 1, 2, 3]", "max_voxels: 5001", "source_timeout: 0.7",
        "self_filter_padding: 0.02", "touch_links: [base, arm]"}) {
    YAML::Node changed = YAML::Load("{" + first + "}");
    const YAML::Node change = YAML::Load("{" + other + "}");
    changed[change.begin()->first.Scalar()] = change.begin()->second;
    YAML::Node list;
    list.push_back(changed);
    const CloudConfig found = readClouds(list)[0];
    EXPECT_FALSE(found == whole) << other;
    EXPECT_FALSE(whole == found) << other;
    EXPECT_TRUE(found == found) << other;
  }
}

TEST(CloudConfig, OneIsFoundByItsNameWithoutSlash) {
  const auto given = clouds("[{topic: /a/b}, {topic: //c}]");
  EXPECT_EQ(findCloud(given, "a/b"), &given[0]);
  EXPECT_EQ(findCloud(given, "c"), &given[1]);
  EXPECT_EQ(findCloud(given, "/c"), nullptr);
  EXPECT_EQ(findCloud({}, "c"), nullptr);
}

TEST(CloudConfig, LinksKeepTheFiltersPaddingAndAVoxelFromACloud) {
  CloudConfig cloud;
  cloud.topic = "/camera/points";
  EXPECT_DOUBLE_EQ(cloud.padding(), 0.04);
  EXPECT_DOUBLE_EQ(cloud.near(), 0.10);
  cloud.voxel_size = 0.1;
  EXPECT_DOUBLE_EQ(cloud.near(), 0.22);
  EXPECT_DOUBLE_EQ(obstacleOf(cloud).padding, 0.12);
  EXPECT_EQ(obstacleOf(cloud).name, "camera/points");
}

TEST(CloudConfig, UnknownKeyIsRefusedWithTheNearestOne) {
  EXPECT_THAT(refusal("[{topic: a, voxelsize: 0.1}]"),
              AllOf(HasSubstr("clouds[0]: 'voxelsize'"), HasSubstr("did you mean 'voxel_size'?")));
}

TEST(CloudConfig, WhatIsWrongIsRefusedInTheseWords) {
  const std::string is_map = ", but must be a map such as {topic: camera/points, voxel_size: 0.02}";
  const std::string is_topic = ", but must be the name of a topic, such as camera/points";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"{topic: a}",
       "clouds is {topic: a}, but must be a list of maps such as {topic: "
       "camera/points, voxel_size: 0.02}"},
      {"[a]", "clouds[0] is a" + is_map},
      {"[{topic: a}, {voxel_size: 1}]", "clouds[1] has no topic"},
      {"[{topic: a}, {topic: /a}]", "clouds: topic '/a' is listed twice"},
      {"[{topic: /}]", "clouds[0]/topic is /" + is_topic},
      {"[{topic: [a]}]", "clouds[0]/topic is [a]" + is_topic},
      {"[{[a]: b}]", "clouds[0] is [a]" + is_map},
  };
  for (const auto& [yaml, words] : cases) EXPECT_EQ(refusal(yaml), words) << yaml;
}

/// The ends of each range, and what is just beyond or no such value at all.
TEST(CloudConfig, ValuesReachTheEndsOfTheirRangesAndNoFurther) {
  struct Range {
    std::string key, rule;
    std::vector<std::string> right, wrong;
  };
  const std::string length = "more than 0 metres", seconds = "0 or more seconds";
  const std::string box =
      "[min_x, min_y, min_z, max_x, max_y, max_z] in metres, or [] for everything";
  const std::vector<Range> ranges = {
      {"voxel_size", length, {"1e-300"}, {"0", "-1", ".nan", ".inf", "[1]", "wide"}},
      {"max_range", length, {"1e-300"}, {"0", "-1", ".inf"}},
      {"min_points",
       "a whole number from 1 to 1000",
       {"1", "1000", "1e3"},
       {"0", "1.5", "100000001", "[1]"}},
      {"min_valid_points",
       "a whole number from 0 to 100000000",
       {"0", "100000000"},
       {"-1", "0.5", "100000001"}},
      {"max_voxels", "a whole number from 1 to 100000000", {"1", "100000000"}, {"0", "100000001"}},
      {"decay", seconds, {"0", "1e300"}, {"-1e-300", "soon", ".nan"}},
      {"source_timeout", seconds, {"0"}, {"-0.1"}},
      {"replace", "true or false", {"true", "false", "yes"}, {"1.5", "[true]", "maybe"}},
      {"box",
       box,
       {"[]", "[1, 1, 1, 1, 1, 1]", "[-1, -1, -1, 1, 1, 1]"},
       {"5", "[1, 2, 3]", "[0, 0, 0, 1, 1, 1, 1]", "[1, 0, 0, 0, 1, 1]", "[0, 1, 0, 1, 0, 1]",
        "[0, 0, 1, 1, 1, 0]", "[0, 0, 0, 1, 1, a]", "{a: 1}"}},
      {"self_filter_padding", "0 to 0.5 metres", {"0", "0.5"}, {"-1e-300", "0.51", "20", ".inf"}},
      {"touch_links",
       "a list of names or patterns, such as [elbow, \"left_*\"]",
       {"[]", "[a, b]"},
       {"base", "[[a]]", "{a: b}"}},
  };
  const auto refusalOf = [](const std::string& key, const std::string& value) {
    return refusal("[{topic: a, " + key + ": " + value + "}]");
  };
  for (const Range& range : ranges) {
    for (const std::string& value : range.right) {
      EXPECT_EQ(refusalOf(range.key, value), "accepted") << range.key << ": " << value;
    }
    for (const std::string& value : range.wrong) {
      const std::string why = refusalOf(range.key, value);
      EXPECT_THAT(why, testing::StartsWith("clouds[0]/" + range.key + " is ")) << value;
      EXPECT_THAT(why, testing::EndsWith(", but must be " + range.rule)) << value;
    }
  }
}

TEST(CloudConfig, HasTheDefaultsThatThePageStates) {
  auto page = documentedDefaults("clouds.md");
  EXPECT_EQ(page["topic"], "(required)");
  page.erase("topic");
  EXPECT_EQ(page.size(), 11u);
  for (const auto& [key, value] : page) {
    const CloudConfig stated = clouds("[{topic: a, " + key + ": " + value + "}]")[0];
    EXPECT_TRUE(stated == clouds("[{topic: a}]")[0]) << key;
  }
}

}  // namespace collision_pairs::test_cloud_config
