// Checks that are limited to some of a scene's pairs: by a selection, and by a predicate.
#include <atomic>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/batch_check.h"
#include "random_case.h"
#include "refusal.h"

namespace collision_pairs {
namespace test_pair_selection {

using testing::HasSubstr;
using ModelPair = std::pair<std::uint32_t, std::uint32_t>;
using Among = PairSelection::Among;

constexpr double FAR = 50.0;  // metres

CheckSettings alarm(double distance) {
  CheckSettings settings;
  settings.alarm_distance = distance;
  return settings;
}

/// By the names of links, so that scenes with other bodies get the same.
BodyPoses posesOf(const CollisionScene& scene, const std::map<std::string, Eigen::Isometry3d>& X,
                  const std::set<std::string>& unknown, const CloudVoxels& voxels) {
  BodyPoses poses;
  poses.resize(scene.bodies().size());
  for (std::size_t i = 0; i < scene.bodies().size(); ++i) {
    poses.X_WB[i] = X.at(scene.bodies()[i].link);
    poses.known[i] = unknown.count(scene.bodies()[i].link) == 0;
  }
  if (!scene.clouds().empty()) poses.voxels = voxels;
  return poses;
}

std::map<std::string, Eigen::Isometry3d> randomPoses(RandomInputs& random,
                                                     const CollisionScene& scene) {
  std::vector<Eigen::Isometry3d> X_RB;
  scene.robot().forwardKinematics(randomPositions(random, scene.robot()), X_RB);
  std::map<std::string, Eigen::Isometry3d> X;
  for (std::size_t b = 0; b < X_RB.size(); ++b) {
    X[scene.robot().links()[scene.robot().bodies()[b].link].name] = X_RB[b];
  }
  return X;
}

/// Whether `kept` is the whole report without some pairs, to the last bit.
template <class IsKept>
void expectPairsWhere(const IsKept& is_kept, const CollisionReport& whole,
                      const CollisionReport& kept) {
  std::size_t next = 0;
  Verdict verdict = whole.left_out.empty() ? Verdict::FREE : Verdict::UNKNOWN;
  for (const PairReport& pair : whole.pairs) {
    if (!is_kept(pair.first, pair.second)) continue;
    ASSERT_LT(next, kept.pairs.size());
    const PairReport& found = kept.pairs[next++];
    EXPECT_EQ(ModelPair(found.first, found.second), ModelPair(pair.first, pair.second));
    EXPECT_EQ(found.distance, pair.distance);
    EXPECT_EQ(found.state, pair.state);
    EXPECT_EQ(found.nb_contacts, pair.nb_contacts);
    if (pair.mayTouch() && verdict != Verdict::COLLISION) verdict = Verdict::UNKNOWN;
    if (pair.state == PairState::CONTACT) verdict = Verdict::COLLISION;
  }
  EXPECT_EQ(next, kept.pairs.size());
  EXPECT_EQ(kept.verdict, kept.unchecked.empty() ? verdict : Verdict::UNKNOWN);
}

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

  MayIgnore predicate() {
    return [this](std::uint32_t first, std::uint32_t second) {
      ++asked[{first, second}];
      return left_out.count({first, second}) > 0;
    };
  }
  bool keeps(std::uint32_t first, std::uint32_t second) const {
    return left_out.count({first, second}) == 0;
  }
  std::vector<ModelPair> listed() const {
    std::vector<ModelPair> pairs;
    for (const auto& [pair, times] : asked) {
      if (left_out.count(pair) > 0) pairs.push_back(pair);
    }
    return pairs;
  }
  std::set<ModelPair> askedAbout() const {
    std::set<ModelPair> pairs;
    for (const auto& entry : asked) pairs.insert(entry.first);
    return pairs;
  }
  /// Where no pair in reach is kept, others are asked about until one is, and not listed.
  void expectListed(const CollisionReport& report) const {
    if (asked.size() > listed().size() + 1) {
      EXPECT_EQ(report.ignored, listed());
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
    const BodyPoses poses = posesOf(*scene, randomPoses(random, *scene), {}, its.voxels);
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
      ignoring.expectListed(kept);
      const std::set<ModelPair> in_reach = modelsOf(all.candidates, *scene);
      if (kept.ignored.size() < in_reach.size()) {
        EXPECT_EQ(ignoring.askedAbout(), in_reach);
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
      ignoring.expectListed(only);
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
    ignoring.expectListed(found);
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

/// By name: the report of another scene with the same names must say the same.
struct Named {
  explicit Named(const CollisionDetector& detector) {
    const auto& models = detector.scene().models();
    const CollisionReport& report = detector.report();
    for (const PairReport& pair : report.pairs) {
      pairs[{models[pair.first].name, models[pair.second].name}] = {pair.distance, pair.state};
    }
    for (const std::uint32_t model : report.left_out) left_out.insert(models[model].name);
  }
  std::map<std::pair<std::string, std::string>, std::pair<double, PairState>> pairs;
  std::set<std::string> left_out;
};

TEST(ASelection, IsASceneWithThatRestriction) {
  RandomInputs random;
  int nb_pairs = 0, nb_left_out = 0, nb_empty = 0;
  for (int round = 0; round < 150; ++round) {
    const RandomCase its(random);
    const auto scene = CollisionScene::build(its.description);
    if (scene->models().empty()) continue;
    const auto nameOfOne = [&] {
      return scene->models()[random.integer(0, static_cast<int>(scene->models().size()) - 1)].name;
    };
    Restriction restriction;
    for (int i = random.integer(1, 3); i > 0; --i) restriction.names.push_back(nameOfOne());
    if (random.integer(0, 3) == 0) restriction.names = {"right/*"};
    if (random.integer(0, 9) == 0) restriction.names = {"nothing*"};
    SceneDescription restricted = its.description;
    restricted.restriction = restriction;
    CollisionDetector oracle(CollisionScene::build(restricted)), detector(scene);
    const auto X = randomPoses(random, *scene);
    std::set<std::string> unknown;
    for (const SceneBody& body : scene->bodies()) {
      if (random.integer(0, 9) == 0) unknown.insert(body.link);
    }
    const BodyPoses poses = posesOf(*scene, X, unknown, its.voxels);
    const BodyPoses of_oracle = posesOf(oracle.scene(), X, unknown, its.voxels);
    CheckSettings settings = alarm(random.integer(0, 1) ? 0.1 : 0.0);
    settings.min_distance = random.integer(0, 1);
    settings.verdict_only = random.integer(0, 2) == 0;
    oracle.detect(of_oracle, settings);
    settings.selection = std::make_shared<PairSelection>(scene, restriction);
    detector.detect(poses, settings);
    const Named found(detector), expected(oracle);
    const bool is_first_found = settings.verdict_only && !expected.pairs.empty();
    if (is_first_found) {
      EXPECT_EQ(found.pairs.size(), 1u);  // any that is in contact
    } else {
      EXPECT_EQ(found.pairs, expected.pairs);
    }
    EXPECT_EQ(found.left_out, expected.left_out);
    EXPECT_EQ(detector.report().verdict, oracle.report().verdict);
    EXPECT_EQ(detector.report().min_distance, oracle.report().min_distance);
    EXPECT_EQ(detector.report().min_distance_is_bound, oracle.report().min_distance_is_bound);
    EXPECT_EQ(detector.report().unchecked.empty(), oracle.report().unchecked.empty());
    EXPECT_EQ(settings.selection->empty(), oracle.scene().models().empty());
    nb_pairs += static_cast<int>(found.pairs.size());
    nb_left_out += static_cast<int>(found.left_out.size());
    nb_empty += settings.selection->empty();
  }
  EXPECT_GT(nb_pairs, 50);
  EXPECT_GT(nb_left_out, 10);
  EXPECT_GT(nb_empty, 2);
}

TEST(ASelection, OfSelfOrWorldIsToldByWhatMoves) {
  RandomInputs random;
  int nb_self = 0, nb_world = 0;
  for (int round = 0; round < 100; ++round) {
    const RandomCase its(random);
    const auto scene = CollisionScene::build(its.description);
    const BodyPoses poses = posesOf(*scene, randomPoses(random, *scene), {}, its.voxels);
    const auto bothMove = [&](std::uint32_t a, std::uint32_t b) {
      return scene->models()[a].body >= 0 && scene->models()[b].body >= 0;
    };
    CollisionDetector whole(scene), checked(scene);
    whole.detect(poses, alarm(0.1));
    for (const Among among : {Among::SELF, Among::WORLD}) {
      CheckSettings settings = alarm(0.1);
      settings.selection = std::make_shared<PairSelection>(scene, Restriction{}, among);
      checked.detect(poses, settings);
      const auto isKept = [&](auto a, auto b) { return bothMove(a, b) == (among == Among::SELF); };
      expectPairsWhere(isKept, whole.report(), checked.report());
      const auto nb_pairs = static_cast<int>(checked.report().pairs.size());
      (among == Among::SELF ? nb_self : nb_world) += nb_pairs;
    }
  }
  EXPECT_GT(nb_self, 20);
  EXPECT_GT(nb_world, 20);
}

TEST(ASelection, OfAGroupHasTheLinksThatItMoves) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(3)), Srdf{}, "left"});
  Srdf::Group group;
  group.name = "arm";
  group.links = {"b"};
  description.robots[0].srdf->groups.push_back(group);
  const auto scene = CollisionScene::build(description);
  CheckSettings settings = alarm(0.0);
  settings.selection = std::make_shared<PairSelection>(scene, Restriction{"left/arm", {}});
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(3);
  detector.detect(poses, settings);
  const std::pair<double, PairState> deep{-1.0, PairState::CONTACT};
  EXPECT_EQ(Named(detector).pairs,
            (decltype(Named::pairs){{{"left/a", "left/b"}, deep}, {{"left/b", "left/c"}, deep}}));
}

TEST_F(TwoBoxes, RefuseASelectionThatNamesNothingOrIsOfAnotherScene) {
  const auto select = [&](const Restriction& restriction) {
    return refusal([&] { PairSelection(scene_, restriction); });
  };
  EXPECT_THAT(select({"", {"aa"}}), HasSubstr("'aa', which is not in the scene; did you mean 'a'"));
  EXPECT_EQ(select({"", {scene_->robot().links()[0].name}}), "accepted");  // of no geometry
  EXPECT_EQ(select({"", {scene_->models()[0].name}}), "accepted");
  EXPECT_THAT(select({"arm", {}}), HasSubstr("has no SRDF"));
  const auto other = CollisionScene::build(robotFrom(slidingBoxes(2)), std::nullopt, nullptr);
  CheckSettings settings = alarm(0.0);
  settings.selection = std::make_shared<PairSelection>(other, Restriction{});
  EXPECT_THAT(refusal([&] { detector_.detect(poses_, settings); }), HasSubstr("another scene"));
}

TEST(ASelection, LeavesOutACloudThatIsUnknownOnlyIfItUsesIt) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  description.clouds.push_back(cloudOf("cloud", 0.1, {}));
  const auto scene = CollisionScene::build(description);
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(2);
  poses.X_WB[1].translation().x() = 5.0;
  CheckSettings settings = alarm(0.0);
  EXPECT_EQ(detector.detect(poses, settings).verdict, Verdict::UNKNOWN);
  settings.selection = std::make_shared<PairSelection>(scene, Restriction{}, Among::SELF);
  EXPECT_EQ(detector.detect(poses, settings).verdict, Verdict::FREE);
  settings.selection = std::make_shared<PairSelection>(scene, Restriction{}, Among::WORLD);
  EXPECT_EQ(detector.detect(poses, settings).verdict, Verdict::UNKNOWN);
}

}  // namespace test_pair_selection
}  // namespace collision_pairs
