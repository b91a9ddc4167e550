// What of a cloud becomes voxels: two unit boxes, and points about them.
#include <functional>

#include <gmock/gmock.h>

#include "collision_pairs/input_error.h"
#include "processed_clouds.h"
#include "refusal.h"

namespace collision_pairs::test_cloud_processor {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;

TEST_F(CloudProcessing, PutsPointsWhereTheSensorStands) {
  CloudProcessor processor(config_);
  const auto voxels = add(processor, {{5.05, 3.05, -0.05}});
  std::vector<VoxelCell> cells;
  voxels->forEach([&](const VoxelCell& cell) { cells.push_back(cell); });
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_EQ(cells[0], VoxelCell(50, 30, -1));
}

TEST_F(CloudProcessing, LeavesOutWhatIsTheRobotOrWithinThePadding) {
  const std::vector<Vector3d> own = {{0, 0, 0}, {0.5, 0, 0}, {0.54, 0, 0}, {10, 0.54, 0.3}};
  EXPECT_EQ(nbVoxels(own), 0u);
  EXPECT_EQ(nbVoxels({{0.56, 0, 0}, {10, 0.56, 0.3}}), 2u);
}

TEST_F(CloudProcessing, LeavesOutWhatIsBeyondTheRangeFromTheSensor) {
  config_.max_range = 3.0;
  EXPECT_EQ(nbVoxels({{5, 2.9, 0}, {5, 3.1, 0}, {0, 2, 0}}), 1u);
}

TEST_F(CloudProcessing, LeavesOutWhatIsOutsideOfTheBoxInTheFixedFrame) {
  config_.box = Eigen::AlignedBox3d(Vector3d(4, 1, 0), Vector3d(6, 3, 1));
  EXPECT_EQ(nbVoxels({{4.55, 2, 0.55}, {3.9, 2, 0.5}, {5, 2, 1.1}, {5, 0.9, 0.5}}), 1u);
}

TEST_F(CloudProcessing, KeepsThePointsThatBecameVoxelsInTheFrameOfTheSensor) {
  CloudProcessor processor(config_);
  add(processor, {{0, 0, 0}, {5, 2, 0}, {10, 0, 0}});
  ASSERT_EQ(processor.kept().size(), 1u);
  EXPECT_TRUE(processor.kept()[0].isApprox(Vector3d(0, 2, 0)));
}

TEST_F(CloudProcessing, RemembersForTheTimeOfDecayUnlessEachCloudReplacesTheOneBefore) {
  config_.decay = 1.5;
  for (const bool replace : {false, true}) {
    config_.replace = replace;
    CloudProcessor processor(config_);
    EXPECT_EQ(add(processor, {{5, 2, 0}})->size(), 1u);
    EXPECT_EQ(add(processor, {{5, 3, 0}})->size(), replace ? 1u : 2u);
    EXPECT_EQ(add(processor, {{5, 3, 0}})->size(), 1u);
  }
}

TEST_F(CloudProcessing, UsesNoCloudWithoutThePoseOfALink) {
  unknown_link_ = "b";
  CloudProcessor processor(config_);
  EXPECT_THAT(refusal([&] { add(processor, {{5, 2, 0}}); }), HasSubstr("'b' has no pose"));
}

TEST_F(CloudProcessing, PlacesPointsFarFromTheirFrameToTheMillimetre) {
  X_WS_.linear() = Eigen::AngleAxisd(0.3, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  X_WS_.translation() = Vector3d(5e6, 4e5, 0);  // as in UTM
  config_.max_range = 1e7;
  config_.voxel_size = 0.002;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(nbVoxels({{0.051 + 0.01 * i, 3.051, 0.751}}), 1u);
  CloudProcessor processor(config_);
  const auto voxels = add(processor, {{5.051, 3.051, 0.751}});
  voxels->forEach([&](const VoxelCell& cell) { EXPECT_EQ(cell, VoxelCell(2525, 1525, 375)); });
}

TEST_F(CloudProcessing, RefusesCloudsThatShowNothingAndRemembersWhatItKnew) {
  config_.max_range = 3.0;
  const std::vector<Vector3d> beyond = {{5, 3.1, 0}, {5, -4, 0}, {0, 2, 0}};
  CloudProcessor processor(config_);
  EXPECT_EQ(add(processor, {{5, 2, 0}})->size(), 1u);
  EXPECT_EQ(refusal([&] { add(processor, beyond); }),
            "only 0 of its 3 points are within max_range (3 m), and "
            "min_valid_points is 1");
  EXPECT_EQ(
      refusal([&] { add(processor, {}); }),
      "nothing returned: it has no point that is finite and further than 1 mm from the sensor, and "
      "min_valid_points is 1");
  stamp_ = 100.2;
  EXPECT_EQ(add(processor, {{5, 2.5, 0}})->size(), 2u);
}

TEST_F(CloudProcessing, RefusesCloudsOfWhichAllPointsAreAtOnePlace) {
  CloudProcessor processor(config_);
  const Vector3d zero = X_WS_.translation() + Vector3d(0.02, 0, 0);  // of a sensor in another frame
  EXPECT_EQ(refusal([&] {
              add(processor, {zero, zero, zero + Vector3d(1e-5, 0, 0)});
            }),
            "nothing returned: its 3 points are at one place, and min_valid_points is 1");
  EXPECT_EQ(add(processor, {zero, zero, {5, 2, 0}})->size(), 2u);
}

TEST_F(CloudProcessing, CountsValidPointsOnTheRobotAndOutsideOfTheBox) {
  config_.max_range = 5.2;
  config_.min_valid_points = 3;
  config_.box = Eigen::AlignedBox3d(Vector3d(4, 1, 0), Vector3d(6, 3, 1));
  const std::vector<Vector3d> valid = {{0, 0, 0}, {5, -2, 0}, {10, 0.2, 0}};
  EXPECT_EQ(nbVoxels(valid), 0u);
  CloudProcessor processor(config_);
  EXPECT_EQ(refusal([&] {
              add(processor, {valid[0], {5, 5.3, 0}, valid[2]});
            }),
            "only 2 of its 3 points are within max_range (5.2 m), and "
            "min_valid_points is 3");
}

TEST_F(CloudProcessing, WarnsOfCloudsThatShowNothingWhereTheyAreAllowed) {
  config_.min_valid_points = 0;
  config_.max_range = 3.0;
  CloudProcessor processor(config_);
  EXPECT_EQ(add(processor, {})->size(), 0u);
  EXPECT_EQ(
      processor.warning(),
      "nothing returned: it has no point that is finite and further than 1 mm from the sensor");
  add(processor, {{5, 3.1, 0}});
  EXPECT_EQ(processor.warning(), "only 0 of its 1 points are within max_range (3 m)");
  add(processor, {{5, 3.1, 0}, {5, 2, 0}});
  EXPECT_EQ(processor.warning(), "");
}

TEST_F(CloudProcessing, SaysWhenThereAreMoreVoxelsThanMayBe) {
  config_.max_voxels = 2;
  CloudProcessor processor(config_);
  EXPECT_FALSE(add(processor, {{5, 2, 0}, {5, 3, 0}})->isTruncated());
  const auto voxels = add(processor, {{5, 2, 0}, {5, 3, 0}, {5, 4, 0}});
  EXPECT_TRUE(voxels->isTruncated());
  EXPECT_EQ(voxels->size(), 2u);
}

}  // namespace collision_pairs::test_cloud_processor
