// One pair at one rung or by finer and finer ones: what is a bound bounds the distance of the two,
// which is measured beside it, and is no worse than a plain bound of the same geometry.
#include <map>

#include <gtest/gtest.h>

#include "element_boxes.h"
#include "mixed_robot.h"
#include "pair_ladder.h"
#include "prepared_shape.h"
#include "scene_element.h"

namespace collision_pairs::test_pair_ladder {

using Eigen::Isometry3d;
using Eigen::Vector3d;
constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double ACCURACY = 2e-9;  // metres; of cylinders, see docs/accuracy.md

class Ladder {
 public:
  explicit Ladder(const SceneDescription& description)
      : scene_(CollisionScene::build(description)) {
    makeSpheres(scene_->elements());
    boxes_.prepare(*scene_);
    poses_.resize(scene_->bodies().size());
  }

  void place(RandomInputs& random, double reach, const Vector3d& offset) {
    throwAbout(random, reach, poses_);
    for (Isometry3d& X_WB : poses_.X_WB) X_WB.pretranslate(offset);
    rebuild();
  }

  /// Translates one element's body in W.
  void move(std::uint32_t element, const Vector3d& p_W) {
    poses_.X_WB[scene_->elements()[element].body].pretranslate(p_W);
    rebuild();
  }

  std::vector<BoxPair> pairs() const {
    std::vector<BoxPair> all;
    const auto& elements = scene_->elements();
    for (std::uint32_t a = 0; a < elements.size(); ++a) {
      for (std::uint32_t b = 0; b < elements.size(); ++b) {
        const std::uint32_t first = elements[a].model, second = elements[b].model;
        if (first < second && scene_->filter().allowed(first, second)) all.push_back({a, b});
      }
    }
    return all;
  }

  PairLadder& ladder() { return ladder_; }
  const SceneElement& element(std::uint32_t i) const { return scene_->elements()[i]; }
  const Aabb& box(std::uint32_t i) const { return boxes_.boxes()[i]; }
  const Isometry3d& pose(std::uint32_t i) { return boxes_.X_WE()[i]; }
  double padding(const BoxPair& pair) const { return scene_->padding(pair.first, pair.second); }

  double truth(const BoxPair& pair, Fidelity rung = Fidelity::MESH) {
    return exact_
               .distance(*element(pair.first).rung(rung).shape,
                         *element(pair.second).rung(rung).shape, between(pair), INF)
               .distance -
           padding(pair);
  }
  /// Of the boxes along the elements' axes.
  double ofBoxes(const BoxPair& pair) {
    const SceneElement &a = element(pair.first), &b = element(pair.second);
    if (std::isinf(a.box_half[0]) || std::isinf(b.box_half[0])) return -INF;
    const auto box_a = prepareShape(Box{2.0 * a.box_half}),
               box_b = prepareShape(Box{2.0 * b.box_half});
    const Isometry3d X =
        Eigen::Translation3d(-a.box_center) * between(pair) * Eigen::Translation3d(b.box_center);
    return exact_.distance(*box_a, *box_b, X, INF).distance - padding(pair);
  }
  /// The largest gap of those boxes along one of their axes.
  double alongAnAxis(const BoxPair& pair) {
    const SceneElement &a = element(pair.first), &b = element(pair.second);
    if (std::isinf(a.box_half[0]) || std::isinf(b.box_half[0])) return -INF;
    const Isometry3d &X_WA = pose(pair.first), &X_WB = pose(pair.second);
    const Vector3d apart = X_WB * b.box_center - X_WA * a.box_center;
    double widest = -INF;
    for (const Isometry3d* X : {&X_WA, &X_WB}) {
      for (int i = 0; i < 3; ++i) {
        const Vector3d axis = X->linear().col(i);
        const double reach = (X_WA.linear().transpose() * axis).cwiseAbs().dot(a.box_half) +
                             (X_WB.linear().transpose() * axis).cwiseAbs().dot(b.box_half);
        widest = std::max(widest, std::abs(apart.dot(axis)) - reach);
      }
    }
    return widest - padding(pair);
  }
  double ofAlignedBoxes(const BoxPair& pair) const {
    const Aabb &a = box(pair.first), &b = box(pair.second);
    const Vector3d gap = (b.min - a.max).cwiseMax(a.min - b.max);
    return gap.maxCoeff() > 0.0 ? gap.cwiseMax(0.0).norm() : gap.maxCoeff();
  }
  Isometry3d between(const BoxPair& pair) { return pose(pair.first).inverse() * pose(pair.second); }
  NarrowPhase& exact() { return exact_; }

 private:
  void rebuild() {
    boxes_.rebuild(poses_, true);
    ladder_.begin(*scene_, boxes_.X_WE(), boxes_.boxes());
  }

  std::shared_ptr<const CollisionScene> scene_;
  ElementBoxes boxes_;
  BodyPoses poses_;
  PairLadder ladder_;
  NarrowPhase exact_;
};

/// A floor and links of every kind, some of them with a coarser geometry.
SceneDescription mixedScene(double padding, int max_hull_vertices) {
  SceneDescription description;
  description.robots.push_back({mixedRobot(), std::nullopt, ""});
  description.settings.padding = padding;
  description.settings.max_hull_vertices = max_hull_vertices;
  description.objects = {floorAt(-0.6, {})};
  return description;
}

template <class Judge>
void forEachPair(const Judge& judge) {
  RandomInputs random;
  for (const double padding : {0.0, 0.03}) {
    for (const int max_hull_vertices : {0, 8}) {
      Ladder ladder(mixedScene(padding, max_hull_vertices));
      for (int round = 0; round < 5; ++round) {
        ladder.place(random, 0.7,
                     round % 4 == 0 ? Vector3d(900.0, -700.0, 50.0) : Vector3d(0, 0, 0));
        for (const BoxPair& pair : ladder.pairs()) {
          SCOPED_TRACE(std::to_string(pair.first) + " and " + std::to_string(pair.second));
          judge(ladder, pair, random);
          if (testing::Test::HasFailure()) return;
        }
      }
    }
  }
}

/// An answer at this search distance, of a pair that is `truth` apart.
void expectTold(const PairDistance& found, double truth, double max_distance) {
  if (truth > max_distance + ACCURACY) {
    ASSERT_EQ(found.certainty, Certainty::BEYOND);
    EXPECT_GT(found.distance, max_distance - 1e-12);
    EXPECT_LE(found.distance, truth + ACCURACY);
  } else if (truth < max_distance - ACCURACY) {
    ASSERT_NE(found.certainty, Certainty::BEYOND);
    if (truth > ACCURACY) {
      EXPECT_NEAR(found.distance, truth, ACCURACY);
    } else if (truth < -ACCURACY) {
      EXPECT_LE(found.distance, 0.0);
    }
  }
}

/// A lower bound that is at least `known`.
void expectBound(const PairLadder::Answer& bound, double truth, double known, double max_distance) {
  EXPECT_LE(bound.found.distance, std::max(truth, 0.0) + ACCURACY);
  EXPECT_GE(bound.found.distance, known);
  EXPECT_EQ(bound.found.certainty,
            bound.found.distance > max_distance ? Certainty::BEYOND : Certainty::UNFINISHED);
}

TEST(PairLadder, ClimbsToTheDistanceOrToAProofThatItIsBeyondTheLimit) {
  int nb_contacts = 0, nb_apart = 0;
  forEachPair([&](Ladder& its, const BoxPair& pair, RandomInputs& random) {
    const double truth = its.truth(pair);
    for (const double max_distance : {0.0, 0.5 * truth, random.uniform(0.0, 1.0), INF}) {
      const double limit = std::max(max_distance, 0.0);
      expectTold(its.ladder().refine(pair, Fidelity::MESH, limit).found, truth, limit);
      expectTold(its.ladder().measure(pair, Fidelity::MESH, limit).found, truth, limit);
    }
    if (std::abs(truth) < ACCURACY) return;
    const PairDistance touches = its.ladder().touches(pair, Fidelity::MESH).found;
    EXPECT_EQ(touches.certainty, truth > 0.0 ? Certainty::BEYOND : Certainty::BOUND);
    if (truth < 0.0) {
      EXPECT_EQ(touches.distance, 0.0);
    }
    ++(truth > 0.0 ? nb_apart : nb_contacts);
  });
  EXPECT_GT(nb_contacts, 20);
  EXPECT_GT(nb_apart, 100);
}

TEST(PairLadder, BoundsOfBoxesAndHullsAreBelowTheDistanceAndNoWorseThanAPlainBound) {
  int nb_hulls = 0;
  forEachPair([&](Ladder& its, const BoxPair& pair, RandomInputs& random) {
    const double truth = its.truth(pair), rounding = 1e-10;
    for (const double max_distance : {0.0, random.uniform(0.0, 0.5), INF}) {
      const double aligned = its.ofAlignedBoxes(pair);
      const auto of_aligned = its.ladder().boundOfAlignedBoxes(pair, max_distance);
      expectBound(of_aligned, truth, aligned - rounding, max_distance);
      EXPECT_LE(of_aligned.found.distance, aligned + rounding);
      EXPECT_EQ(of_aligned.rung, Fidelity::AABB);
      const auto of_boxes = its.ladder().boundOfBoxes(pair, max_distance);
      const bool is_settled = of_boxes.found.certainty == Certainty::BEYOND;
      const double along = its.alongAnAxis(pair),
                   least = along > 0.0 ? std::max(along, aligned) : aligned;
      expectBound(of_boxes, truth, is_settled ? along - rounding : least - rounding, max_distance);
      if (least > max_distance + rounding) {
        EXPECT_TRUE(is_settled);
      }
      if (!its.ladder().needsTriangles(pair, Fidelity::MESH)) continue;
      const auto of_hulls = its.ladder().boundOfHulls(pair, of_boxes, max_distance);
      const double hulls = its.truth(pair, Fidelity::CONVEX);
      if (is_settled) continue;
      expectBound(of_hulls, truth, of_boxes.found.distance, max_distance);
      const bool is_loose = its.element(pair.first).rung(Fidelity::CONVEX).loose ||
                            its.element(pair.second).rung(Fidelity::CONVEX).loose;
      if (is_loose || hulls < ACCURACY) continue;
      EXPECT_GE(of_hulls.found.distance, std::min(hulls, max_distance) - ACCURACY);
      ++nb_hulls;
    }
  });
  EXPECT_GT(nb_hulls, 100);
}

// At a rung that sticks out of the element's boxes, these tell more. The points are then of them.
TEST(PairLadder, NoRungIsWorseThanTheBoxesAndItsPointsAreAsFarApartAsItSays) {
  int nb_of_boxes = 0;
  forEachPair([&](Ladder& its, const BoxPair& pair, RandomInputs&) {
    const double truth = its.truth(pair), boxes = its.ofBoxes(pair);
    for (const Fidelity rung :
         {Fidelity::AABB, Fidelity::SPHERES, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
      SCOPED_TRACE(fidelityName(rung));
      const PairDistance found = its.ladder().measure(pair, rung, INF).found;
      ASSERT_NE(found.certainty, Certainty::BEYOND);
      EXPECT_LE(found.distance, std::max(truth, 0.0) + ACCURACY);
      if (rung != Fidelity::AABB && boxes + its.padding(pair) > 1e-9) {
        EXPECT_GE(found.distance, boxes - ACCURACY);
      }
      EXPECT_GE(found.distance, std::min(its.ofAlignedBoxes(pair), truth) - ACCURACY);
      if (!(found.distance > 1e-6) || rung == Fidelity::SPHERES) continue;
      const Vector3d between = found.p_ACb - found.p_ACa;
      EXPECT_LE((between - found.distance * found.nhat_AB_A).norm(), 1e-6);
      EXPECT_NEAR(found.nhat_AB_A.norm(), 1.0, 1e-9);
      if (rung == Fidelity::AABB || std::abs(found.distance - boxes) > 1e-9) continue;
      const auto isIn = [&](const Vector3d& p_W, std::uint32_t i) {
        const Vector3d p = its.pose(i).inverse() * p_W - its.element(i).box_center;
        const double margin = 0.5 * its.padding(pair) + 1e-9;
        return (p.cwiseAbs().array() <= its.element(i).box_half.array() + margin).all();
      };
      EXPECT_TRUE(isIn(found.p_ACa, pair.first) && isIn(found.p_ACb, pair.second));
      ++nb_of_boxes;
    }
  });
  EXPECT_GT(nb_of_boxes, 50);
}

// Motions are certified by how fast a distance can change, so none may jump while the two are
// apart. That of spheres is within a fifth of their gap (sphere_distance.h), which does not jump.
TEST(PairLadder, NoDistanceChangesByMoreThanTheTwoMove) {
  int nb_steps = 0;
  forEachPair([&](Ladder& its, const BoxPair& pair, RandomInputs& random) {
    if (its.element(pair.second).body < 0) return;  // the floor
    const Vector3d step = 0.004 * (random.rotation() * Vector3d::UnitX());
    std::map<Fidelity, double> before;
    for (int i = 0; i < 20; ++i) {
      for (const Fidelity rung :
           {Fidelity::AABB, Fidelity::SPHERES, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
        const double distance = its.ladder().measure(pair, rung, INF).found.distance;
        const double gap = std::max(distance, 0.0);
        const double change = step.norm() + ACCURACY;
        if (i > 0 && rung == Fidelity::SPHERES) {
          EXPECT_TRUE(gap > 0.0 || before[rung] <= change);
        } else if (i > 0) {
          EXPECT_NEAR(gap, before[rung], change) << fidelityName(rung);
          nb_steps += gap > 0.0 && gap < 0.1;
        }
        before[rung] = gap;
      }
      its.move(pair.second, step);
    }
  });
  EXPECT_GT(nb_steps, 1000);
}

TEST(PairLadder, HullsReachAsFarAsTheirVerticesAndAreApartByNearlyTheirDistance) {
  int nb_apart = 0;
  forEachPair([&](Ladder& its, const BoxPair& pair, RandomInputs& random) {
    const SceneElement& element = its.element(pair.second);
    const auto& mesh = static_cast<const Prepared&>(*element.rung(Fidelity::MESH).shape);
    if (!mesh.mesh) return;
    const Isometry3d X_WE = its.pose(pair.second);
    const auto voxel = prepareShape(Box{random.vector(0.01, 0.3)});
    Isometry3d X_WV = Isometry3d::Identity();
    X_WV.translation() = X_WE.translation() + random.vector(-0.6, 0.6);
    const ConvexCore& core = static_cast<const Prepared&>(*voxel).core;
    const Vector3d n = random.rotation() * Vector3d::UnitX();
    long double furthest = -1e30L;
    for (const Vector3d& v : mesh.mesh->triangles->vertices) {
      const Eigen::Matrix<long double, 3, 3> R = X_WE.linear().cast<long double>();
      const Eigen::Matrix<long double, 3, 1> p =
          R * v.cast<long double>() + X_WE.translation().cast<long double>();
      furthest = std::max(furthest, p.dot(n.cast<long double>()));
    }
    const double reach = its.ladder().reachAlong(n, pair.second, Fidelity::MESH, core);
    EXPECT_GE(reach, furthest);
    EXPECT_LE(reach, furthest + 1e-9L);
    if (element.rung(Fidelity::CONVEX).loose) return;
    const double distance =
        its.exact()
            .distance(*element.rung(Fidelity::CONVEX).shape, *voxel, X_WE.inverse() * X_WV, INF)
            .distance;
    const auto apart = [&](double max_distance) {
      Vector3d nhat = Vector3d::Zero();
      return its.ladder().hullsApart(pair.second, Fidelity::MESH, core, X_WV, max_distance, nhat);
    };
    EXPECT_LE(apart(INF), std::max(distance, 0.0) + 1e-12);
    if (distance < 1e-6) return;
    EXPECT_GE(apart(INF), 0.85 * distance);
    EXPECT_GT(apart(0.999 * distance), 0.999 * distance);
    ++nb_apart;
  });
  EXPECT_GT(nb_apart, 100);
}

}  // namespace collision_pairs::test_pair_ladder
