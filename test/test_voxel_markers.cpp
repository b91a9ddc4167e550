#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "printed.h"
#include "scene_markers.h"

namespace collision_pairs::test_voxel_markers {

using visualization_msgs::Marker;

Aabb box(double x_min, double x_max) { return {{x_min, 0.0, 0.0}, {x_max, 0.1, 0.1}}; }

TEST(VoxelMarkers, AreCubesAtTheCentresOfTheVoxels) {
  const OccupiedVoxels voxels(0.1, {{0, 0, 0}, {-3, 5, 20}});
  const Marker marker = toMarker(voxels, "camera", {}, 0.1, "world");
  EXPECT_EQ(marker.ns, "cloud camera");
  EXPECT_EQ(marker.header.frame_id, "world");
  EXPECT_EQ(marker.type, Marker::CUBE_LIST);
  EXPECT_EQ(marker.action, Marker::ADD);
  EXPECT_DOUBLE_EQ(marker.scale.x, 0.1);
  ASSERT_EQ(marker.points.size(), 2u);
  ASSERT_EQ(marker.colors.size(), 2u);
  const bool first = marker.points[0].x > 0.0;
  const auto &origin = marker.points[first ? 0 : 1], &other = marker.points[first ? 1 : 0];
  EXPECT_DOUBLE_EQ(origin.z, 0.05);
  EXPECT_DOUBLE_EQ(other.x, -0.25);
  EXPECT_DOUBLE_EQ(other.y, 0.55);
  EXPECT_DOUBLE_EQ(other.z, 2.05);
}

TEST(VoxelMarkers, NearABoxAreRedderTheNearerTheyAre) {
  const OccupiedVoxels voxels(0.1, {{0, 0, 0}, {2, 0, 0}, {9, 0, 0}});
  // Touches the first, is 0.1 m from the second; the other box counts for none.
  const Marker marker = toMarker(voxels, "camera", {noBox(), box(0.05, 0.1)}, 0.2, "world");
  std::map<double, std_msgs::ColorRGBA> by_x;
  for (std::size_t i = 0; i < 3; ++i) by_x[marker.points[i].x] = marker.colors[i];
  auto at = by_x.begin();
  const auto touching = (at++)->second, near = (at++)->second, far = at->second;
  EXPECT_LT(touching.g, near.g);
  EXPECT_GT(touching.r, 0.9);
  EXPECT_LT(far.r, 0.5);
}

TEST(VoxelMarkers, HaveTheirPlaceSizeAndColour) {
  const OccupiedVoxels voxels(0.25, {{0, 0, 0}, {2, 1, -1}, {9, 0, 0}});
  const Aabb near{{0.0, 0.0, 0.0}, {0.125, 0.125, 0.125}};
  EXPECT_EQ(printed(toMarker(voxels, "camera", {near, near}, 0.75, "world")),
            "header frame_id world ns cloud camera type 6 pose orientation w 1 scale x 0.25 y 0.25 "
            "z 0.25 color r 0.3 g 0.55 b 0.75 a 1 points[0] x 0.125 y 0.125 z 0.125 points[1] x "
            "0.625 y 0.375 z -0.125 points[2] x 2.375 y 0.125 z 0.125 colors[0] r 0.95 g 0.15 b "
            "0.1 a 1 colors[1] r 0.923648 g 0.466228 b 0.1 a 1 colors[2] r 0.3 g 0.55 b 0.75 a 1");
  EXPECT_EQ(printed(noMarker("camera", "world")),
            "header frame_id world ns cloud camera type 6 action 2 pose orientation w 1");
}

TEST(VoxelMarkers, OfACloseBoxAndAnotherTakeTheColourOfTheCloser) {
  const OccupiedVoxels voxels(0.1, {{0, 0, 0}});
  const Aabb further = box(0.3, 0.4);
  const auto close = box(0.15, 0.25);
  const auto red = [&](const std::vector<Aabb>& boxes) {
    return toMarker(voxels, "camera", boxes, 0.3, "world").colors.at(0);
  };
  EXPECT_NE(red({close}).g, red({further}).g);
  EXPECT_EQ(red({close, further}).g, red({close}).g);
  EXPECT_EQ(red({further, close}).g, red({close}).g);
}

TEST(VoxelMarkers, NearABoxAreRedInEveryDirection) {
  std::vector<VoxelCell> cells;
  for (int i = 0; i < 27; ++i) cells.emplace_back(i % 3, i / 3 % 3, i / 9);
  const Aabb all{{0.0, 0.0, 0.0}, {0.3, 0.3, 0.3}};
  const Marker marker = toMarker(OccupiedVoxels(0.1, cells), "camera", {all}, 0.2, "world");
  ASSERT_EQ(marker.points.size(), 27u);
  for (const auto& shade : marker.colors) EXPECT_GT(shade.r, 0.9);
}

TEST(VoxelMarkers, OfMoreThanAreDrawnTheNearOnesStay) {
  std::vector<VoxelCell> cells;
  for (int i = 0; i < 400; ++i) {
    for (int j = 0; j < 400; ++j) cells.emplace_back(i, j, 0);
  }
  const Marker marker =
      toMarker(OccupiedVoxels(0.1, cells), "camera", {box(39.95, 40.5)}, 0.05, "world");
  EXPECT_EQ(marker.points.size(), 100000u);
  const auto is_there = [&](double x) {
    return std::any_of(marker.points.begin(), marker.points.end(), [&](const auto& point) {
      return std::abs(point.x - x) < 1e-9 && std::abs(point.y - 0.05) < 1e-9;
    });
  };
  EXPECT_TRUE(is_there(39.95));
}

TEST(VoxelMarkers, OfNothingAreTakenAway) {
  EXPECT_EQ(toMarker(OccupiedVoxels(0.1, std::vector<VoxelCell>()), "a", {}, 0.1, "w").action,
            Marker::DELETE);
  EXPECT_EQ(noMarker("a", "w").action, Marker::DELETE);
  EXPECT_EQ(noMarker("a", "w").ns, "cloud a");
}

}  // namespace collision_pairs::test_voxel_markers
