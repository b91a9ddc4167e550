// A cloud of points is checked as the same boxes as a static object would be.
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/occupied_voxels.h"
#include "mixed_robot.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ByName = std::map<std::pair<std::string, std::string>, PairReport>;

/// Patches of walls, blocks and single cells about the origin.
std::vector<VoxelCell> randomCells(RandomInputs& random, int reach) {
  std::vector<VoxelCell> cells;
  for (int patch = random.integer(1, 12); patch > 0; --patch) {
    const auto one = [&] { return random.integer(-reach, reach); };
    const VoxelCell corner(one(), one(), one());
    VoxelCell size(random.integer(1, 8), random.integer(1, 8), random.integer(1, 8));
    if (patch % 3 != 0) size[patch % 3] = 1;
    for (int x = 0; x < size[0]; ++x) {
      for (int y = 0; y < size[1]; ++y) {
        for (int z = 0; z < size[2]; ++z) cells.push_back(corner + VoxelCell(x, y, z));
      }
    }
  }
  return cells;
}

/// The oracle: the same boxes as one object. No cell twice.
RigidObject asObject(const std::vector<VoxelCell>& cells, double size) {
  RigidObject object;
  object.name = "cloud";
  std::set<std::array<int, 3>> known;
  for (const VoxelCell& cell : cells) {
    if (!known.insert({cell[0], cell[1], cell[2]}).second) continue;
    Isometry3d X = Isometry3d::Identity();
    X.translation() = size * (cell.cast<double>() + Vector3d::Constant(0.5));
    object.elements.push_back({Box{Vector3d::Constant(size)}, X});
  }
  return object;
}

class CloudCheck : public testing::Test {
 protected:
  CloudCheck() { description_.robots.push_back({robot_, std::nullopt, ""}); }

  void setVoxels(double size, const std::vector<VoxelCell>& cells) {
    SceneDescription with_object = description_;
    with_object.objects.push_back(asObject(cells, size));
    with_object.objects.back().touch_links = touch_links_;
    object_ = std::make_unique<CollisionDetector>(CollisionScene::build(with_object));
    SceneDescription with_cloud = description_;
    with_cloud.clouds.push_back(cloudOf("cloud", size, touch_links_));
    cloud_ = std::make_unique<CollisionDetector>(CollisionScene::build(with_cloud));
    voxels_ = std::make_shared<const OccupiedVoxels>(size, cells);
    poses_.resize(cloud_->scene().bodies().size());
  }

  const CollisionReport& checkCloud(const CheckSettings& settings) {
    BodyPoses poses = poses_;
    poses.voxels = {voxels_};
    return cloud_->detect(poses, settings);
  }

  static ByName byName(const CollisionDetector& detector) {
    ByName pairs;
    const auto& models = detector.scene().models();
    for (const PairReport& pair : detector.report().pairs) {
      pairs[{models[pair.first].name, models[pair.second].name}] = pair;
    }
    return pairs;
  }

  void expectSame(const CheckSettings& settings) {
    const CollisionReport& wanted = object_->detect(poses_, settings);
    const CollisionReport& found = checkCloud(settings);
    EXPECT_EQ(found.verdict, wanted.verdict);
    if (settings.verdict_only) return;
    EXPECT_NEAR(found.min_distance, wanted.min_distance, 1e-9);
    EXPECT_EQ(found.min_distance_is_bound, wanted.min_distance_is_bound);
    EXPECT_EQ(found.nb_boxes, wanted.nb_boxes);
    const ByName wanted_pairs = byName(*object_), found_pairs = byName(*cloud_);
    ASSERT_EQ(found_pairs.size(), wanted_pairs.size());
    for (const auto& [names, pair] : wanted_pairs) {
      SCOPED_TRACE(names.first + " and " + names.second);
      const auto same = found_pairs.find(names);
      ASSERT_TRUE(same != found_pairs.end());
      EXPECT_EQ(same->second.state, pair.state);
      EXPECT_NEAR(same->second.distance, pair.distance, 1e-9);
    }
    expectContactsAreOfVoxels(found);
  }

  void expectContactsAreOfVoxels(const CollisionReport& report) const {
    const CollisionScene& scene = cloud_->scene();
    const std::uint32_t element = scene.clouds()[0].element;
    for (const PairReport& pair : report.pairs) {
      const Contact* contact = report.nearestContact(pair);
      const bool is_first = contact->elements.first == element;
      if (!is_first && contact->elements.second != element) continue;
      bool is_occupied = false;
      voxels_->forEach([&](const VoxelCell& cell) { is_occupied |= cell == contact->voxel; });
      EXPECT_TRUE(is_occupied);
    }
  }

  void expectSameAtRandom(const CheckSettings& settings, int rounds) {
    for (int round = 0; round < rounds; ++round) {
      SCOPED_TRACE("round " + std::to_string(round));
      const double size = random_.uniform(0.01, 0.1);
      setVoxels(size, randomCells(random_, static_cast<int>(0.6 / size)));
      throwAbout(random_, 0.6, poses_);
      expectSame(settings);
      if (testing::Test::HasFailure()) return;
    }
  }

  RandomInputs random_;
  std::shared_ptr<const RobotModel> robot_ = mixedRobot();
  SceneDescription description_;
  std::vector<std::string> touch_links_;
  std::unique_ptr<CollisionDetector> object_, cloud_;
  std::shared_ptr<const OccupiedVoxels> voxels_;
  BodyPoses poses_;
};

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

TEST_F(CloudCheck, WithoutVoxelsNothingIsFree) {
  setVoxels(0.05, {{100, 100, 100}});
  poses_.X_WB.assign(poses_.X_WB.size(), Isometry3d::Identity());
  for (std::size_t i = 0; i < poses_.X_WB.size(); ++i) poses_.X_WB[i].translation().x() = 2.0 * i;
  EXPECT_EQ(checkCloud({}).verdict, Verdict::FREE);
  const auto cloud = static_cast<std::uint32_t>(cloud_->scene().findModel("cloud"));
  EXPECT_EQ(cloud_->detect(poses_, {}).verdict, Verdict::UNKNOWN);
  EXPECT_EQ(cloud_->report().left_out, std::vector<std::uint32_t>{cloud});
  voxels_ = nullptr;
  EXPECT_EQ(checkCloud({}).verdict, Verdict::UNKNOWN);
  voxels_ = std::make_shared<const OccupiedVoxels>(0.05, std::vector<VoxelCell>{});
  EXPECT_EQ(checkCloud({}).verdict, Verdict::FREE);
  voxels_ =
      std::make_shared<const OccupiedVoxels>(0.05, std::vector<OccupiedVoxels::Block>{}, true);
  EXPECT_EQ(checkCloud({}).verdict, Verdict::UNKNOWN);
  EXPECT_EQ(cloud_->report().left_out, std::vector<std::uint32_t>{cloud});
}

TEST_F(CloudCheck, ATruncatedCloudIsStillAContact) {
  setVoxels(0.05, {{0, 0, 0}});
  voxels_ = std::make_shared<const OccupiedVoxels>(
      0.05, std::vector<OccupiedVoxels::Block>{{{0, 0, 0}, 1}}, true);
  EXPECT_EQ(checkCloud({}).verdict, Verdict::COLLISION);
}

TEST_F(CloudCheck, VoxelsOfAnotherSizeAndTooManyCloudsAreRefused) {
  setVoxels(0.05, {{0, 0, 0}});
  const auto other = std::make_shared<const OccupiedVoxels>(0.04, std::vector<VoxelCell>{});
  poses_.voxels = {other};
  EXPECT_THROW(cloud_->detect(poses_, {}), InputError);
  poses_.voxels = {voxels_, voxels_};
  EXPECT_THROW(cloud_->detect(poses_, {}), InputError);
  EXPECT_THROW(object_->detect(poses_, {}), InputError);
}

TEST_F(CloudCheck, TheAnswerDependsOnTheVoxelsOfThisCheckAlone) {
  setVoxels(0.05, randomCells(random_, 12));
  throwAbout(random_, 0.6, poses_);
  const CollisionReport first = checkCloud({});
  const auto before = voxels_;
  for (int i = 0; i < 5; ++i) {
    voxels_ = std::make_shared<const OccupiedVoxels>(0.05, randomCells(random_, 12));
    checkCloud({});
  }
  voxels_ = before;
  const CollisionReport& again = checkCloud({});
  ASSERT_EQ(again.contacts.size(), first.contacts.size());
  for (std::size_t i = 0; i < first.contacts.size(); ++i) {
    EXPECT_EQ(again.contacts[i].p_WFirst, first.contacts[i].p_WFirst);
    EXPECT_EQ(again.contacts[i].depth, first.contacts[i].depth);
    EXPECT_EQ(again.contacts[i].voxel, first.contacts[i].voxel);
  }
  EXPECT_EQ(again.candidates, first.candidates);
}

TEST_F(CloudCheck, PairsGivenOneByOneAreTheOnlyOnesLookedAt) {
  setVoxels(0.05, randomCells(random_, 12));
  poses_.voxels = {voxels_};
  CheckSettings settings;
  settings.alarm_distance = 0.5;
  settings.min_distance = true;
  const auto cloud = static_cast<std::uint32_t>(cloud_->scene().findModel("cloud"));
  const auto link = static_cast<std::uint32_t>(cloud_->scene().findModel("d"));
  cloud_->beginNarrowPhase(poses_, settings);
  cloud_->addCollisionPair(link, cloud);
  const CollisionReport& report = cloud_->endNarrowPhase();
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(std::minmax(report.pairs[0].first, report.pairs[0].second), std::minmax(cloud, link));
}

TEST_F(CloudCheck, TimeThatIsSpentLeavesNoPairOut) {
  CheckSettings settings;
  settings.alarm_distance = 0.2;
  int nb_bounds = 0;
  for (int round = 0; round < 200; ++round) {
    setVoxels(0.05, randomCells(random_, 12));
    throwAbout(random_, 0.6, poses_);
    const CollisionReport exact = checkCloud(settings);
    const ByName exact_pairs = byName(*cloud_);
    double now = 0.0;
    cloud_->setClock([&] { return now += 1.0; });
    for (const double budget : {1.0, 5.0, 20.0, 100.0}) {
      settings.time_budget = budget;
      const CollisionReport& hurried = checkCloud(settings);
      EXPECT_EQ(hurried.candidates, exact.candidates);
      EXPECT_LE(hurried.min_distance, exact.min_distance + 1e-9);
      EXPECT_FALSE(hurried.verdict == Verdict::FREE && exact.verdict != Verdict::FREE);
      EXPECT_FALSE(hurried.verdict == Verdict::COLLISION && exact.verdict != Verdict::COLLISION);
      EXPECT_EQ(hurried.budget_spent, hurried.nb_unresolved > 0);
      std::uint32_t nb = hurried.nb_unresolved;
      for (const std::uint32_t count : hurried.nb_settled) nb += count;
      EXPECT_EQ(nb, hurried.candidates.size());
      const ByName found = byName(*cloud_);
      for (const auto& [names, pair] : exact_pairs) {
        ASSERT_TRUE(found.count(names)) << names.first << " and " << names.second;
        const PairReport& same = found.at(names);
        EXPECT_LE(same.distance, pair.distance + 1e-9);
        if (same.state == PairState::UNRESOLVED) continue;
        EXPECT_EQ(same.state, pair.state);
        nb_bounds += same.certainty == Certainty::BOUND;
        if (same.certainty == Certainty::EXACT) {
          EXPECT_NEAR(same.distance, pair.distance, 1e-9);
        }
      }
    }
    settings.time_budget = 0.0;
  }
  EXPECT_GT(nb_bounds, 0);  // of the depth of a cloud whose other voxels were not all looked at
}

TEST_F(CloudCheck, NamesAndSizesOfCloudsAreChecked) {
  const auto build = [&](const RigidObject& cloud) {
    SceneDescription description = description_;
    description.clouds.push_back(cloud);
    CollisionScene::build(description);
  };
  EXPECT_THROW(build(cloudOf("a", 0.05, {})), InputError);  // a link
  EXPECT_THROW(build(cloudOf("", 0.05, {})), InputError);
  EXPECT_THROW(build(cloudOf("cloud", 0.0, {})), InputError);
  EXPECT_THROW(build(cloudOf("cloud", NAN, {})), InputError);
  EXPECT_THROW(build(cloudOf("cloud", 0.05, {"nowhere"})), InputError);
  RigidObject no_cube = cloudOf("cloud", 0.05, {});
  no_cube.elements[0].shape = Box{{1, 1, 2}};
  EXPECT_THROW(build(no_cube), InputError);
}

}  // namespace
}  // namespace collision_pairs
