// Checks that are limited to a selection of a scene's pairs.
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pairs_kept.h"
#include "random_case.h"
#include "refusal.h"

namespace collision_pairs::test_pair_selection {

using testing::HasSubstr;
using Among = PairSelection::Among;

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
    const BodyPoses poses = randomPosesOf(random, its, *scene);
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

TEST(ASelection, ThatNamesNothingOrIsOfAnotherSceneIsRefused) {
  const auto scene = CollisionScene::build(robotFrom(slidingBoxes(2)), std::nullopt, nullptr);
  const auto select = [&](const Restriction& restriction) {
    return refusal([&] { PairSelection(scene, restriction); });
  };
  EXPECT_THAT(select({"", {"aa"}}), HasSubstr("'aa', which is not in the scene; did you mean 'a'"));
  EXPECT_EQ(select({"", {scene->robot().links()[0].name}}), "accepted");  // of no geometry
  EXPECT_EQ(select({"", {scene->models()[0].name}}), "accepted");
  EXPECT_THAT(select({"arm", {}}), HasSubstr("has no SRDF"));
  const auto other = CollisionScene::build(robotFrom(slidingBoxes(2)), std::nullopt, nullptr);
  CheckSettings settings = alarm(0.0);
  settings.selection = std::make_shared<PairSelection>(other, Restriction{});
  BodyPoses poses;
  poses.resize(2);
  EXPECT_THAT(refusal([&] { CollisionDetector(scene).detect(poses, settings); }),
              HasSubstr("another scene"));
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

}  // namespace collision_pairs::test_pair_selection
