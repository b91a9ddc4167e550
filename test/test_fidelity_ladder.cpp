// Each rung encloses the next: contacts are kept, distances are lower bounds.
#include <map>

#include <gtest/gtest.h>

#include "benchmark/benchmark_robots.h"
#include "collision_pairs/collision_detector.h"
#include "mixed_robot.h"

namespace collision_pairs::test_fidelity_ladder {

using Distances = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

/// What docs/accuracy.md grants a distance and a depth of shapes with cylinders among them.
constexpr double DISTANCE_ACCURACY = 1e-10, DEPTH_ACCURACY = 1e-7;

/// Checks one scene, whose hulls may be simplified, at every rung.
class Ladder {
 public:
  explicit Ladder(std::shared_ptr<const CollisionScene> scene) : detector_(std::move(scene)) {}

  Distances distances(const BodyPoses& poses, Fidelity fidelity, double alarm_distance) {
    CheckSettings settings;
    settings.fidelity = fidelity;
    settings.alarm_distance = alarm_distance;
    Distances found;
    for (const PairReport& pair : detector_.detect(poses, settings).pairs) {
      found[{pair.first, pair.second}] = pair.distance;
    }
    return found;
  }

  /// From `dearer`, the meshes' answer, down; returns the number of pairs that were compared.
  std::size_t expectNested(const BodyPoses& poses, double alarm_distance) {
    const Distances exact = distances(poses, Fidelity::MESH, alarm_distance);
    Distances dearer = exact;
    const std::size_t count = dearer.size();
    for (const Fidelity rung : {Fidelity::CONVEX, Fidelity::OBB, Fidelity::AABB}) {
      const Distances cheaper = distances(poses, rung, alarm_distance);
      expectEncloses(cheaper, dearer, fidelityName(rung));
      dearer = cheaper;
    }
    const Distances spheres = distances(poses, Fidelity::SPHERES, alarm_distance);
    expectEncloses(spheres, exact, "spheres");
    expectEncloses(dearer, spheres, "aabb");
    return count;
  }

  /// Verdicts do not measure: they ask another way. Returns whether there is contact at the rung.
  bool expectSameVerdict(const BodyPoses& poses, Fidelity fidelity) {
    CheckSettings settings;
    settings.fidelity = fidelity;
    settings.verdict_only = true;
    const Distances contacts = distances(poses, fidelity, 0.0);
    const bool in_contact = !contacts.empty();
    for (const auto& [pair, distance] : distances(poses, fidelity, 0.5)) {
      EXPECT_EQ(distance <= 0.0, contacts.count(pair) > 0) << fidelityName(fidelity);
    }
    EXPECT_EQ(detector_.detect(poses, settings).in_collision, in_contact) << fidelityName(fidelity);
    return in_contact;
  }

  void expectEncloses(const Distances& cheaper, const Distances& dearer, const char* rung) {
    for (const auto& [pair, distance] : dearer) {
      const auto found = cheaper.find(pair);
      const std::string names = detector_.scene().models()[pair.first].name + "|" +
                                detector_.scene().models()[pair.second].name;
      ASSERT_TRUE(found != cheaper.end()) << names << " at " << rung;
      if (distance <= 0.0) {
        EXPECT_LE(found->second, 0.0) << names << " at " << rung;
      }
      EXPECT_LE(found->second, distance + (distance > 0.0 ? DISTANCE_ACCURACY : DEPTH_ACCURACY))
          << names << " at " << rung;
    }
  }

 private:
  CollisionDetector detector_;
};

std::shared_ptr<const CollisionScene> sceneWithHulls(int max_hull_vertices, double padding = 0.0) {
  SceneSettings settings;
  settings.max_hull_vertices = max_hull_vertices;
  settings.padding = padding;
  if (padding > 0.0) settings.pair_padding = {{"a", "*", 0.01}, {"d", "*", 0.1}};
  return CollisionScene::build(mixedRobot(2), std::nullopt, nullptr, settings);
}

/// Of the most vertices of a hull, and a padding.
class NestingOfRandomPairs : public testing::TestWithParam<std::pair<int, double>> {};

TEST_P(NestingOfRandomPairs, KeepsContactsAndBoundsDistances) {
  RandomInputs random;
  const auto [max_hull_vertices, padding] = GetParam();
  const auto scene = sceneWithHulls(max_hull_vertices, padding);
  Ladder ladder(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  std::size_t compared = 0;
  while (compared < 100000) {
    throwAbout(random, random.uniform(0.2, 1.5), poses);
    compared += ladder.expectNested(poses, 10.0);
    ladder.expectNested(poses, 0.0);
    if (testing::Test::HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(ExactHulls, NestingOfRandomPairs, testing::Values(std::pair{0, 0.0}));
INSTANTIATE_TEST_SUITE_P(SimplifiedHulls, NestingOfRandomPairs,
                         testing::Values(std::pair{8, 0.0}, std::pair{24, 0.0}));
INSTANTIATE_TEST_SUITE_P(Padded, NestingOfRandomPairs, testing::Values(std::pair{0, 0.03}));

TEST(FidelityLadder, AVerdictIsThatOfTheContactsAtEveryRung) {
  RandomInputs random;
  for (const int max_hull_vertices : {0, 8}) {
    const auto scene = sceneWithHulls(max_hull_vertices);
    Ladder ladder(scene);
    BodyPoses poses;
    poses.resize(scene->bodies().size());
    int nb_contacts = 0;
    constexpr int ROUNDS = 4000;
    for (int round = 0; round < ROUNDS; ++round) {
      throwAbout(random, random.uniform(0.5, 2.0), poses);
      for (const Fidelity rung :
           {Fidelity::AABB, Fidelity::SPHERES, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
        nb_contacts += ladder.expectSameVerdict(poses, rung);
      }
      if (testing::Test::HasFailure()) return;
    }
    EXPECT_GT(nb_contacts, ROUNDS);
    EXPECT_LT(nb_contacts, 4 * ROUNDS);
  }
}

// What is prepared of a mesh depends on the finest geometry of its pairs, and a check may ask for
// any.
TEST(FidelityLadder, EveryCombinationOfFidelitiesIsAnsweredAndMissesNoContact) {
  const Fidelity all[] = {Fidelity::AABB, Fidelity::SPHERES, Fidelity::OBB, Fidelity::CONVEX,
                          Fidelity::MESH};
  const std::string other[] = {"<mesh filename='l'/>", "<sphere radius='0.1'/>"};
  SceneCache cache;  // of what is prepared for each fidelity; the spheres are made once
  for (int i = 0; i < 5 * 5 * 5 * 2; ++i) {
    const auto robot = RobotModel::fromUrdf(
        "<robot name='r'>" + emptyLink("root") + linkWith("a", "<mesh filename='l'/>") +
            linkWith("b", other[i % 2]) + joint("to_a", "floating", "root", "a", "0 0 0", "") +
            joint("to_b", "floating", "root", "b", "0 0 0", "") + "</robot>",
        testMesh);
    SceneDescription description;
    description.robots.push_back({robot, std::nullopt, ""});
    description.settings.link_fidelity["a"] = all[i / 2 % 5];
    description.settings.link_fidelity["b"] = all[i / 10 % 5];
    description.settings.fidelity = all[i / 50];
    CollisionDetector detector(CollisionScene::build(description, &cache));
    BodyPoses poses;
    poses.resize(2);
    for (const double y : {0.0, 0.02, 3.0}) {
      poses.X_WB[0].translation().y() = y;
      for (const Fidelity asked : all) {
        for (const bool verdict_only : {false, true}) {
          CheckSettings settings;
          settings.fidelity = asked;
          settings.verdict_only = verdict_only;
          settings.alarm_distance = verdict_only ? 0.0 : 5.0;
          ASSERT_EQ(detector.detect(poses, settings).verdict,
                    y < 1.0 ? Verdict::COLLISION : Verdict::FREE)
              << i << ' ' << fidelityName(asked);
        }
      }
    }
  }
}

TEST(FidelityLadder, IsNestedAMillionMetresFromTheOrigin) {
  RandomInputs random;
  const auto scene = sceneWithHulls(0);
  Ladder ladder(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  const Eigen::Vector3d far(1e6, -1e6, 1e6);
  for (int round = 0; round < 200; ++round) {
    throwAbout(random, 0.8, poses);
    for (Eigen::Isometry3d& X_WB : poses.X_WB) X_WB.pretranslate(far);
    ladder.expectNested(poses, 10.0);
    ladder.expectNested(poses, 0.0);
  }
}

TEST(FidelityLadder, SimplifiedHullsEncloseTheExactOnes) {
  RandomInputs random;
  const auto exact = sceneWithHulls(0), simplified = sceneWithHulls(12);
  Ladder exact_ladder(exact), simplified_ladder(simplified);
  BodyPoses poses;
  poses.resize(exact->bodies().size());
  for (int round = 0; round < 100; ++round) {
    throwAbout(random, 0.8, poses);
    exact_ladder.expectEncloses(simplified_ladder.distances(poses, Fidelity::CONVEX, 10.0),
                                exact_ladder.distances(poses, Fidelity::CONVEX, 10.0), "convex");
  }
}

TEST(FidelityLadder, IsNestedInAllReferenceStates) {
  if (benchmarkRobots().empty()) GTEST_SKIP() << "COLLISION_PAIRS_SHARED names no data";
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    SceneDescription description;
    description.robots.push_back({robot.robot, robot.srdf, ""});
    description.world = robot.world;
    SceneCache cache;  // so that spheres are made once
    for (const int max_hull_vertices : {0, 32}) {
      description.settings.max_hull_vertices = max_hull_vertices;
      const auto scene = CollisionScene::build(description, &cache);
      Ladder ladder(scene);
      BodyPoses poses;
      for (std::size_t i = 0; i < robot.states.size(); i += EVERY_NTH_STATE) {
        scene->gatherPoses(robot.states[i], poses);
        ladder.expectNested(poses, 0.05);
        ladder.expectNested(poses, 0.0);
      }
    }
  }
}

}  // namespace collision_pairs::test_fidelity_ladder
