// A check with a time budget, by a clock that advances by one second each time it is read.
#include <map>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "mixed_robot.h"

namespace collision_pairs::test_time_budget {

using Names = std::pair<std::uint32_t, std::uint32_t>;

class TimeBudget : public testing::Test {
 protected:
  TimeBudget()
      : scene_(CollisionScene::build(mixedRobot(2), std::nullopt, nullptr)),
        unhurried_(scene_),
        hurried_(scene_) {
    poses_.resize(scene_->bodies().size());
    settings_.alarm_distance = 0.1;
    setClock();
  }

  void setClock() {
    hurried_.setClock([this] {
      ++nb_readings_;
      return now_ += 1.0;
    });
  }

  void hurryThrough(std::shared_ptr<const CollisionScene> scene) {
    scene_ = std::move(scene);
    hurried_ = CollisionDetector(scene_);
    setClock();
  }

  const CollisionReport& checkWithin(double seconds) {
    CheckSettings settings = settings_;
    settings.time_budget = seconds;
    nb_readings_ = 0;
    return hurried_.detect(poses_, settings);
  }

  static std::map<Names, PairReport> byModels(const CollisionReport& report) {
    std::map<Names, PairReport> pairs;
    for (const PairReport& pair : report.pairs) pairs[{pair.first, pair.second}] = pair;
    return pairs;
  }

  static std::uint32_t nbSettled(const CollisionReport& report) {
    std::uint32_t sum = 0;
    for (const std::uint32_t count : report.nb_settled) sum += count;
    return sum;
  }

  /// All that is promised of a report that time may have cut short.
  static void expectTrueOf(const CollisionReport& hurried, const CollisionReport& exact) {
    EXPECT_EQ(nbSettled(hurried) + hurried.nb_unresolved, hurried.candidates.size());
    EXPECT_EQ(hurried.candidates.size(), exact.candidates.size());
    EXPECT_GE(hurried.in_collision, exact.in_collision);
    EXPECT_LE(hurried.min_distance, exact.min_distance + 1e-6);
    const auto found = byModels(hurried);
    for (const auto& [names, pair] : byModels(exact)) {
      const auto same = found.find(names);
      ASSERT_TRUE(same != found.end()) << "a pair was left out";
      EXPECT_LE(same->second.distance, pair.distance + 1e-9);
      if (pair.state == PairState::CONTACT) {
        EXPECT_NE(same->second.state, PairState::NEAR);
      }
      if (same->second.state == PairState::UNRESOLVED) continue;
      EXPECT_EQ(same->second.state, pair.state);
    }
  }

  void expectTrueInAnyTime(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      throwAbout(random_, 0.7, poses_);
      const CollisionReport exact = unhurried_.detect(poses_, settings_);
      const double last = 4.0 * static_cast<double>(exact.candidates.size()) + 4.0;
      for (double seconds = 0.5; seconds < last; seconds += random_.uniform(0.5, 9.0)) {
        expectTrueOf(checkWithin(seconds), exact);
      }
    }
  }

  RandomInputs random_;
  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector unhurried_, hurried_;
  BodyPoses poses_;
  CheckSettings settings_;
  double now_ = 0.0;
  int nb_readings_ = 0;
};

TEST_F(TimeBudget, DecidesEachPairOrCallsItUnresolvedWithALowerBound) { expectTrueInAnyTime(60); }

// Hulls say nothing of a floor, and are nearer to each other by the padding.
TEST_F(TimeBudget, BoundsPairsWithPaddingAndAFloorToo) {
  SceneDescription description;
  description.robots.push_back({mixedRobot(2), std::nullopt, ""});
  description.settings.padding = 0.04;
  description.objects = {floorAt(0.05, {})};
  hurryThrough(CollisionScene::build(description));
  unhurried_ = CollisionDetector(scene_);
  expectTrueInAnyTime(30);
}

TEST_F(TimeBudget, ThatIsNeverSpentChangesNothing) {
  for (int round = 0; round < 60; ++round) {
    throwAbout(random_, 0.7, poses_);
    const CollisionReport exact = unhurried_.detect(poses_, settings_);
    const CollisionReport& found = checkWithin(1e9);
    EXPECT_EQ(found.nb_unresolved, 0u);
    EXPECT_FALSE(found.budget_spent);
    EXPECT_EQ(found.min_distance, exact.min_distance);
    EXPECT_EQ(found.min_distance_is_bound, exact.min_distance_is_bound);
    ASSERT_EQ(found.pairs.size(), exact.pairs.size());
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
      EXPECT_EQ(found.pairs[i].distance, exact.pairs[i].distance);
      EXPECT_EQ(found.pairs[i].state, exact.pairs[i].state);
      EXPECT_EQ(found.pairs[i].fidelity, exact.pairs[i].fidelity);
    }
  }
}

TEST_F(TimeBudget, SpentAtOnceLeavesTheAlignedBoxes) {
  throwAbout(random_, 0.3, poses_);
  for (const double seconds : {0.5, 1.0}) {  // before the first question, and just then
    const CollisionReport& report = checkWithin(seconds);
    EXPECT_TRUE(report.budget_spent);
    EXPECT_EQ(report.nb_unresolved, report.candidates.size());
    ASSERT_FALSE(report.pairs.empty());
    for (const PairReport& pair : report.pairs) {
      EXPECT_EQ(pair.state, PairState::UNRESOLVED);
      EXPECT_EQ(pair.fidelity, Fidelity::AABB);
      EXPECT_EQ(pair.certainty, Certainty::UNFINISHED);
    }
  }
}

TEST_F(TimeBudget, OnceSpentIsAskedOnceMoreInEachRoundAndNoPairIsClimbedThen) {
  throwAbout(random_, 0.3, poses_);
  const auto nb_candidates = static_cast<int>(checkWithin(0.5).candidates.size());
  // One reading sets the deadline, one a candidate asks before its boxes, one a round ends it.
  EXPECT_EQ(nb_readings_, 1 + nb_candidates + 2);
}

TEST_F(TimeBudget, MoreOfItSettlesNoLess) {
  for (int round = 0; round < 30; ++round) {
    throwAbout(random_, 0.4, poses_);
    std::uint32_t before = 0;
    for (double seconds = 1.5; seconds < 400.0; seconds += 7.0) {
      const std::uint32_t settled = nbSettled(checkWithin(seconds));
      EXPECT_GE(settled, before);
      before = settled;
    }
  }
}

TEST_F(TimeBudget, GoesToTheSmallestLowerBoundFirst) {
  // Turned boxes need no triangles: the first step after the boxes settles the first pair.
  std::string xml = emptyLink("root");
  for (const char* name : {"a", "b", "c"}) {
    xml += boxLink(name, 1.0) +
           joint(std::string("float_") + name, "floating", "root", name, "0 0 0", "");
  }
  hurryThrough(CollisionScene::build(robotFrom(xml), std::nullopt, nullptr));
  poses_.resize(3);
  const double x[] = {0.0, 0.9, 1.6};  // a-b 0.1 deep, b-c 0.3 deep, a-c 0.6 apart
  for (int i = 0; i < 3; ++i) {
    poses_.X_WB[scene_->models()[i].body] =
        Eigen::Translation3d(x[i], 0, 0) * Eigen::Isometry3d::Identity();
  }
  settings_.alarm_distance = 0.7;
  const auto pairs = byModels(checkWithin(4.5));  // three boxes, one narrow query, and it is over
  EXPECT_EQ(pairs.at({1, 2}).state, PairState::CONTACT);
  EXPECT_EQ(pairs.at({0, 1}).state, PairState::UNRESOLVED);
  EXPECT_EQ(pairs.at({0, 2}).state, PairState::UNRESOLVED);
  EXPECT_GT(pairs.at({0, 2}).distance, 0.0);
}

TEST_F(TimeBudget, AnUnresolvedPairThatIsKnownToBeApartIsNoCollision) {
  hurryThrough(CollisionScene::build(robotFrom(slidingBoxes(2)), std::nullopt, nullptr));
  poses_.resize(2);
  poses_.X_WB[scene_->models()[1].body].translation().x() = 1.05;
  const CollisionReport& report = checkWithin(0.5);
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(report.pairs[0].state, PairState::UNRESOLVED);
  EXPECT_NEAR(report.pairs[0].distance, 0.05, 1e-12);
  EXPECT_FALSE(report.in_collision);
  EXPECT_TRUE(report.min_distance_is_bound);
}

TEST_F(TimeBudget, BoundsTheMinimumThatItHasNoTimeToFind) {
  settings_.min_distance = true;
  settings_.alarm_distance = 0.0;
  for (int round = 0; round < 60; ++round) {
    throwAbout(random_, 1.5, poses_);
    const double exact = unhurried_.detect(poses_, settings_).min_distance;
    for (double seconds = 0.5; seconds < 120.0; seconds += 5.0) {
      const CollisionReport& report = checkWithin(seconds);
      EXPECT_LE(report.min_distance, exact + 1e-6);
      if (!report.min_distance_is_bound) {
        EXPECT_NEAR(report.min_distance, exact, 1e-12);
      }
      if (report.min_distance_is_bound) {
        EXPECT_TRUE(report.budget_spent);
      }
    }
  }
}

TEST_F(TimeBudget, OfAVerdictNeverSaysFreeWhereThereIsContact) {
  settings_.verdict_only = true;
  for (int round = 0; round < 200; ++round) {
    throwAbout(random_, 1.0, poses_);
    const bool exact = unhurried_.detect(poses_, settings_).in_collision;
    for (double seconds = 0.5; seconds < 100.0; seconds += 11.0) {
      const CollisionReport& report = checkWithin(seconds);
      EXPECT_GE(report.in_collision, exact);
      if (!report.budget_spent) {
        EXPECT_EQ(report.in_collision, exact);
      }
    }
  }
}

TEST_F(TimeBudget, OfAVerdictEndsAtTheFirstContactWhichIsAllThatIsReported) {
  settings_.verdict_only = true;
  int nb_contacts = 0;
  for (const Fidelity fidelity : {Fidelity::AABB, Fidelity::OBB, Fidelity::MESH}) {
    settings_.fidelity = fidelity;
    for (int round = 0; round < 50; ++round) {
      throwAbout(random_, 1.0, poses_);
      poses_.X_WB.back().linear() *= 1.01;  // no pose: its pairs are degraded
      const CollisionReport& report = checkWithin(1e9);
      if (report.verdict != Verdict::COLLISION) continue;
      ++nb_contacts;
      EXPECT_EQ(report.nb_degraded, 0u);
      ASSERT_EQ(report.pairs.size(), 1u);
      EXPECT_EQ(report.pairs[0].distance, 0.0);
      EXPECT_EQ(nbSettled(report), 1u);
      EXPECT_EQ(report.nb_unresolved, 0u);
    }
  }
  EXPECT_GT(nb_contacts, 50);
}

TEST_F(TimeBudget, ThatIsNegativeOrNoNumberIsRefused) {
  EXPECT_THROW(checkWithin(-1.0), InputError);
  EXPECT_THROW(checkWithin(std::nan("")), InputError);
}

}  // namespace collision_pairs::test_time_budget
