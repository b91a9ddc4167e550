// One question about two shapes has one answer: yes or no, distances up to any limit, with any
// tolerance and padding, by the native narrow phase or FCL, and with the two exchanged. All poses
// are a hair from contact, where rounding would decide differently.
#include <cstdlib>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "every_shape.h"
#include "mixed_robot.h"

namespace collision_pairs::test_one_contact {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double EPSILON = std::numeric_limits<double>::epsilon();
constexpr double FAR = 100.0;  // metres, of a mesh from its origin
// Of the size: what two answers may differ by (docs/accuracy.md). Nearer to contact than this, the
// order of the two may decide.
constexpr double OF_CYLINDERS = 2e-9, OF_OTHERS = 1e-12, OF_FCL = 1e-7;

bool isLong() { return std::getenv("COLLISION_PAIRS_LONG") != nullptr; }

/// Moved, stretched and mirrored: not as in EVERY_KIND.
Shape otherMesh(RandomInputs& random, const std::string& kind) {
  TriangleMesh mesh = random.integer(0, 1) ? LShape().mesh() : bumpyBall(9, 0.15);
  if (kind == "stored") {
    mesh = storedPrism(random.integer(5, 24), 0.1, 0.1, random.rotation().toRotationMatrix());
  }
  const Vector3d scale = kind == "mirrored" ? Vector3d(-1.0, 1.0, 1.0)
                         : kind == "scaled" ? random.vector(0.2, 2.0)
                                            : Vector3d::Ones();
  for (Vector3d& v : mesh.vertices) {
    v = scale.cwiseProduct(v);
    if (kind == "far") v += Vector3d(FAR, -FAR, 0.5 * FAR);
  }
  return meshShape(mesh);
}

struct Body {
  Body(RandomInputs& random, const std::string& kind)
      : shape(kind == "sheet" || std::count(EVERY_KIND.begin(), EVERY_KIND.end(), kind)
                  ? shapeOfKind(random, kind, random.uniform(0.1, 0.4))
                  : otherMesh(random, kind)),
        center(kind == "far" ? Vector3d(FAR, -FAR, 0.5 * FAR) : Vector3d::Zero()),
        native(prepareShape(shape)),
        fcl(prepareShape(shape, NarrowPhaseMethod::FCL)) {}
  const std::shared_ptr<const PreparedShape>& by(NarrowPhaseMethod method) const {
    return method == NarrowPhaseMethod::FCL ? fcl : native;
  }

  Shape shape;
  Vector3d center;
  std::shared_ptr<const PreparedShape> native, fcl;
};

class OneContactBy : public testing::TestWithParam<NarrowPhaseMethod> {
 protected:
  /// A and B at random, and B moved along a line until its next double decides on contact.
  void meet() {
    const std::string kinds[] = {"box", "sphere", "cylinder", "capsule", "convex", "hull",  "ball",
                                 "l",   "sheet",  "mirrored", "scaled",  "far",    "stored"};
    const std::string a = kinds[random.integer(0, 12)], b = kinds[random.integer(0, 12)];
    A = std::make_unique<Body>(random, a);
    B = std::make_unique<Body>(random, b);
    trace = a + ", " + b;
    const bool has_cylinder = a == "cylinder" || b == "cylinder";
    const double coordinates = a == "far" || b == "far" ? 3.0 * FAR : 1.0;
    accuracy = has_cylinder ? OF_CYLINDERS : OF_OTHERS * coordinates;
    if (GetParam() == NarrowPhaseMethod::FCL) accuracy = OF_FCL * coordinates;
    direction = random.rotation() * Vector3d::UnitX();
    R = random.rotation().toRotationMatrix();
    double inside = 0.0, outside = 2.0;
    while (outside - inside > 2.0 * EPSILON) {
      const double middle = 0.5 * (inside + outside);
      (touches(at(middle)) ? inside : outside) = middle;
    }
    contact_at = inside;
  }

  Isometry3d at(double along) const {
    Isometry3d X_AB = Isometry3d::Identity();
    X_AB.linear() = R;
    X_AB.translation() = A->center + along * direction - R * B->center;
    return X_AB;
  }

  bool touches(const Isometry3d& X_AB, double margin = 0.0) {
    return narrow_phase.touches(*A->by(GetParam()), *B->by(GetParam()), X_AB, margin);
  }
  PairDistance distance(const Isometry3d& X_AB, double limit, const Accuracy& how = {}) {
    ++nb_questions;
    return narrow_phase.distance(*A->by(GetParam()), *B->by(GetParam()), X_AB, limit, how);
  }

  /// All answers about whether the two are within `margin`, and how far apart.
  void expectOneAnswer(const Isometry3d& X_AB, double margin) {
    const bool is_contact = touches(X_AB, margin);
    const PairDistance truth = distance(X_AB, INF, {0.0, margin});
    ASSERT_NE(truth.certainty, Certainty::BEYOND);
    ASSERT_EQ(truth.distance <= margin, is_contact) << truth.distance - margin;
    for (const double tolerance : {0.0, 1e-9, 1e-3}) {
      for (const double beyond_margin : {0.0, 1e-12, 1e-9, 1e-6, 1e-3, INF}) {
        const double limit = margin + beyond_margin;
        const PairDistance found = distance(X_AB, limit, {tolerance, margin});
        SCOPED_TRACE("limit " + std::to_string(beyond_margin) + ", tolerance " +
                     std::to_string(tolerance));
        ASSERT_EQ(found.certainty == Certainty::BEYOND, found.distance > limit);
        ASSERT_EQ(found.distance <= margin, is_contact) << found.distance - margin;
        if (truth.distance <= limit - accuracy) {
          ASSERT_NE(found.certainty, Certainty::BEYOND);
        }
        ASSERT_LE(found.distance, std::max(truth.distance, limit) + accuracy);
        if (found.certainty == Certainty::BEYOND || is_contact) continue;
        ASSERT_NEAR(found.distance, truth.distance, accuracy + tolerance);
        if (found.certainty == Certainty::DEGRADED) {
          ASSERT_LE(found.distance, accuracy);
          continue;
        }
        ASSERT_NEAR((found.p_ACb - found.p_ACa).norm(), truth.distance, accuracy + tolerance);
      }
    }
  }

  void expectSameExchanged(const Isometry3d& X_AB) {
    const PairDistance truth = distance(X_AB, INF);
    std::swap(A, B);
    const PairDistance exchanged = distance(X_AB.inverse(), INF);
    const bool is_contact = touches(X_AB.inverse());
    std::swap(A, B);
    ASSERT_EQ(is_contact, exchanged.touches());
    if (is_contact != truth.touches()) {
      ASSERT_LE(std::max(exchanged.distance, truth.distance), accuracy);
    } else if (!is_contact) {
      ASSERT_NEAR(exchanged.distance, truth.distance, accuracy);
    }
  }

  RandomInputs random;
  NarrowPhase narrow_phase;
  std::unique_ptr<Body> A, B;
  std::string trace;
  Eigen::Matrix3d R;
  Vector3d direction;
  double contact_at = 0.0, accuracy = 0.0;
  std::uint64_t nb_questions = 0, nb_apart = 0;
};

TEST_P(OneContactBy, EveryQuestionIsTheSame) {
  const bool by_fcl = GetParam() == NarrowPhaseMethod::FCL;  // which takes ten times as long
  const int nb_pairs = (by_fcl ? 50 : 400) * (isLong() ? 20 : 1);
  for (int i = 0; i < nb_pairs; ++i) {
    meet();
    SCOPED_TRACE("pair " + std::to_string(i) + ": " + trace);
    for (int k = 0; k < 12; ++k) {
      const double hair = std::pow(10.0, random.uniform(-16.0, -3.0));
      const Isometry3d X_AB = at(contact_at + (k % 4 == 0 ? -hair : hair));
      const double found = distance(X_AB, INF).distance;
      nb_apart += found > 0.0;
      expectOneAnswer(X_AB, 0.0);
      expectSameExchanged(X_AB);
      if (found > 0.0) expectOneAnswer(X_AB, found * (1.0 + random.integer(-4, 4) * EPSILON));
      expectOneAnswer(X_AB, std::max(found, 0.0) + 1e-3);
      if (HasFatalFailure()) FAIL() << "a hair of " << hair << " m";
    }
  }
  EXPECT_GT(nb_apart, static_cast<std::uint64_t>(nb_pairs) * 6);
  std::cout << nb_questions << " questions\n";
}

/// Two links of a scene, whose boxes touch where they do: parallel to the axes.
class BesideEachOther {
 public:
  BesideEachOther(RandomInputs& random, const SceneSettings& settings)
      : scene_(CollisionScene::build(mixedRobot(), std::nullopt, nullptr, settings)),
        detector_(scene_),
        nb_bodies_(static_cast<int>(scene_->bodies().size())),
        random_(random) {
    poses_.resize(scene_->bodies().size());
  }

  /// The two positions next to each other between which the verdict changes.
  std::pair<double, double> place() {
    for (std::size_t i = 0; i < poses_.X_WB.size(); ++i) {
      poses_.X_WB[i] = Eigen::Translation3d(0.0, 0.0, 10.0 * (1.0 + i)) * Isometry3d::Identity();
    }
    still_ = static_cast<std::size_t>(random_.integer(0, nb_bodies_ - 1));
    moved_ = (still_ + static_cast<std::size_t>(random_.integer(1, nb_bodies_ - 1))) %
             poses_.X_WB.size();
    poses_.X_WB[still_] = random_.integer(0, 1) ? quarterTurns() : Isometry3d::Identity();
    poses_.X_WB[moved_] = quarterTurns();
    direction_ = Vector3d::Unit(random_.integer(0, 2));
    double inside = 0.0, outside = 3.0;
    while (std::nextafter(inside, outside) < outside) {
      const double middle = 0.5 * (inside + outside);
      (verdictAt(middle, verdictOnly()) == Verdict::FREE ? outside : inside) = middle;
      if (outside < 1e-9) break;
    }
    return {inside, outside};
  }

  std::string names() const {
    return scene_->bodies()[still_].link + ", " + scene_->bodies()[moved_].link;
  }

  static CheckSettings verdictOnly() {
    CheckSettings settings;
    settings.verdict_only = true;
    return settings;
  }

  Verdict verdictAt(double along, const CheckSettings& settings) {
    poses_.X_WB[moved_].translation() = along * direction_;
    const CollisionReport& report = detector_.detect(poses_, settings);
    EXPECT_EQ(settings.min_distance && report.min_distance > 0.0,
              settings.min_distance && report.verdict == Verdict::FREE);
    return report.verdict;
  }

 private:
  Isometry3d quarterTurns() {
    Isometry3d X = Isometry3d::Identity();
    for (int axis = 0; axis < 3; ++axis) {
      const double angle = 0.5 * M_PI * random_.integer(0, 3);
      X.rotate(Eigen::AngleAxisd(angle, Vector3d::Unit(axis)));
    }
    return X;
  }

  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  const int nb_bodies_;
  RandomInputs& random_;
  BodyPoses poses_;
  std::size_t still_ = 0, moved_ = 0;
  Vector3d direction_;
};

TEST(OneContact, OfBoxesThatAreApartByADigitIsTheSameForVerdictAndReport) {
  RandomInputs random;
  for (const double padding : {0.0, 0.02}) {
    for (const auto method : {NarrowPhaseMethod::NATIVE, NarrowPhaseMethod::FCL}) {
      SceneSettings of_scene;
      of_scene.padding = padding;
      of_scene.narrow_phase = method;
      BesideEachOther links(random, of_scene);
      for (int i = 0; i < 300; ++i) {
        const auto [inside, outside] = links.place();
        for (const double along : {inside, outside, outside + 2.0 * EPSILON, outside + 1e-12}) {
          const Verdict verdict = links.verdictAt(along, BesideEachOther::verdictOnly());
          for (const double alarm_distance : {0.0, 1e-3, 0.05}) {
            CheckSettings report;
            report.alarm_distance = alarm_distance;
            report.min_distance = true;
            ASSERT_EQ(links.verdictAt(along, report), verdict)
                << links.names() << " at " << along - inside << ' ' << alarm_distance << ' '
                << padding;
            report.tolerance = 1e-3;
            ASSERT_EQ(links.verdictAt(along, report), verdict)
                << links.names() << " at " << along - inside << ' ' << alarm_distance << ' '
                << padding;
            report.time_budget = 1e6;
            ASSERT_EQ(links.verdictAt(along, report), verdict)
                << links.names() << " at " << along - inside << ' ' << alarm_distance << ' '
                << padding;
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Native, OneContactBy, testing::Values(NarrowPhaseMethod::NATIVE));
INSTANTIATE_TEST_SUITE_P(Fcl, OneContactBy, testing::Values(NarrowPhaseMethod::FCL));

}  // namespace collision_pairs::test_one_contact
