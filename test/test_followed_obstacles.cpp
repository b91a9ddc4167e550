// What was seen near the robot and no longer is, from cloud to cloud.
#include <gmock/gmock.h>

#include "processed_clouds.h"
#include "random_inputs.h"

namespace collision_pairs::test_followed_obstacles {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;

/// With the voxels of this test, what is seen up to 25 cm from a link is followed.
class Follower : public CloudProcessing {
 protected:
  /// Up to face x = 0.5 of box a; the last point is within the padding.
  void approach() {
    for (const double x : {0.95, 0.85, 0.65, 0.52}) add(processor_, {{x, 0.01, 0.01}});
  }

  /// Points of a wall across the sensor's view.
  static std::vector<Vector3d> wallAt(double x) {
    std::vector<Vector3d> points;
    for (double y = -0.5; y <= 0.5; y += 0.02) {
      for (double z = -0.5; z <= 0.5; z += 0.02) points.emplace_back(x, y, z);
    }
    return points;
  }

  CloudProcessor processor_{config_};
};

TEST_F(Follower, NamesWhatVanishedBesideALinkUntilItStaysInSightAgain) {
  approach();
  EXPECT_EQ(processor_.mayTouch(), "vanished 15 cm from a: it may touch");
  add(processor_, {{0.52, 0.01, 0.01}});
  EXPECT_NE(processor_.mayTouch(), "");
  for (const double x : {0.65, 0.52, 0.65}) {  // one cloud alone does not count
    add(processor_, {{x, 0.01, 0.01}});
    EXPECT_NE(processor_.mayTouch(), "") << x;
  }
  add(processor_, {{0.75, 0.01, 0.01}});
  EXPECT_EQ(processor_.mayTouch(), "");
}

TEST_F(Follower, FindsAgainWhatComesFromWhereNothingWasWhenItVanished) {
  const Vector3d rest(0.65, 0.45, 0.01);  // of the same obstacle, and seen all the time
  for (const double x : {0.95, 0.85, 0.65, 0.52}) add(processor_, {{x, 0.01, 0.01}, rest});
  for (const Vector3d& p : {rest, Vector3d(0.72, 0.38, 0.01), Vector3d(0.79, 0.3, 0.01)}) {
    add(processor_, {p});
    EXPECT_EQ(processor_.mayTouch(), "vanished 15 cm from a: it may touch");
  }
  for (const double y : {0.2, 0.1, 0.1}) add(processor_, {{0.85, y, 0.01}});
  EXPECT_EQ(processor_.mayTouch(), "");
}

TEST_F(Follower, TakesOnePointThatOneCloudShowsForNoise) {
  add(processor_, {{0.65, 0.01, 0.01}});
  add(processor_, {{5, 2, 0}});
  EXPECT_EQ(processor_.mayTouch(), "");
}

TEST_F(Follower, SeesWhatGoesAwayGo) {
  for (const double x : {0.95, 0.75, 0.65, 0.85, 1.05, 1.25, 1.45}) {
    add(processor_, {{x, 0.01, 0.01}});
    EXPECT_EQ(processor_.mayTouch(), "") << x;
  }
}

// Box a stands across the border of the crop: its own points beyond are no obstacle that was seen.
TEST_F(Follower, AsksForWhatVanishedBesideALinkThatCrossesTheBorderOfTheCrop) {
  const std::vector<Vector3d> of_a = {{0.5, 0.0, -0.05}, {0.5, 0.0, 0.05}, {0.5, 0.05, -0.02}};
  for (const bool has_box : {false, true}) {
    config_.box = std::nullopt;
    if (has_box) config_.box = Eigen::AlignedBox3d(Vector3d(-2, -2, 0), Vector3d(9, 2, 2));
    CloudProcessor cropped(config_);
    for (const double x : {0.95, 0.85, 0.65, 0.52}) {
      std::vector<Vector3d> points = of_a;
      points.emplace_back(x, 0.01, 0.01);
      add(cropped, points);
    }
    EXPECT_EQ(cropped.mayTouch(), "vanished 15 cm from a: it may touch") << has_box;
  }
}

TEST_F(Follower, DoesNotAskForWhatIsStillSeenOutsideOfTheBox) {
  config_.box = Eigen::AlignedBox3d(Vector3d(-2, -2, 0), Vector3d(9, 2, 2));
  CloudProcessor cropped(config_);
  for (const double z : {0.45, 0.25, 0.05, -0.05}) add(cropped, {{0.65, 0, z}});
  EXPECT_EQ(cropped.mayTouch(), "");
  for (const double z : {0.05, 0.05, 5.0}) add(cropped, {{0.65, 0, z}});
  EXPECT_NE(cropped.mayTouch(), "");
}

TEST_F(Follower, DoesNotFollowWhatMayTouch) {
  config_.touch_links = {"a"};
  approach();
  EXPECT_EQ(processor_.mayTouch(), "");
}

TEST_F(Follower, ForgetsWhatVanishedWhenItIsCleared) {
  approach();
  processor_.clear();
  EXPECT_EQ(processor_.mayTouch(), "");
}

/// A cube of 10 cm.
RigidObject heldBy(const std::string& link, const std::string& name, const Vector3d& p_LO) {
  RigidObject tool;
  tool.name = name;
  tool.attached_link = link;
  tool.elements.push_back({Box{{0.1, 0.1, 0.1}}, Isometry3d::Identity()});
  tool.X_PO.translation() = p_LO;
  return tool;
}

TEST_F(Follower, DoesNotMissWhatWasAttachedToALink) {
  struct Case {
    double x, x_of_tool;  // its cube reaches 10 cm further with the padding, its voxels up to 20
    bool is_hidden;
  };
  for (const Case& one : {Case{0.65, 0.65, false}, {0.705, 0.61, false}, {-0.65, -0.65, true}}) {
    description_.objects.clear();
    CloudProcessor processor(config_);
    for (int i = 0; i < 3; ++i) add(processor, {{one.x, 0.01, 0.01}});
    if (one.is_hidden) add(processor, wallAt(0.5));
    description_.objects.push_back(heldBy("a", "tool", {one.x_of_tool, 0, 0}));
    EXPECT_EQ(add(processor, wallAt(one.is_hidden ? 0.5 : -0.5))->size(), 0u);
    EXPECT_EQ(processor.mayTouch(), "");
    EXPECT_EQ(add(processor, {{one.x, 0.01, 0.01}})->size(), 0u);
    EXPECT_EQ(processor.mayTouch(), "");
  }
}

// Random clouds about box a, and what it holds; what is attached meanwhile stands 10 m away.
TEST_F(Follower, IsNotDisturbedByWhatIsAttachedElsewhere) {
  RandomInputs random;
  int nb_suspect = 0, nb_hidden = 0;
  for (int series = 0; series < 100; ++series) {
    CloudProcessor alone(config_), disturbed(config_);
    std::vector<RigidObject> held, tools;
    if (series % 2) held = tools = {heldBy("a", "held", {0.75, 0, 0})};
    for (int cloud = 0; cloud < 12; ++cloud) {
      std::vector<Vector3d> points = {{-3.0, 0.01, 0.01}};
      if (random.integer(0, 2) == 0) points = wallAt(0.5);
      const double x = random.uniform(0.52, 0.95) * (random.integer(0, 1) ? 1.0 : -1.0);
      if (random.integer(0, 2) > 0) points.push_back({x, 0.01, 0.01});
      description_.objects = held;
      const auto expected = add(alone, points);
      if (random.integer(0, 2) == 0) {
        tools.push_back(
            heldBy("b", std::string(1, static_cast<char>('c' + tools.size())), {1, 0, 0}));
      }
      description_.objects = tools;
      const auto found = add(disturbed, points);
      SCOPED_TRACE("series " + std::to_string(series) + ", cloud " + std::to_string(cloud));
      ASSERT_EQ(disturbed.mayTouch(), alone.mayTouch());
      ASSERT_EQ(found->size(), expected->size());
      nb_suspect += alone.mayTouch() != "";
      nb_hidden += expected->size() != 0 && points.size() > 2;
    }
  }
  EXPECT_GT(nb_suspect, 100);
  EXPECT_GT(nb_hidden, 100);
}

TEST_F(Follower, DoesNotTakeWhatWasHeldForWhatVanished) {
  const Vector3d held(0.65, 0.22, 0.01), elsewhere(0.0, 0.0, 0.8);
  for (const bool is_moved : {false, true}) {
    CloudProcessor processor(config_);
    const auto show = [&](const Vector3d& p_W) {
      for (int i = 0; i < 3; ++i) add(processor, {p_W, held});
      return processor.mayTouch();
    };
    description_.objects = {heldBy("a", "tool", held)};
    for (const double x : {0.95, 0.85, 0.65, 0.52}) add(processor, {{x, 0.01, 0.01}});
    const std::string problem = "vanished 12 cm from tool: it may touch";
    EXPECT_EQ(show({-3, 0, 0}), problem);
    description_.objects.clear();
    if (is_moved) description_.objects = {heldBy("a", "tool", elsewhere)};
    keeps_more_ = true;
    EXPECT_EQ(show({-3, 0, 0}), problem);
    EXPECT_EQ(show({0.75, -0.15, 0.01}), "");
  }
}

TEST_F(Follower, WhatIsAttachedIsNoObstacleFromTheNextCloudOnHoweverLongVoxelsStay) {
  config_.decay = 10.0;
  config_.replace = false;
  CloudProcessor processor(config_);
  const Vector3d held(2.0, 0.2, 0.01), other(2.0, 3.2, 0.01);
  EXPECT_EQ(add(processor, {held, other})->size(), 2u);
  description_.objects = {heldBy("a", "tool", held)};
  const auto voxels = add(processor, {{-3, 0, 0}});
  EXPECT_FALSE(voxels->anyWithin({held, held}, 0.1));
  EXPECT_TRUE(voxels->anyWithin({other, other}, 0.1));
  EXPECT_EQ(voxels->size(), 2u);
}

TEST_F(Follower, RemembersWhatTheRobotHidesForAsLongAsItDoes) {
  for (int i = 0; i < 2; ++i) add(processor_, {{-0.65, 0.01, 0.01}});
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(add(processor_, wallAt(0.5))->size(), 1u);  // box a, seen from the front
  }
  EXPECT_EQ(processor_.mayTouch(), "");
  std::vector<Vector3d> beside = wallAt(-3.0);
  EXPECT_GT(add(processor_, beside)->size(), 1u);
  const auto voxels = add(processor_, beside);
  EXPECT_FALSE(voxels->anyWithin({{-0.65, 0, 0}, {-0.65, 0, 0}}, 0.2));
  EXPECT_THAT(processor_.mayTouch(), HasSubstr("vanished 15 cm from a"));
}

TEST_F(Follower, TakesWhatTheRobotHidAndLeftForWhatItMayCarryUntilItIsSeen) {
  for (const int nb_seen : {1, 2}) {  // in one cloud alone it is noise
    CloudProcessor processor(config_);
    x_of_a_ = 0.0;
    add(processor, wallAt(3.0));
    for (int i = 0; i < nb_seen; ++i) add(processor, {{-0.65, 0.01, 0.01}});
    for (int i = 0; i < 3; ++i) add(processor, wallAt(0.5));
    EXPECT_EQ(processor.mayTouch(), "");
    x_of_a_ = 1.0;
    add(processor, wallAt(1.5));
    EXPECT_EQ(processor.mayTouch() != "", nb_seen > 1) << processor.mayTouch();
    for (int i = 0; i < 2; ++i) add(processor, {{-0.65, 0.01, 0.01}});
    EXPECT_EQ(processor.mayTouch(), "");
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
    CloudProcessor processor(config_);
    x_of_a_ = 0.0;
    for (int i = 0; i < 2; ++i) add(processor, {hidden, stands, there});
    for (int i = 0; i < 3; ++i) add(processor, wallAndWhatStands(0.5));
    EXPECT_THAT(processor.mayTouch(), HasSubstr("hidden 9 cm from a"));
    x_of_a_ = robot_leaves ? 1.0 : 0.0;
    for (int i = 0; i < 2; ++i) add(processor, wallAndWhatStands(robot_leaves ? 1.5 : -3.0));
    EXPECT_THAT(processor.mayTouch(), HasSubstr("vanished 9 cm from a"));
  }
}

TEST_F(Follower, SuspectsWhatIsHiddenInPart) {
  const Vector3d nearest(-0.65, -0.05, 0.05);
  const std::vector<Vector3d> obstacle = {nearest, {-0.75, 0.05, 0.05}, {-0.75, 0.15, 0.05}};
  for (int i = 0; i < 2; ++i) add(processor_, obstacle);
  add(processor_, wallAt(0.5));
  EXPECT_EQ(processor_.mayTouch(), "");  // the nearest voxel is remembered, and in contact
  std::vector<Vector3d> seen_through = {{-3.0, -0.1, 0.1}};  // beside the nearest voxel
  for (const Vector3d& p : wallAt(0.5)) {
    const bool is_before_it = p.y() < 0.0 && p.y() > -0.19 && p.z() > -0.01 && p.z() < 0.19;
    if (!is_before_it) seen_through.push_back(p);
  }
  for (int i = 0; i < 3; ++i) {
    const auto voxels = add(processor_, seen_through);
    EXPECT_FALSE(voxels->anyWithin({nearest, nearest}, 0.0));
    EXPECT_EQ(processor_.mayTouch(), "hidden 15 cm from a: it may touch");
  }
}

/// Before it was hidden it may have moved on as far as it can from one cloud to the next.
TEST_F(Follower, SuspectsWhatIsHiddenAndNotWithinThePaddingOfALink) {
  const auto hide = [&](double x_of_a) {
    x_of_a_ = x_of_a;
    add(processor_, wallAt(x_of_a + 0.5));
    return processor_.mayTouch();
  };
  for (int i = 0; i < 2; ++i) add(processor_, {{-0.71, 0.01, 0.01}});
  EXPECT_EQ(hide(-0.06), "");  // its voxel, of 10 cm, is in contact: 14 cm away
  EXPECT_EQ(hide(-0.04), "hidden 21 cm from a: it may touch");
  EXPECT_EQ(hide(-0.05), "hidden 20 cm from a: it may touch");  // as near as rounding tells
  EXPECT_EQ(hide(-0.06), "");
  EXPECT_EQ(hide(-0.02), "hidden 23 cm from a: it may touch");
  add(processor_, {{-0.71, 0.01, 0.01}});
  EXPECT_EQ(processor_.mayTouch(), "");
}

TEST_F(Follower, DoesNotMissWhatTheRobotHidWhereItHasShownItsPlaceSince) {
  for (int i = 0; i < 2; ++i) add(processor_, {{-0.65, 0.01, 0.01}});
  for (int i = 0; i < 3; ++i) add(processor_, wallAt(0.5));
  for (int i = 0; i < 2; ++i) add(processor_, {{-0.85, 0.15, 0.01}});  // it has moved
  add(processor_, wallAt(-3.0));
  EXPECT_EQ(processor_.mayTouch(), "");
  x_of_a_ = 1.0;
  add(processor_, wallAt(1.5));
  EXPECT_EQ(processor_.mayTouch(), "");
}

TEST_F(Follower, RemembersNoLongerWhatIsFarFromTheRobot) {
  for (int i = 0; i < 2; ++i) add(processor_, {{-1.65, 0.01, 0.01}});
  add(processor_, wallAt(0.5));
  EXPECT_EQ(add(processor_, wallAt(0.5))->size(), 0u);
}

}  // namespace collision_pairs::test_followed_obstacles
