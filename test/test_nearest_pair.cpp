// The pair with the smallest distance, compared with all pairs measured one by one.
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "random_case.h"

namespace collision_pairs::test_nearest_pair {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double ACCURACY = 2e-9;  // metres; of cylinders, see docs/accuracy.md

/// Measures pairs of solids of a scene at given poses, each by a query of its own.
class OneByOne {
 public:
  OneByOne(const CollisionScene& scene, const BodyPoses& poses) : scene_(scene), poses_(poses) {}

  /// The smallest signed distance of the pairs of models that `is_checked`; infinity if none.
  template <class IsChecked>
  double smallest(const IsChecked& is_checked) {
    const auto end = static_cast<std::uint32_t>(scene_.elements().size());
    double smallest = INF;
    for (std::uint32_t a = 0; a < end; ++a) {
      for (std::uint32_t b = 0; b < end; ++b) {
        const std::uint32_t first = modelOf(a), second = modelOf(b);
        if (first >= second || !scene_.filter().allowed(first, second)) continue;
        if (!hasPose(first) || !hasPose(second) || !is_checked(first, second)) continue;
        forEachPose(a, [&](const Isometry3d& X_WA) {
          forEachPose(b, [&](const Isometry3d& X_WB) {
            smallest = std::min(smallest, distance({a, b}, X_WA, X_WB));
          });
        });
      }
    }
    return smallest;
  }

  double distanceOf(const Contact& contact) {
    return distance(contact.elements, poseIn(contact, contact.elements.first),
                    poseIn(contact, contact.elements.second));
  }

  /// Of a point from one of the two elements of a contact, without padding.
  double fromElement(const Contact& contact, std::uint32_t element, const Vector3d& p_W) {
    constexpr double RADIUS = 1e-6;
    const auto point = prepareShape(Sphere{RADIUS});
    const Isometry3d X_WE = poseIn(contact, element);
    const Isometry3d X_EP = X_WE.inverse() * Eigen::Translation3d(p_W);
    return RADIUS + narrow_phase_.distance(shapeOf(element), *point, X_EP, INF).distance;
  }

 private:
  std::uint32_t modelOf(std::uint32_t element) const { return scene_.elements()[element].model; }
  bool hasPose(std::uint32_t model) const {
    const int body = scene_.models()[model].body;
    return body < 0 || poses_.known[static_cast<std::size_t>(body)];
  }
  const PreparedShape& shapeOf(std::uint32_t element) const {
    return *scene_.elements()[element].rung(Fidelity::MESH).shape;
  }
  Isometry3d poseOf(std::uint32_t element) const {
    const SceneElement& its = scene_.elements()[element];
    return its.body < 0 ? its.X_BE : poses_.X_WB[static_cast<std::size_t>(its.body)] * its.X_BE;
  }
  Isometry3d poseIn(const Contact& contact, std::uint32_t element) const {
    return scene_.cloudOf(element) < 0 ? poseOf(element)
                                       : scene_.poseOfVoxel(element, contact.voxel);
  }
  template <class Take>
  void forEachPose(std::uint32_t element, const Take& take) const {
    const int cloud = scene_.cloudOf(element);
    if (cloud < 0) return take(poseOf(element));
    poses_.voxels[static_cast<std::size_t>(cloud)]->forEach(
        [&](const VoxelCell& cell) { take(scene_.poseOfVoxel(element, cell)); });
  }
  double distance(const BoxPair& pair, const Isometry3d& X_WA, const Isometry3d& X_WB) {
    const Isometry3d X_AB = X_WA.inverse() * X_WB;
    return narrow_phase_.distance(shapeOf(pair.first), shapeOf(pair.second), X_AB, INF).distance -
           scene_.padding(pair.first, pair.second);
  }

  const CollisionScene& scene_;
  const BodyPoses& poses_;
  NarrowPhase narrow_phase_;
};

void expectWitnesses(const Contact& nearest, const CollisionScene& scene, double tolerance,
                     OneByOne& one_by_one) {
  const BoxPair& pair = nearest.elements;
  EXPECT_LT(scene.elements()[pair.first].model, scene.elements()[pair.second].model);
  EXPECT_NEAR(one_by_one.distanceOf(nearest), -nearest.depth, tolerance + ACCURACY);
  const Vector3d between = nearest.p_WSecond - nearest.p_WFirst;
  EXPECT_NEAR(nearest.nhat_W.norm(), 1.0, 1e-12);
  if (nearest.depth > 0.0) {
    EXPECT_NEAR(between.dot(nearest.nhat_W), -nearest.depth, 1e-7);
    return;
  }
  EXPECT_NEAR(between.norm(), -nearest.depth, tolerance + ACCURACY);
  const double padding = scene.padding(pair.first, pair.second);
  EXPECT_LE(one_by_one.fromElement(nearest, pair.first, nearest.p_WFirst), 0.5 * padding + 1e-7);
  EXPECT_LE(one_by_one.fromElement(nearest, pair.second, nearest.p_WSecond), 0.5 * padding + 1e-7);
}

/// Of a cloud, when the time is spent, another voxel may be as deep as it says.
bool isDepthCutShort(const Contact& nearest, const CollisionScene& scene,
                     const CollisionReport& report) {
  const auto isCloud = [&](std::uint32_t element) { return scene.cloudOf(element) >= 0; };
  return nearest.depth > 0.0 && report.budget_spent &&
         (isCloud(nearest.elements.first) || isCloud(nearest.elements.second));
}

void expectSame(const CollisionReport& found, const CollisionReport& again) {
  ASSERT_EQ(found.nearest.has_value(), again.nearest.has_value());
  if (!found.nearest) return;
  EXPECT_EQ(found.nearest->elements, again.nearest->elements);
  EXPECT_EQ(found.nearest->voxel, again.nearest->voxel);
  EXPECT_EQ(found.nearest->p_WFirst, again.nearest->p_WFirst);
  EXPECT_EQ(found.nearest->p_WSecond, again.nearest->p_WSecond);
  EXPECT_EQ(found.nearest->nhat_W, again.nearest->nhat_W);
}

TEST(TheNearestPair, HasTheSmallestDistanceOfAllPairsAndPointsThatAreSoFarApart) {
  RandomInputs random;
  int nb_near = 0, nb_beyond = 0, nb_voxels = 0, nb_hurried = 0, nb_tolerated = 0, nb_empty = 0;
  for (int round = 0; round < 600; ++round) {
    SCOPED_TRACE(round);
    RandomCase its(random);
    its.description.objects.push_back(heap(random));
    const auto scene = CollisionScene::build(its.description);
    BodyPoses poses = randomPosesOf(random, its, *scene);
    for (char& known : poses.known) known = random.integer(0, 9) > 0;
    CollisionDetector detector(scene);
    CheckSettings settings;
    settings.alarm_distance = random.integer(0, 1) ? 0.1 : 0.0;
    settings.min_distance = random.integer(0, 3) > 0;
    if (random.integer(0, 1)) settings.tolerance = 0.03;
    if (random.integer(0, 3) == 0) {
      settings.selection = std::make_shared<PairSelection>(
          scene, Restriction{},
          random.integer(0, 1) ? PairSelection::Among::SELF : PairSelection::Among::WORLD);
    }
    // Few pairs are left in half of the scenes, so that many have no contact.
    const std::uint32_t ninths = random.integer(0, 1) ? 1 : 8;
    const auto isIgnored = [&](std::uint32_t first, std::uint32_t second) {
      return (31 * first + 17 * second) % 9 < ninths;
    };
    settings.may_ignore = isIgnored;
    const bool in_time = random.integer(0, 3) > 0;
    double now = 0.0;
    if (!in_time) {
      settings.time_budget = random.integer(1, 12);
      detector.setClock([&] { return now += 1.0; });
    }
    OneByOne one_by_one(*scene, poses);
    const double smallest = one_by_one.smallest([&](std::uint32_t first, std::uint32_t second) {
      const PairSelection* selection = settings.selection.get();
      return !isIgnored(first, second) &&
             (selection == nullptr || selection->filter().allowed(first, second));
    });
    const CollisionReport report = detector.detect(poses, settings);
    ASSERT_EQ(report.nearest.has_value(), !report.min_distance_is_bound);
    if (report.min_distance_is_bound) {
      EXPECT_LE(report.min_distance, smallest + ACCURACY);
      ++nb_empty;
      continue;
    }
    EXPECT_EQ(report.nearest->depth, -report.min_distance);
    if (in_time) {
      EXPECT_LE(report.min_distance, smallest + ACCURACY);
    }
    if (isDepthCutShort(*report.nearest, *scene, report)) {
      EXPECT_GE(one_by_one.distanceOf(*report.nearest), report.min_distance - ACCURACY);
      continue;
    }
    EXPECT_GE(report.min_distance, smallest - settings.tolerance - ACCURACY);
    expectWitnesses(*report.nearest, *scene, settings.tolerance, one_by_one);
    if (in_time) {
      CollisionDetector other(scene);
      expectSame(report, other.detect(poses, settings));
    }
    if (HasFailure()) return;
    (report.min_distance > settings.alarm_distance ? nb_beyond : nb_near) += 1;
    nb_voxels += scene->cloudOf(report.nearest->elements.first) >= 0 ||
                 scene->cloudOf(report.nearest->elements.second) >= 0;
    nb_hurried += report.budget_spent;
    nb_tolerated += report.min_distance < smallest - ACCURACY;
  }
  EXPECT_GT(nb_near, 50);
  EXPECT_GT(nb_beyond, 50);
  EXPECT_GT(nb_voxels, 5);
  EXPECT_GT(nb_hurried, 0);
  EXPECT_GT(nb_tolerated, 1);
  EXPECT_GT(nb_empty, 20);
}

/// Three boxes, equally far from their neighbours.
class ThreeBoxes : public testing::Test {
 protected:
  ThreeBoxes() {
    poses_.resize(3);
    for (int i = 0; i < 3; ++i)
      poses_.X_WB[static_cast<std::size_t>(i)].translation().x() = 2.0 * i;
    settings_.min_distance = true;
  }
  CollisionDetector detector_{
      CollisionScene::build(robotFrom(slidingBoxes(3)), std::nullopt, nullptr)};
  BodyPoses poses_;
  CheckSettings settings_;
};

TEST_F(ThreeBoxes, OfPairsEquallyNearTheFirstIsNamed) {
  settings_.alarm_distance = 1.5;
  for (const double time_budget : {0.0, 1e6}) {
    settings_.time_budget = time_budget;
    const CollisionReport& report = detector_.detect(poses_, settings_);
    ASSERT_TRUE(report.nearest);
    EXPECT_EQ(report.min_distance, 1.0);
    EXPECT_EQ(report.nearest->elements, (BoxPair{0, 1}));
  }
  poses_.X_WB[2].translation().x() = 3.5;  // the next check has its own
  EXPECT_EQ(detector_.detect(poses_, settings_).nearest->elements, (BoxPair{1, 2}));
}

TEST_F(ThreeBoxes, AVerdictHasNone) {
  settings_.verdict_only = true;
  EXPECT_FALSE(detector_.detect(poses_, settings_).nearest);
  poses_.X_WB[2].translation().x() = 2.5;
  EXPECT_FALSE(detector_.detect(poses_, settings_).nearest);
}

// Clouds come last: what is spent before leaves the boxes' distance, and nothing of the cloud.
TEST(TheNearestPair, OfACloudThatWasNotReachedInTimeIsNeitherNamedNorPassedOver) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  description.clouds.push_back(cloudOf("cloud", 0.5, {}));
  const auto scene = CollisionScene::build(description);
  CollisionDetector detector(scene);
  double now = 0.0;
  detector.setClock([&] { return now += 1.0; });
  BodyPoses poses;
  poses.resize(2);
  poses.X_WB[1].translation().x() = 6.0;
  poses.voxels = {std::make_shared<const OccupiedVoxels>(0.5, std::vector<VoxelCell>{{-4, 0, 0}})};
  CheckSettings settings;
  settings.alarm_distance = 0.1;
  settings.min_distance = true;
  int nb_spent = 0;
  for (double budget = 1.0; budget < 30.0; budget += 1.0) {
    settings.time_budget = budget;
    const CollisionReport& report = detector.detect(poses, settings);
    EXPECT_EQ(report.min_distance_is_bound, report.budget_spent) << budget;
    EXPECT_LE(report.min_distance, 1.0 + ACCURACY) << budget;
    nb_spent += report.budget_spent;
    if (report.budget_spent) continue;
    EXPECT_NEAR(report.min_distance, 1.0, ACCURACY);
    EXPECT_EQ(report.nearest->voxel, VoxelCell(-4, 0, 0));
  }
  EXPECT_GT(nb_spent, 1);
  EXPECT_LT(nb_spent, 29);
}

}  // namespace collision_pairs::test_nearest_pair
