// A cloud of points is checked as the same boxes as a static object would be.
#include <cmath>

#include "cloud_as_boxes.h"

namespace collision_pairs::test_cloud_check {

using Eigen::Isometry3d;

TEST_F(CloudCheck, VoxelsAreCheckedAsTheSameBoxesAtEveryFidelity) {
  for (const Fidelity fidelity :
       {Fidelity::AABB, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
    SCOPED_TRACE(fidelityName(fidelity));
    CheckSettings settings;
    settings.fidelity = fidelity;
    expectSameAtRandom(settings, 60);
    settings.alarm_distance = 0.0;
    expectSameAtRandom(settings, 30);
  }
}

TEST_F(CloudCheck, AVerdictOnlyIsTheVerdictOfTheSameBoxes) {
  CheckSettings settings;
  settings.verdict_only = true;
  for (const Fidelity fidelity : {Fidelity::AABB, Fidelity::OBB, Fidelity::MESH}) {
    settings.fidelity = fidelity;
    expectSameAtRandom(settings, 60);
  }
}

TEST_F(CloudCheck, TheSmallestDistanceIsThatOfTheSameBoxesHoweverFarAway) {
  CheckSettings settings;
  settings.min_distance = true;
  settings.alarm_distance = 0.001;
  expectSameAtRandom(settings, 60);
  description_.check_self = false;  // the cloud alone
  for (int round = 0; round < 40; ++round) {
    setVoxels(0.05,
              {{random_.integer(-60, 60), random_.integer(-60, 60), random_.integer(-60, 60)},
               {random_.integer(-60, 60), random_.integer(-60, 60), random_.integer(-60, 60)}});
    throwAbout(random_, 0.2, poses_);
    expectSame(settings);
  }
}

TEST_F(CloudCheck, PaddingsRulesAndTouchLinksMeanTheSame) {
  description_.settings.padding = 0.02;
  description_.settings.link_padding = {{"b", 0.0}};
  description_.settings.pair_padding = {{"a", "cloud", 0.07}};
  description_.settings.pair_rules = {{PairRule::Verdict::DENY, "d", "cloud"}};
  touch_links_ = {"c"};
  expectSameAtRandom({}, 60);
}

TEST_F(CloudCheck, LinksThatOnlyAnOuterShapeBoundsMeanTheSame) {
  description_.settings.max_hull_vertices = 8;
  description_.settings.link_fidelity = {{"a", Fidelity::OBB}, {"e", Fidelity::CONVEX}};
  expectSameAtRandom({}, 60);
}

// All that is known then is how far apart the boxes are: of the nearest voxel, not of many.
TEST_F(CloudCheck, BoundsAreThoseOfTheSameBoxesWhereTheTimeIsSpentAtOnce) {
  const auto nothingLeft = [now = 0.0]() mutable { return now += 1.0; };
  CheckSettings settings;
  settings.time_budget = 0.5;
  int nb_pairs = 0;
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    settings.alarm_distance = round % 2 == 0 ? 0.3 : 0.0;
    const double size = random_.uniform(0.01, 0.1);
    std::vector<VoxelCell> few{VoxelCell::Zero()};  // of a block
    for (const VoxelCell& cell : randomCells(random_, static_cast<int>(0.8 / size))) {
      if (random_.integer(0, 4) == 0) few.push_back(cell);
    }
    setVoxels(size, few);
    object_->setClock(nothingLeft), cloud_->setClock(nothingLeft);
    throwAbout(random_, 0.8, poses_);
    expectSame(settings);
    nb_pairs += static_cast<int>(cloud_->report().nb_unresolved);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(nb_pairs, 500);
}

// They are of boxes around many voxels then, and so are their points.
TEST_F(CloudCheck, BoundsAreTrueWheneverTheTimeIsSpent) {
  int nb_open = 0, nb_told = 0;
  description_.check_self = false;
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    setVoxels(0.02, randomCells(random_, 40));
    cloud_->setClock([now = 0.0]() mutable { return now += 1.0; });
    throwAbout(random_, 0.8, poses_);
    CheckSettings settings;
    settings.alarm_distance = 0.2;
    object_->detect(poses_, settings);
    const CloudPairs exact = byName(*object_);
    settings.time_budget = random_.uniform(0.0, 40.0);
    const CollisionReport& report = checkCloud(settings);
    expectContactsAreOfVoxels(report);
    for (const auto& [names, pair] : byName(*cloud_)) {
      const auto truth = exact.find(names);
      if (truth != exact.end()) {
        EXPECT_LE(pair.distance, std::max(truth->second.distance, 0.0) + 1e-9);
      }
      if (pair.state != PairState::UNRESOLVED) {
        ++nb_told;
        continue;
      }
      ++nb_open;
      if (pair.distance <= 0.0) continue;
      const Contact& points = *report.nearestContact(pair);  // their boxes may overlap
      EXPECT_LE(points.nhat_W.dot(points.p_WSecond - points.p_WFirst), pair.distance + 1e-9);
    }
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(nb_open, 20);
  EXPECT_GT(nb_told, 20);
}

TEST_F(CloudCheck, FclAnswersTheSameVoxelsAsItDoesTheSameBoxes) {
  description_.settings.narrow_phase = NarrowPhaseMethod::FCL;
  CheckSettings settings;
  settings.alarm_distance = 0.0;
  settings.verdict_only = true;
  expectSameAtRandom(settings, 40);
}

TEST_F(CloudCheck, ObjectsAttachedToLinksMeetVoxels) {
  RigidObject tool;
  tool.name = "tool";
  tool.attached_link = "a";
  tool.elements = {{Box{{0.1, 0.1, 0.5}}, Isometry3d::Identity()},
                   {HalfSpace{}, Isometry3d(Eigen::Translation3d(0, 0, -1.0))}};
  description_.objects.push_back(tool);
  expectSameAtRandom({}, 20);
}

/// A box link whose faces lie exactly on cell borders.
class CellBorders : public CloudCheck {
 protected:
  CellBorders() {
    description_.robots[0].model = RobotModel::fromUrdf(
        "<robot name='one'>" + emptyLink("root") + linkWith("box", "<box size='0.5 0.5 0.5'/>") +
            joint("float", "floating", "root", "box", "0 0 0", "") + "</robot>",
        testMesh);
  }
};

TEST_F(CellBorders, TouchingFacesEdgesAndCornersAreContactsOnEitherSideOfTheOrigin) {
  for (const double size : {0.25, 0.125, 0.1}) {  // 0.1 is not exact in binary
    const int half = static_cast<int>(std::lround(0.25 / size * 2.0)) / 2;
    if (half * size != 0.25) continue;
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          // The cell beside, before or at the corner of the box, just touching it.
          const auto along = [&](int side) { return side > 0 ? half : side < 0 ? -half - 1 : 0; };
          for (const double shift : {-4.0, 0.0, 8.0}) {
            setVoxels(size, {VoxelCell(along(x), along(y), along(z)).array() +
                             static_cast<int>(shift / size)});
            poses_.X_WB[0].translation().setConstant(shift);
            CheckSettings settings;
            settings.alarm_distance = 0.0;
            expectSame(settings);
            EXPECT_NEAR(cloud_->report().min_distance, 0.0, 1e-12);
            settings.verdict_only = true;
            EXPECT_EQ(checkCloud(settings).verdict, Verdict::COLLISION);
          }
        }
      }
    }
  }
}

TEST_F(CellBorders, OneCellFurtherIsApartByOneCell) {
  setVoxels(0.125, {{3, 0, 0}, {-4, 0, 0}});
  CheckSettings settings;
  settings.alarm_distance = 0.125;
  EXPECT_EQ(checkCloud(settings).verdict, Verdict::FREE);
  ASSERT_EQ(cloud_->report().pairs.size(), 1u);
  EXPECT_NEAR(cloud_->report().min_distance, 0.125, 1e-12);
}

// The surface is near neither voxel: only whether a voxel is inside tells one from the other.
TEST_F(CloudCheck, AVoxelInTheWallOfAHollowBodyIsInContactBesideOneInTheHollow) {
  const TriangleMesh hollow = joined(boxMesh({1.0, 1.0, 1.0}), insideOut(boxMesh({0.3, 0.3, 0.3})));
  description_.robots[0].model = RobotModel::fromUrdf(
      "<robot name='r'>" + linkWith("shell", "<mesh filename='hollow'/>") + "</robot>",
      [&](const std::string&, const Eigen::Vector3d&) {
        return std::make_shared<const TriangleMesh>(hollow);
      });
  for (int round = 0; round < 50; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const auto cell = [&](int low, int high) { return random_.integer(low, high); };
    std::vector<VoxelCell> cells = {{cell(-4, 3), cell(-4, 3), cell(-4, 3)}};  // in the hollow
    if (round % 5 != 0) {
      VoxelCell in_the_wall(cell(-17, 16), cell(-17, 16), cell(-17, 16));
      in_the_wall[round % 3] = round % 2 == 0 ? cell(8, 17) : cell(-18, -9);
      cells.push_back(in_the_wall);
    }
    setVoxels(0.05, cells);
    const CollisionReport& report = checkCloud({});
    EXPECT_EQ(report.verdict, cells.size() == 2 ? Verdict::COLLISION : Verdict::FREE);
    expectSame({});
  }
}

}  // namespace collision_pairs::test_cloud_check
