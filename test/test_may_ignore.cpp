// Checks of which a predicate leaves out some pairs.
#include <algorithm>
#include <atomic>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/batch_check.h"
#include "pairs_kept.h"
#include "random_case.h"

namespace collision_pairs::test_may_ignore {

constexpr double FAR = 50.0;  // metres

/// The smallest distance in a report of all pairs, of those that are kept.
template <class IsKept>
double smallestWhere(const IsKept& is_kept, const CollisionReport& all) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const PairReport& pair : all.pairs) {
    if (is_kept(pair.first, pair.second)) smallest = std::min(smallest, pair.distance);
  }
  return smallest;
}

/// A predicate that counts what it is asked.
struct Ignoring {
  std::set<ModelPair> left_out;
  std::map<ModelPair, int> asked = {};
  ModelPair last = {};

  MayIgnore predicate() {
    return [this](std::uint32_t first, std::uint32_t second) {
      last = {first, second};
      ++asked[last];
      return left_out.count({first, second}) > 0;
    };
  }
  bool keeps(std::uint32_t first, std::uint32_t second) const {
    return left_out.count({first, second}) == 0;
  }
  std::set<ModelPair> askedAbout() const {
    std::set<ModelPair> pairs;
    for (const auto& entry : asked) pairs.insert(entry.first);
    return pairs;
  }
  std::vector<ModelPair> leftOutOf(const std::set<ModelPair>& pairs) const {
    std::vector<ModelPair> found;
    for (const ModelPair& pair : pairs) {
      if (left_out.count(pair) > 0) found.push_back(pair);
    }
    return found;
  }
  /// Where no pair in reach is kept, others are asked about until one is, and not listed.
  void expectListed(const std::vector<ModelPair>& ignored) const {
    const std::vector<ModelPair> all = leftOutOf(askedAbout());
    const std::size_t nb_kept = asked.size() - all.size();
    if (nb_kept > 1 || (nb_kept == 1 && !keeps(last.first, last.second))) {
      EXPECT_EQ(ignored, all);
    } else {
      EXPECT_TRUE(std::includes(all.begin(), all.end(), ignored.begin(), ignored.end()));
    }
  }
  void expectOnceEach() const {
    for (const auto& [pair, times] : asked) {
      EXPECT_EQ(times, 1);
      EXPECT_LT(pair.first, pair.second);
    }
  }
};

std::set<ModelPair> modelsOf(const std::vector<BoxPair>& candidates, const CollisionScene& scene) {
  std::set<ModelPair> models;
  for (const BoxPair& pair : candidates) {
    models.insert(
        std::minmax(scene.elements()[pair.first].model, scene.elements()[pair.second].model));
  }
  return models;
}

TEST(APredicate, LeavesOutItsPairsAndNothingElseAndIsAskedOncePerPairWhoseBoxesMeet) {
  RandomInputs random;
  int nb_kept = 0, nb_ignored = 0, nb_unasked = 0;
  for (int round = 0; round < 150; ++round) {
    const RandomCase its(random);
    const auto scene = CollisionScene::build(its.description);
    const BodyPoses poses = randomPosesOf(random, its, *scene);
    Ignoring ignoring;
    const auto nb_models = static_cast<std::uint32_t>(scene->models().size());
    for (std::uint32_t a = 0; a < nb_models; ++a) {
      for (std::uint32_t b = a + 1; b < nb_models; ++b) {
        if (random.integer(0, 1)) ignoring.left_out.insert({a, b});
      }
    }
    const auto isKept = [&](auto first, auto second) { return ignoring.keeps(first, second); };
    CollisionDetector whole(scene), checked(scene);
    for (const double reach : {0.0, 0.1}) {
      CheckSettings settings = alarm(reach);
      settings.list_boxes = random.integer(0, 1);
      const CollisionReport all = whole.detect(poses, settings);
      settings.may_ignore = ignoring.predicate();
      ignoring.asked.clear();
      const CollisionReport& kept = checked.detect(poses, settings);
      expectPairsWhere(isKept, all, kept);
      ignoring.expectOnceEach();
      const std::set<ModelPair> in_reach = modelsOf(all.candidates, *scene);
      EXPECT_EQ(kept.ignored, ignoring.leftOutOf(in_reach));
      const std::set<ModelPair> asked = ignoring.askedAbout();
      if (kept.ignored.size() < in_reach.size()) {
        EXPECT_EQ(asked, in_reach);
      } else {
        EXPECT_TRUE(std::includes(asked.begin(), asked.end(), in_reach.begin(), in_reach.end()));
      }
      nb_kept += static_cast<int>(kept.pairs.size());
      nb_ignored += static_cast<int>(kept.ignored.size());
      const Verdict verdict = kept.verdict;

      settings.time_budget = 1e9;
      expectPairsWhere(isKept, all, checked.detect(poses, settings));
      settings.time_budget = 0.0;
      if (reach > 0.0) continue;
      settings.verdict_only = true;
      ignoring.asked.clear();
      const CollisionReport& only = checked.detect(poses, settings);
      EXPECT_EQ(only.verdict, verdict);
      ignoring.expectOnceEach();
      ignoring.expectListed(only.ignored);
    }
    CheckSettings settings = alarm(0.0);
    settings.min_distance = true;
    settings.may_ignore = ignoring.predicate();
    ignoring.asked.clear();
    const double nearest = smallestWhere(isKept, whole.detect(poses, alarm(FAR)));
    const CollisionReport& found = checked.detect(poses, settings);
    if (found.unchecked.empty()) {
      if (std::isinf(nearest)) {
        EXPECT_GT(found.min_distance, FAR);
      } else {
        EXPECT_NEAR(found.min_distance, nearest, 1e-9);
      }
    } else {
      EXPECT_EQ(found.verdict, Verdict::UNKNOWN);
    }
    ignoring.expectOnceEach();
    ignoring.expectListed(found.ignored);
    nb_unasked += ignoring.asked.size() < nb_models * (nb_models - 1) / 2;
  }
  EXPECT_GT(nb_kept, 100);
  EXPECT_GT(nb_ignored, 100);
  EXPECT_GT(nb_unasked, 100);
}

class TwoBoxes : public testing::Test {
 protected:
  TwoBoxes() { poses_.resize(2); }  // both at the origin
  std::shared_ptr<const CollisionScene> scene_ =
      CollisionScene::build(robotFrom(slidingBoxes(2)), std::nullopt, nullptr);
  CollisionDetector detector_{scene_};
  BodyPoses poses_;
};

TEST_F(TwoBoxes, OfWhichEveryPairIsIgnoredAreNotFree) {
  CheckSettings settings = alarm(0.1);
  settings.may_ignore = [](std::uint32_t, std::uint32_t) { return true; };
  const CollisionReport& report = detector_.detect(poses_, settings);
  EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
  EXPECT_EQ(report.unchecked, "every pair is ignored");
  EXPECT_EQ(report.ignored, (std::vector<ModelPair>{{0, 1}}));
  EXPECT_EQ(report.min_distance, 0.0);
  EXPECT_TRUE(report.min_distance_is_bound);
  EXPECT_TRUE(report.candidates.empty());
  poses_.X_WB[1].translation().x() = 5.0;  // out of reach: not listed, but the same
  EXPECT_EQ(detector_.detect(poses_, settings).unchecked, "every pair is ignored");
  EXPECT_EQ(detector_.report().verdict, Verdict::UNKNOWN);
  EXPECT_TRUE(detector_.report().ignored.empty());
}

TEST_F(TwoBoxes, WhosePredicateThrowsAreUnknownAndCheckedAgainAfterwards) {
  poses_.X_WB[1].translation().x() = 1.05;
  EXPECT_EQ(detector_.detect(poses_, alarm(0.1)).verdict, Verdict::FREE);
  CheckSettings settings = alarm(0.1);
  settings.may_ignore = [](std::uint32_t, std::uint32_t) -> bool { throw std::logic_error("no"); };
  EXPECT_THROW(detector_.detect(poses_, settings), std::logic_error);
  EXPECT_EQ(detector_.report().verdict, Verdict::UNKNOWN);
  EXPECT_TRUE(detector_.report().in_collision);
  EXPECT_EQ(detector_.detect(poses_, alarm(0.1)).verdict, Verdict::FREE);
}

TEST_F(TwoBoxes, ThatAreAddedByHandAreIgnoredToo) {
  CheckSettings settings = alarm(0.1);
  settings.may_ignore = [](std::uint32_t, std::uint32_t) { return true; };
  detector_.beginNarrowPhase(poses_, settings);
  detector_.addCollisionPair(1, 0);
  EXPECT_TRUE(detector_.endNarrowPhase().pairs.empty());
  EXPECT_EQ(detector_.report().ignored.size(), 1u);
}

TEST_F(TwoBoxes, AreIgnoredInLargeBatchesToo) {
  constexpr std::size_t COUNT = 40000;
  static_assert(COUNT > BatchCheck::STATES_WORTH_A_STAGE, "the batch stage is to be tempted");
  CheckSettings settings = alarm(0.0);
  settings.verdict_only = true;
  settings.may_ignore = [](std::uint32_t, std::uint32_t) { return true; };
  const Restriction nothing{"", {"*no such link*"}};
  for (const bool by_selection : {false, true}) {
    if (by_selection) {
      settings.may_ignore = nullptr;
      settings.selection = std::make_shared<PairSelection>(scene_, nothing);
    }
    std::atomic<std::size_t> nb_unknown{0};
    BatchCheck(scene_, 2).runJoints(
        COUNT, settings,
        [&](std::size_t, std::vector<double>& q) { q = scene_->robot().zeroPositions(); }, {},
        [&](std::size_t, const CollisionReport& r) {
          nb_unknown += r.verdict == Verdict::UNKNOWN;
        });
    EXPECT_EQ(nb_unknown, COUNT);
  }
}

}  // namespace collision_pairs::test_may_ignore
