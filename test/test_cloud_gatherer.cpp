// What of a cloud becomes voxels: two unit boxes, and points about them.
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud_gatherer.h"
#include "collision_pairs/input_error.h"
#include "demo_scene.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;

/// Box a at x = 0 and box b at x = 10; the sensor stands at x = 5 and looks along W.
class Gatherer : public testing::Test {
 protected:
  Gatherer() {
    config_.topic = "camera";
    config_.voxel_size = 0.1;
    config_.max_range = 20.0;
    config_.self_filter_padding = 0.05;
    description_.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
    X_WS_.translation() = Vector3d(5, 0, 0);
  }

  /// Points in W; the voxels after each cloud, a second later than the one before.
  std::shared_ptr<const OccupiedVoxels> add(CloudGatherer& gatherer,
                                            const std::vector<Vector3d>& points) {
    description_.clouds = {obstacleOf(config_)};
    RobotFilter filter(description_, *CollisionScene::build(description_), config_);
    const std::vector<SceneBody>& bodies = filter.own.bodies();
    BodyPoses robot;
    robot.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const std::string& link = bodies[i].link;
      robot.X_WB[i].translation().x() = link == "b" ? 10.0 : x_of_a_;
      if (link == unknown_link_) robot.known[i] = 0;
    }
    std::vector<Vector3d> in_sensor;
    for (const Vector3d& p_WP : points) {
      in_sensor.push_back(X_WS_.inverse() * p_WP);
    }
    stamp_ += 1.0;
    return gatherer.add(in_sensor, X_WS_, robot, stamp_, filter);
  }

  std::size_t nbVoxels(const std::vector<Vector3d>& points) {
    CloudGatherer gatherer(config_);
    return add(gatherer, points)->size();
  }

  CloudConfig config_;
  SceneDescription description_;
  Isometry3d X_WS_ = Isometry3d::Identity();
  double stamp_ = 100.0, x_of_a_ = 0.0;
  std::string unknown_link_;
};

TEST_F(Gatherer, PutsPointsWhereTheSensorStands) {
  CloudGatherer gatherer(config_);
  const auto voxels = add(gatherer, {{5.05, 3.05, -0.05}});
  std::vector<VoxelCell> cells;
  voxels->forEach([&](const VoxelCell& cell) { cells.push_back(cell); });
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_EQ(cells[0], VoxelCell(50, 30, -1));
}

TEST_F(Gatherer, LeavesOutWhatIsTheRobotOrWithinThePadding) {
  const std::vector<Vector3d> own = {{0, 0, 0}, {0.5, 0, 0}, {0.54, 0, 0}, {10, 0.54, 0.3}};
  EXPECT_EQ(nbVoxels(own), 0u);
  EXPECT_EQ(nbVoxels({{0.56, 0, 0}, {10, 0.56, 0.3}}), 2u);
}

TEST_F(Gatherer, LeavesOutWhatIsBeyondTheRangeFromTheSensor) {
  config_.max_range = 3.0;
  EXPECT_EQ(nbVoxels({{5, 2.9, 0}, {5, 3.1, 0}, {0, 2, 0}}), 1u);
}

TEST_F(Gatherer, LeavesOutWhatIsOutsideOfTheBoxInTheFixedFrame) {
  config_.box = Eigen::AlignedBox3d(Vector3d(4, 1, 0), Vector3d(6, 3, 1));
  EXPECT_EQ(nbVoxels({{4.55, 2, 0.55}, {3.9, 2, 0.5}, {5, 2, 1.1}, {5, 0.9, 0.5}}), 1u);
}

TEST_F(Gatherer, KeepsThePointsThatBecameVoxelsInTheFrameOfTheSensor) {
  CloudGatherer gatherer(config_);
  add(gatherer, {{0, 0, 0}, {5, 2, 0}, {10, 0, 0}});
  ASSERT_EQ(gatherer.kept().size(), 1u);
  EXPECT_TRUE(gatherer.kept()[0].isApprox(Vector3d(0, 2, 0)));
}

TEST_F(Gatherer, RemembersForTheTimeOfDecayUnlessEachCloudReplacesTheOneBefore) {
  config_.decay = 1.5;
  for (const bool replace : {false, true}) {
    config_.replace = replace;
    CloudGatherer gatherer(config_);
    EXPECT_EQ(add(gatherer, {{5, 2, 0}})->size(), 1u);
    EXPECT_EQ(add(gatherer, {{5, 3, 0}})->size(), replace ? 1u : 2u);
    EXPECT_EQ(add(gatherer, {{5, 3, 0}})->size(), 1u);
  }
}

/// With the voxels of this test, what is seen up to 25 cm from a link is followed.
class Follower : public Gatherer {
 protected:
  /// Up to face x = 0.5 of box a; the last point is within the padding.
  void approach() {
    for (const double x : {0.95, 0.85, 0.65, 0.52}) add(gatherer_, {{x, 0.01, 0.01}});
  }

  /// Points of a wall across the sensor's view.
  static std::vector<Vector3d> wallAt(double x) {
    std::vector<Vector3d> points;
    for (double y = -0.5; y <= 0.5; y += 0.02) {
      for (double z = -0.5; z <= 0.5; z += 0.02) points.emplace_back(x, y, z);
    }
    return points;
  }

  CloudGatherer gatherer_{config_};
};

TEST_F(Follower, NamesWhatVanishedBesideALinkUntilItStaysInSightAgain) {
  approach();
  EXPECT_EQ(gatherer_.mayTouch(), "vanished 15 cm from a: it may touch");
  add(gatherer_, {{0.52, 0.01, 0.01}});
  EXPECT_NE(gatherer_.mayTouch(), "");
  for (const double x : {0.65, 0.52, 0.65}) {  // one cloud alone does not count
    add(gatherer_, {{x, 0.01, 0.01}});
    EXPECT_NE(gatherer_.mayTouch(), "") << x;
  }
  add(gatherer_, {{0.75, 0.01, 0.01}});
  EXPECT_EQ(gatherer_.mayTouch(), "");
}

TEST_F(Follower, FindsAgainWhatComesFromWhereNothingWasWhenItVanished) {
  const Vector3d rest(0.65, 0.45, 0.01);  // of the same obstacle, and seen all the time
  for (const double x : {0.95, 0.85, 0.65, 0.52}) add(gatherer_, {{x, 0.01, 0.01}, rest});
  for (const Vector3d& p : {rest, Vector3d(0.72, 0.38, 0.01), Vector3d(0.79, 0.3, 0.01)}) {
    add(gatherer_, {p});
    EXPECT_EQ(gatherer_.mayTouch(), "vanished 15 cm from a: it may touch");
  }
  for (const double y : {0.2, 0.1, 0.1}) add(gatherer_, {{0.85, y, 0.01}});
  EXPECT_EQ(gatherer_.mayTouch(), "");
}

TEST_F(Follower, TakesOnePointThatOneCloudShowsForNoise) {
  add(gatherer_, {{0.65, 0.01, 0.01}});
  add(gatherer_, {{5, 2, 0}});
  EXPECT_EQ(gatherer_.mayTouch(), "");
}

TEST_F(Follower, SeesWhatGoesAwayGo) {
  for (const double x : {0.95, 0.75, 0.65, 0.85, 1.05, 1.25, 1.45}) {
    add(gatherer_, {{x, 0.01, 0.01}});
    EXPECT_EQ(gatherer_.mayTouch(), "") << x;
  }
}

TEST_F(Follower, DoesNotAskForWhatIsStillSeenOutsideOfTheBox) {
  config_.box = Eigen::AlignedBox3d(Vector3d(-2, -2, 0), Vector3d(9, 2, 2));
  CloudGatherer cropped(config_);
  for (const double z : {0.45, 0.25, 0.05, -0.05}) add(cropped, {{0.65, 0, z}});
  EXPECT_EQ(cropped.mayTouch(), "");
  for (const double z : {0.05, 0.05, 5.0}) add(cropped, {{0.65, 0, z}});
  EXPECT_NE(cropped.mayTouch(), "");
}

TEST_F(Follower, DoesNotFollowWhatMayTouch) {
  config_.touch_links = {"a"};
  approach();
  EXPECT_EQ(gatherer_.mayTouch(), "");
}

TEST_F(Follower, ForgetsWhatVanishedWhenItIsCleared) {
  approach();
  gatherer_.clear();
  EXPECT_EQ(gatherer_.mayTouch(), "");
}

TEST_F(Follower, DoesNotMissWhatWasAttachedToALink) {
  for (int i = 0; i < 3; ++i) add(gatherer_, {{0.65, 0.01, 0.01}});
  RigidObject tool;
  tool.name = "tool";
  tool.attached_link = "a";
  tool.elements.push_back({Box{{0.1, 0.1, 0.1}}, Isometry3d::Identity()});
  tool.X_PO.translation() = Vector3d(0.65, 0, 0);
  description_.objects.push_back(tool);
  EXPECT_EQ(add(gatherer_, {{0.65, 0.01, 0.01}})->size(), 0u);
  EXPECT_EQ(gatherer_.mayTouch(), "");
}

TEST_F(Follower, RemembersWhatTheRobotHidesForAsLongAsItDoes) {
  for (int i = 0; i < 2; ++i) add(gatherer_, {{-0.65, 0.01, 0.01}});
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(add(gatherer_, wallAt(0.5))->size(), 1u);  // box a, seen from the front
  }
  EXPECT_EQ(gatherer_.mayTouch(), "");
  std::vector<Vector3d> beside = wallAt(-3.0);
  EXPECT_GT(add(gatherer_, beside)->size(), 1u);
  const auto voxels = add(gatherer_, beside);
  EXPECT_FALSE(voxels->anyWithin({{-0.65, 0, 0}, {-0.65, 0, 0}}, 0.2));
  EXPECT_THAT(gatherer_.mayTouch(), HasSubstr("vanished 15 cm from a"));
}

TEST_F(Follower, TakesWhatTheRobotHidAndLeftForWhatItMayCarryUntilItIsSeen) {
  for (const int nb_seen : {1, 2}) {  // in one cloud alone it is noise
    CloudGatherer gatherer(config_);
    x_of_a_ = 0.0;
    add(gatherer, wallAt(3.0));
    for (int i = 0; i < nb_seen; ++i) add(gatherer, {{-0.65, 0.01, 0.01}});
    for (int i = 0; i < 3; ++i) add(gatherer, wallAt(0.5));
    EXPECT_EQ(gatherer.mayTouch(), "");
    x_of_a_ = 1.0;
    add(gatherer, wallAt(1.5));
    EXPECT_EQ(gatherer.mayTouch() != "", nb_seen > 1) << gatherer.mayTouch();
    for (int i = 0; i < 2; ++i) add(gatherer, {{-0.65, 0.01, 0.01}});
    EXPECT_EQ(gatherer.mayTouch(), "");
  }
}

TEST_F(Follower, DoesNotTakeWhatStandsNearByForWhatTheRobotHid) {
  config_.voxel_size = 0.02;
  // 25 cm above where it is hidden, and above where link a carries it to.
  const Vector3d hidden(-0.6, 0.01, 0.45), stands(-0.6, 0.01, 0.7), there(0.4, 0.01, 0.7);
  const auto wallAndWhatStands = [&](double x) {
    std::vector<Vector3d> points = wallAt(x);
    points.insert(points.end(), {stands, there});
    return points;
  };
  for (const bool robot_leaves : {false, true}) {
    CloudGatherer gatherer(config_);
    x_of_a_ = 0.0;
    for (int i = 0; i < 2; ++i) add(gatherer, {hidden, stands, there});
    for (int i = 0; i < 3; ++i) add(gatherer, wallAndWhatStands(0.5));
    EXPECT_THAT(gatherer.mayTouch(), HasSubstr("hidden 9 cm from a"));
    x_of_a_ = robot_leaves ? 1.0 : 0.0;
    for (int i = 0; i < 2; ++i) add(gatherer, wallAndWhatStands(robot_leaves ? 1.5 : -3.0));
    EXPECT_THAT(gatherer.mayTouch(), HasSubstr("vanished 9 cm from a"));
  }
}

TEST_F(Follower, DoubtsWhatIsHiddenInPart) {
  const Vector3d nearest(-0.65, -0.05, 0.05);
  const std::vector<Vector3d> obstacle = {nearest, {-0.75, 0.05, 0.05}, {-0.75, 0.15, 0.05}};
  for (int i = 0; i < 2; ++i) add(gatherer_, obstacle);
  add(gatherer_, wallAt(0.5));
  EXPECT_EQ(gatherer_.mayTouch(), "");  // the nearest voxel is remembered, and in contact
  std::vector<Vector3d> seen_through = {{-3.0, -0.1, 0.1}};  // beside the nearest voxel
  for (const Vector3d& p : wallAt(0.5)) {
    const bool is_before_it = p.y() < 0.0 && p.y() > -0.19 && p.z() > -0.01 && p.z() < 0.19;
    if (!is_before_it) seen_through.push_back(p);
  }
  for (int i = 0; i < 3; ++i) {
    const auto voxels = add(gatherer_, seen_through);
    EXPECT_FALSE(voxels->anyWithin({nearest, nearest}, 0.0));
    EXPECT_EQ(gatherer_.mayTouch(), "hidden 15 cm from a: it may touch");
  }
}

/// Before it was hidden it may have moved on as far as it can from one cloud to the next.
TEST_F(Follower, DoubtsWhatIsHiddenAndNotWithinThePaddingOfALink) {
  const auto hide = [&](double x_of_a) {
    x_of_a_ = x_of_a;
    add(gatherer_, wallAt(x_of_a + 0.5));
    return gatherer_.mayTouch();
  };
  for (int i = 0; i < 2; ++i) add(gatherer_, {{-0.71, 0.01, 0.01}});
  EXPECT_EQ(hide(-0.06), "");  // its voxel, of 10 cm, is in contact: 14 cm away
  EXPECT_EQ(hide(-0.04), "hidden 21 cm from a: it may touch");
  EXPECT_EQ(hide(-0.05), "hidden 20 cm from a: it may touch");  // as near as rounding tells
  EXPECT_EQ(hide(-0.06), "");
  EXPECT_EQ(hide(-0.02), "hidden 23 cm from a: it may touch");
  add(gatherer_, {{-0.71, 0.01, 0.01}});
  EXPECT_EQ(gatherer_.mayTouch(), "");
}

TEST_F(Follower, DoesNotMissWhatTheRobotHidWhereItHasShownItsPlaceSince) {
  for (int i = 0; i < 2; ++i) add(gatherer_, {{-0.65, 0.01, 0.01}});
  for (int i = 0; i < 3; ++i) add(gatherer_, wallAt(0.5));
  for (int i = 0; i < 2; ++i) add(gatherer_, {{-0.85, 0.15, 0.01}});  // it has moved
  add(gatherer_, wallAt(-3.0));
  EXPECT_EQ(gatherer_.mayTouch(), "");
  x_of_a_ = 1.0;
  add(gatherer_, wallAt(1.5));
  EXPECT_EQ(gatherer_.mayTouch(), "");
}

TEST_F(Follower, RemembersNoLongerWhatIsFarFromTheRobot) {
  for (int i = 0; i < 2; ++i) add(gatherer_, {{-1.65, 0.01, 0.01}});
  add(gatherer_, wallAt(0.5));
  EXPECT_EQ(add(gatherer_, wallAt(0.5))->size(), 0u);
}

TEST_F(Gatherer, UsesNoCloudWithoutThePoseOfALink) {
  unknown_link_ = "b";
  CloudGatherer gatherer(config_);
  try {
    add(gatherer, {{5, 2, 0}});
    ADD_FAILURE() << "was used";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'b' has no pose"));
  }
}

TEST_F(Gatherer, PlacesPointsFarFromTheirFrameToTheMillimetre) {
  X_WS_.linear() = Eigen::AngleAxisd(0.3, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  X_WS_.translation() = Vector3d(5e6, 4e5, 0);  // as in UTM
  config_.max_range = 1e7;
  config_.voxel_size = 0.002;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(nbVoxels({{0.051 + 0.01 * i, 3.051, 0.751}}), 1u);
  CloudGatherer gatherer(config_);
  const auto voxels = add(gatherer, {{5.051, 3.051, 0.751}});
  voxels->forEach([&](const VoxelCell& cell) { EXPECT_EQ(cell, VoxelCell(2525, 1525, 375)); });
}

std::string refusalOf(const std::function<void()>& add) {
  try {
    add();
  } catch (const InputError& error) {
    return error.what();
  }
  return "it was used";
}

TEST_F(Gatherer, RefusesCloudsThatShowNothingAndRemembersWhatItKnew) {
  config_.max_range = 3.0;
  const std::vector<Vector3d> beyond = {{5, 3.1, 0}, {5, -4, 0}, {0, 2, 0}};
  CloudGatherer gatherer(config_);
  EXPECT_EQ(add(gatherer, {{5, 2, 0}})->size(), 1u);
  EXPECT_EQ(refusalOf([&] { add(gatherer, beyond); }),
            "only 0 of its 3 finite points are within max_range (3 m), and min_valid_points is 1");
  EXPECT_EQ(refusalOf([&] { add(gatherer, {}); }),
            "it has no finite point, and min_valid_points is 1");
  stamp_ = 100.2;
  EXPECT_EQ(add(gatherer, {{5, 2.5, 0}})->size(), 2u);
}

TEST_F(Gatherer, CountsValidPointsOnTheRobotAndOutsideOfTheBox) {
  config_.max_range = 5.2;
  config_.min_valid_points = 3;
  config_.box = Eigen::AlignedBox3d(Vector3d(4, 1, 0), Vector3d(6, 3, 1));
  const std::vector<Vector3d> valid = {{0, 0, 0}, {5, -2, 0}, {10, 0.2, 0}};
  EXPECT_EQ(nbVoxels(valid), 0u);
  CloudGatherer gatherer(config_);
  EXPECT_EQ(
      refusalOf([&] {
        add(gatherer, {valid[0], {5, 5.3, 0}, valid[2]});
      }),
      "only 2 of its 3 finite points are within max_range (5.2 m), and min_valid_points is 3");
}

TEST_F(Gatherer, WarnsOfCloudsThatShowNothingWhereTheyAreAllowed) {
  config_.min_valid_points = 0;
  config_.max_range = 3.0;
  CloudGatherer gatherer(config_);
  EXPECT_EQ(add(gatherer, {})->size(), 0u);
  EXPECT_EQ(gatherer.warning(), "it has no finite point");
  add(gatherer, {{5, 3.1, 0}});
  EXPECT_EQ(gatherer.warning(), "only 0 of its 1 finite points are within max_range (3 m)");
  add(gatherer, {{5, 3.1, 0}, {5, 2, 0}});
  EXPECT_EQ(gatherer.warning(), "");
}

TEST_F(Gatherer, SaysWhenThereAreMoreVoxelsThanMayBe) {
  config_.max_voxels = 2;
  CloudGatherer gatherer(config_);
  EXPECT_FALSE(add(gatherer, {{5, 2, 0}, {5, 3, 0}})->isTruncated());
  const auto voxels = add(gatherer, {{5, 2, 0}, {5, 3, 0}, {5, 4, 0}});
  EXPECT_TRUE(voxels->isTruncated());
  EXPECT_EQ(voxels->size(), 2u);
}

}  // namespace
}  // namespace collision_pairs
