#include "collision_pairs/distance_gradient.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d poseOf(std::uint32_t id, const Contact& contact, const CollisionScene& scene,
                  const std::vector<Isometry3d>& X_WB) {
  if (scene.cloudOf(id) >= 0) return scene.poseOfVoxel(id, contact.voxel);
  const SceneElement& element = scene.elements()[id];
  return element.body < 0 ? element.X_BE : X_WB[scene.bodies()[element.body].body] * element.X_BE;
}

/// True if it is, or may be, the distance of the axis-aligned boxes, which is the result of a
/// larger rung if it is the better bound.
bool isOfAlignedBoxes(const PairReport& pair, const Contact& nearest, const CollisionScene& scene,
                      const std::vector<Isometry3d>& X_WB) {
  if (pair.fidelity == Fidelity::AABB || pair.fidelity == Fidelity::SPHERES) return true;
  const BoxPair& elements = nearest.elements;
  const bool loose = scene.elements()[elements.first].rung(pair.fidelity).loose ||
                     scene.elements()[elements.second].rung(pair.fidelity).loose;
  if (!loose) return false;
  const auto boxOf = [&](std::uint32_t element) {
    return scene.elements()[element].boxAt(poseOf(element, nearest, scene, X_WB));
  };
  const Aabb a = boxOf(elements.first), b = boxOf(elements.second);
  const double widest = (b.min - a.max).cwiseMax(a.min - b.max).maxCoeff();
  return pair.distance == (widest > 0.0 ? std::sqrt(squaredGap(a, b)) : widest);
}

}  // namespace

DistanceGradient::DistanceGradient(const CollisionScene& scene, const JointColumns& joints)
    : scene_(scene), joints_(joints) {}

bool DistanceGradient::compute(const PairReport& pair, const CollisionReport& report,
                               const std::vector<Isometry3d>& X_WB, double* gradient) const {
  const Contact* found = report.nearestContact(pair);
  const bool is_measured = found != nullptr && (pair.certainty == Certainty::EXACT ||
                                                pair.certainty == Certainty::BOUND);
  if (!is_measured || isOfAlignedBoxes(pair, *found, scene_, X_WB)) {
    std::fill_n(gradient, joints_.size(), std::numeric_limits<double>::quiet_NaN());
    return false;
  }
  const Contact& nearest = *found;
  std::fill_n(gradient, joints_.size(), 0.0);
  // The joints above move both alike and change nothing.
  scene_.robot().visitBetween(
      scene_.robotBody(scene_.models()[pair.first]), scene_.robotBody(scene_.models()[pair.second]),
      [&](int body, bool is_above_first) {
        addSpeed(body, is_above_first ? nearest.p_WFirst : nearest.p_WSecond,
                 is_above_first ? Vector3d(-nearest.nhat_W) : nearest.nhat_W, X_WB, gradient);
      });
  return true;
}

// The body rotates about the joint's axis through its origin, or slides along it.
void DistanceGradient::addSpeed(int body, const Vector3d& p_W, const Vector3d& nhat_W,
                                const std::vector<Isometry3d>& X_WB, double* gradient) const {
  const int joint_id = scene_.robot().bodies()[body].joint;
  if (joint_id < 0 || joints_.sourceOf(joint_id).column < 0) return;
  const JointColumns::Source& source = joints_.sourceOf(joint_id);
  const Joint& joint = scene_.robot().joints()[joint_id];
  const Vector3d axis_W = X_WB[body].linear() * joint.axis;
  const Vector3d velocity =
      joint.type == JointType::PRISMATIC ? axis_W : axis_W.cross(p_W - X_WB[body].translation());
  gradient[source.column] += source.multiplier * nhat_W.dot(velocity);
}

}  // namespace collision_pairs
