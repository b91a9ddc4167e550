// What a check says of clouds that are unknown or truncated, of some pairs alone or in a given
// time, and which clouds it refuses.
#include <cmath>

#include "cloud_as_boxes.h"
#include "collision_pairs/input_error.h"

namespace collision_pairs::test_cloud_input {

using Eigen::Isometry3d;

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
    const CloudPairs exact_pairs = byName(*cloud_);
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
      const CloudPairs found = byName(*cloud_);
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

}  // namespace collision_pairs::test_cloud_input
