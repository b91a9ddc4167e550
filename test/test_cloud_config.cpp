#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud_config.h"
#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<CloudConfig> clouds(const std::string& yaml) { return readClouds(YAML::Load(yaml)); }

std::string refusal(const std::string& yaml) {
  try {
    clouds(yaml);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CloudConfig, ReadsEveryKey) {
  const auto found = clouds(R"(
- {topic: /camera/points, voxel_size: 0.01, max_range: 3, min_points: 2, min_valid_points: 0, decay: 0.5, replace: true,
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
  EXPECT_EQ(found[0].min_valid_points, 0);
  EXPECT_EQ(found[0].decay, 0.5);
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

TEST(CloudConfig, WrongValueIsRefusedByKeyValueAndRule) {
  EXPECT_THAT(refusal("{topic: a}"), HasSubstr("must be a list of maps"));
  EXPECT_THAT(refusal("[a]"), HasSubstr("clouds[0] is a, but must be a map"));
  EXPECT_THAT(refusal("[{topic: a}, {voxel_size: 1}]"), HasSubstr("clouds[1] has no topic"));
  EXPECT_THAT(refusal("[{topic: a}, {topic: /a}]"), HasSubstr("topic '/a' is listed twice"));
  EXPECT_THAT(refusal("[{topic: /}]"), HasSubstr("clouds[0]/topic is /, but must be"));
  const std::string begin = "[{topic: a, ", end = "}]";
  for (const std::string wrong :
       {"voxel_size: 0", "voxel_size: -1", "voxel_size: .nan", "max_range: 0", "min_points: 0",
        "min_points: 1.5", "min_valid_points: -1", "decay: -1", "decay: soon", "replace: 1.5",
        "box: [1, 2, 3]", "box: [1, 0, 0, 0, 1, 1]", "box: 5", "max_voxels: 0",
        "max_voxels: 100000001", "source_timeout: -0.1", "self_filter_padding: -0.1",
        "touch_links: base"}) {
    const std::string key = wrong.substr(0, wrong.find(':'));
    EXPECT_THAT(refusal(begin + wrong + end), HasSubstr("clouds[0]/" + key + " is ")) << wrong;
  }
}

TEST(CloudConfig, NumbersReachTheEndsOfTheirRanges) {
  const std::string begin = "[{topic: a, ", end = "}]";
  for (const std::string right : {"min_points: 1", "min_valid_points: 0", "decay: 0",
                                  "max_voxels: 1", "max_voxels: 100000000", "source_timeout: 0",
                                  "self_filter_padding: 0", "box: [1, 1, 1, 1, 1, 1]"}) {
    EXPECT_EQ(refusal(begin + right + end), "accepted") << right;
  }
}

/// Rows of the page's table: | `key` | `default` unit | effect |. All of them as YAML.
TEST(CloudConfig, DefaultsOfThePageAreThoseOfTheCode) {
  std::ifstream page(std::string(PROJECT_SOURCE_DIR) + "/docs/clouds.md");
  std::ostringstream yaml;
  int nb_rows = 0;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    std::istringstream cells(line.substr(1));
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, '|');) {
      cell.erase(0, cell.find_first_not_of(" `"));
      row.push_back(cell.substr(0, cell.find('`')));
    }
    if (row.size() < 3 || row[0] == "topic") continue;
    yaml << ", " << row[0] << ": " << row[1];
    ++nb_rows;
  }
  EXPECT_EQ(nb_rows, 11) << "one for each key but topic";
  CloudConfig defaults;
  defaults.topic = "a";
  EXPECT_TRUE(clouds("[{topic: a" + yaml.str() + "}]").at(0) == defaults) << yaml.str();
}

}  // namespace
}  // namespace collision_pairs
