#include "batch_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "in_parallel.h"
#include "pair_table.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Errors of the float kinematics, with u = UNIT. For each body, E bounds the error of a unit vector
// turned by the computed rotation (the spectral norm of the rotation's error), e the error of its
// origin, in metres, and P the distance of that origin from W's, for all positions. Matrix norms
// are Frobenius norms where entries are rounded, sqrt(3) for a rotation. A joint adds to E: u
// sqrt(3) for the rounded entries of its constant rotation; 9 u for a product of two rotations,
// each entry a sum of three products (3 u sqrt(3) sqrt(3)); and if it turns, 4 sqrt(2) u for a sine
// and a cosine with an error of at most 4 u each (their difference is a scaled rotation) and 4 u
// for turning two columns by them (2 u sqrt(2) sqrt(2)). B's z axis is the joint's, so turning
// mixes two columns only. A vector of length f is stored (u f), turned (E f) and added to an origin
// within P: four terms each, so e grows by E f + u f + 4 u (sqrt(3) f + P), with E and P of the
// parent. A prismatic joint that moves by at most Q adds (E + 3 u) Q + 2 u (P + Q). A sphere's
// centre at distance c from its body's origin has an error of e + E c + u c + 4 u (sqrt(3) c + P).
// Sine and cosine: reducing an angle of at most 10,000 in double has an error below 2e-12, rounding
// it to float u pi/4; the polynomials are within 0.5 u on -pi/4 ... pi/4, their later terms at most
// 0.31, so rounding adds less than 2 u.
// Distances: differences of centres (u each), squares and sums give a squared distance with a
// relative error of at most 6 u, the square of the sum of radii and padding one of at most 5 u.
// Outer radii and paddings are enlarged by 16 u, inner ones reduced by it: 32 u of their squares.
constexpr double UNIT = 1.0 / (1 << 24);     // relative error of rounding to float
constexpr double STORED = 1.75 * UNIT;       // a rotation's entries, rounded
constexpr double PRODUCT = 9.0 * UNIT;       // of two rotations
constexpr double TURN = (5.7 + 4.0) * UNIT;  // by a sine and a cosine with errors of 4 UNIT each
constexpr double SECOND_ORDER = 1.001;
constexpr double OF_DISTANCE = 16.0 * UNIT;  // of distances and radii, relative
constexpr double EXACT_MARGIN = 1e-9;     // m, and relative to sizes: rounding of the exact check
constexpr double MOST_REACH = 1e3;        // m
constexpr double MOST_SLIDE = 10.0;       // m, of a joint without limits
constexpr std::size_t MOST_SPHERES = 63;  // of an element

float roundedUp(double x) {
  const auto rounded = static_cast<float>(x);
  return rounded < x ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded;
}

float roundedDown(double x) { return -roundedUp(-x); }

/// A rotation whose z axis is the joint's axis.
Matrix3d alongJoint(const RobotModel& robot, const Body& body) {
  if (body.joint < 0 || !robot.joints()[body.joint].hasPosition()) return Matrix3d::Identity();
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), robot.joints()[body.joint].axis)
      .toRotationMatrix();
}

class ModelMaker {
 public:
  ModelMaker(const CollisionScene& scene, bool with_tables, BatchModel& model)
      : scene_(scene),
        robot_(scene.robot()),
        with_tables_(with_tables),
        model_(model),
        body_of_(robot_.bodies().size(), -1) {}

  void make() {
    const auto& elements = scene_.elements();
    std::vector<SphereCover> covers(elements.size());
    inParallel(nbThreads(0, covers.size()), covers.size(), [&](std::size_t, std::size_t i) {
      const bool is_box = std::holds_alternative<Box>(elements[i].shape);
      if (i < scene_.nbStaticElements() && is_box) return;
      covers[i] = coverBySpheres(preparedOf(elements[i]), MOST_SPHERES);
    });
    for (std::uint32_t i = scene_.nbStaticElements(); i < elements.size(); ++i) {
      addTree(i, covers[i]);
    }
    model_.covers = std::move(covers);
    addPairs();
  }

 private:
  /// Adds the body and its ancestors; returns its index.
  int addBody(int id) {
    if (body_of_[id] >= 0) return body_of_[id];
    const Body& body = robot_.bodies()[id];
    BatchBody made{-1, -1, BatchBody::STANDS, {}, {}};
    PoseError error, above;
    Matrix3d R_CP = Matrix3d::Identity();  // from the parent body's frame to its frame of the stage
    if (body.parent >= 0) {
      made.parent = addBody(body.parent);
      above = model_.errors[static_cast<std::size_t>(made.parent)];
      R_CP = alongJoint(robot_, robot_.bodies()[body.parent]).transpose();
      error.rotation = above.rotation + PRODUCT;
    }
    const Matrix3d R = R_CP * body.X_PJ.linear() * alongJoint(robot_, body);
    const Vector3d p = R_CP * body.X_PJ.translation();
    for (int i = 0; i < 9; ++i) made.R[i] = static_cast<float>(R(i / 3, i % 3));
    for (int i = 0; i < 3; ++i) made.p[i] = static_cast<float>(p[i]);
    error.rotation += STORED;
    error.reach = above.reach + p.norm();
    error.position = above.position + above.rotation * p.norm() + ofSum(p.norm(), above.reach);
    if (body.joint >= 0 && robot_.joints()[body.joint].hasPosition()) {
      addJoint(body.joint, made, error);
    }
    error.rotation *= SECOND_ORDER;
    error.position *= SECOND_ORDER;
    body_of_[id] = static_cast<int>(model_.bodies.size());
    model_.bodies.push_back(made);
    model_.errors.push_back(error);
    model_.robot_body.push_back(id);
    return body_of_[id];
  }

  void addJoint(int id, BatchBody& body, PoseError& error) {
    const Joint& joint = robot_.joints()[id];
    body.column = static_cast<int>(model_.columns.size());
    if (joint.type != JointType::PRISMATIC) {
      body.kind = BatchBody::TURNS;
      error.rotation += TURN;
      model_.columns.push_back({id, MOST_TURNS});
      return;
    }
    body.kind = BatchBody::SLIDES;
    const double limit = std::max(std::abs(joint.lower), std::abs(joint.upper));
    const double most = limit > 0.0 ? std::min(1.5 * limit, MOST_SLIDE) : MOST_SLIDE;
    error.position += (error.rotation + 3.0 * UNIT) * most + 2.0 * UNIT * (error.reach + most);
    error.reach += most;
    model_.columns.push_back({id, most});
  }

  /// Error of a vector of this length that is stored, rotated and added to one of length `to`.
  static double ofSum(double length, double to) {
    return UNIT * length + 4.0 * UNIT * (std::sqrt(3.0) * length + to);
  }

  void addTree(std::uint32_t element, const SphereCover& cover) {
    const SceneElement& of_scene = scene_.elements()[element];
    const int robot_body = scene_.bodies()[of_scene.body].body;
    const int body = addBody(robot_body);
    const Isometry3d X_CE =
        alongJoint(robot_, robot_.bodies()[robot_body]).transpose() * of_scene.X_BE;
    BatchTree tree;
    tree.first_outer = static_cast<int>(model_.spheres.size());
    for (const OuterSphere& sphere : cover.outer) {
      addSphere(sphere, X_CE, body, true);
      if (sphere.first_child == 0) continue;
      BatchSphere& made = model_.spheres.back();
      made.first_child = tree.first_outer + sphere.first_child;
      // Descending into the larger one first is faster. At SPHERES, without tables, the order must
      // be that of the single check, which has more spheres: the order in which they were divided.
      made.rank = with_tables_ ? made.radius : -static_cast<float>(sphere.first_child);
    }
    tree.first_inner = static_cast<int>(model_.spheres.size());
    for (const PlacedSphere& sphere : cover.inner) addSphere(sphere, X_CE, body, false);
    tree.nb_inner = static_cast<int>(model_.spheres.size()) - tree.first_inner;
    model_.trees.push_back(tree);
    addInner(tree, body);
    model_.element_of.push_back(element);
  }

  void addSphere(const PlacedSphere& sphere, const Isometry3d& X_CE, int body, bool is_outer) {
    const Vector3d center = X_CE * sphere.center;
    const PoseError& pose = model_.errors[static_cast<std::size_t>(body)];
    const double error = pose.position + pose.rotation * center.norm() +
                         SECOND_ORDER * ofSum(center.norm(), pose.reach) +
                         EXACT_MARGIN * (1.0 + center.norm() + sphere.radius);
    const double radius = is_outer ? (sphere.radius + error) * (1.0 + OF_DISTANCE)
                                   : (sphere.radius - error) * (1.0 - OF_DISTANCE);
    if (!is_outer && !(radius > 0.0)) return;
    BatchSphere made{{},
                     is_outer ? roundedUp(radius) : roundedDown(radius),
                     body,
                     0,
                     -std::numeric_limits<float>::infinity()};
    for (int i = 0; i < 3; ++i) made.center[i] = static_cast<float>(center[i]);
    model_.spheres.push_back(made);
  }

  void addInner(const BatchTree& tree, int body) {
    BatchInner made{};
    made.body = body;
    made.nb = std::min(tree.nb_inner, MOST_BATCH_LANES);
    std::fill(std::begin(made.radius), std::end(made.radius),
              -std::numeric_limits<float>::infinity());
    for (int i = 0; i < made.nb; ++i) {
      const BatchSphere& sphere = model_.spheres[static_cast<std::size_t>(tree.first_inner + i)];
      for (int axis = 0; axis < 3; ++axis) made.center[axis][i] = sphere.center[axis];
      made.radius[i] = sphere.radius;
    }
    model_.inner.push_back(made);
  }

  void addPairs() {
    const auto& elements = scene_.elements();
    const auto nb_trees = static_cast<int>(model_.trees.size());
    for (int a = 0; a < nb_trees; ++a) {
      for (int b = a + 1; b < nb_trees; ++b) {
        const BoxPair pair{elementOf(a), elementOf(b)};
        const SceneElement &first = elements[pair.first], &second = elements[pair.second];
        if (!scene_.filter().allowed(first.model, second.model)) continue;
        if (first.body == second.body && isAlwaysApart(pair)) continue;
        const double padding = scene_.padding(pair.first, pair.second);
        std::vector<int> joints;
        const bool has_table =
            with_tables_ && PairTable::joints(robot_, scene_.bodies()[first.body].body,
                                              scene_.bodies()[second.body].body, joints);
        const int root_a = rootOf(a), root_b = rootOf(b);
        const float outer_padding = roundedUp(padding * (1.0 + OF_DISTANCE));
        const float reach = radiusOf(root_a) + radiusOf(root_b) + outer_padding;
        model_.pairs.push_back({a, b, outer_padding, roundedDown(padding * (1.0 - OF_DISTANCE)),
                                has_table, root_a, root_b, reach * reach});
      }
    }
  }

  /// For two elements of one body, whose relative pose is constant.
  bool isAlwaysApart(const BoxPair& pair) {
    const SceneElement &a = scene_.elements()[pair.first], &b = scene_.elements()[pair.second];
    const Isometry3d X_AB = a.X_BE.inverse() * b.X_BE;
    const double reach = scene_.padding(pair.first, pair.second) + 1e-6;
    return narrow_phase_
               .distance(*a.rung(Fidelity::MESH).shape, *b.rung(Fidelity::MESH).shape, X_AB, reach)
               .certainty == Certainty::BEYOND;
  }

  int rootOf(int tree) const { return model_.trees[static_cast<std::size_t>(tree)].first_outer; }
  float radiusOf(int sphere) const {
    return model_.spheres[static_cast<std::size_t>(sphere)].radius;
  }
  std::uint32_t elementOf(int tree) const {
    return model_.element_of[static_cast<std::size_t>(tree)];
  }

  const CollisionScene& scene_;
  const RobotModel& robot_;
  const bool with_tables_;
  BatchModel& model_;
  std::vector<int> body_of_;  // the stage's body, by body of the robot
  NarrowPhase narrow_phase_;
};

}  // namespace

std::string BatchModel::whyNot(const CollisionScene& scene, Fidelity fidelity) {
  if (!scene.clouds().empty()) return "it has clouds";
  if (!scene.missing().empty()) return "geometry is missing";
  if (scene.narrowPhase() != NarrowPhaseMethod::NATIVE) return "FCL answers its pairs";
  for (std::uint32_t i = 0; i < scene.elements().size(); ++i) {
    const SceneElement& element = scene.elements()[i];
    const std::string& name = scene.models()[element.model].name;
    const bool is_half_space = std::holds_alternative<HalfSpace>(element.shape);
    if (element.finest < fidelity || !element.rung(Fidelity::MESH).shape) {
      return "'" + name + "' is checked by a coarser geometry";
    }
    if (is_half_space && element.body >= 0) return "'" + name + "' is a half-space that moves";
    const double reach =
        element.X_BE.translation().norm() +
        (is_half_space ? 0.0 : element.box_center.norm() + element.box_half.norm());
    if (!(reach + element.box_padding <= MOST_REACH)) return "'" + name + "' is too far away";
  }
  double reach = 0.0;
  for (const Body& body : scene.robot().bodies()) reach += body.X_PJ.translation().norm();
  return reach <= MOST_REACH ? "" : "the robot is too large";
}

BatchModel::BatchModel(const CollisionScene& scene, bool with_tables) {
  ModelMaker(scene, with_tables, *this).make();
}

std::size_t BatchModel::memory() const {
  std::size_t bytes = bodies.size() * sizeof(BatchBody) + errors.size() * sizeof(PoseError) +
                      spheres.size() * sizeof(BatchSphere) + trees.size() * sizeof(BatchTree) +
                      inner.size() * sizeof(BatchInner) + pairs.size() * sizeof(BatchPair);
  for (const SphereCover& cover : covers) {
    bytes += cover.outer.size() * sizeof(OuterSphere) + cover.inner.size() * sizeof(PlacedSphere);
  }
  return bytes;
}

}  // namespace collision_pairs
