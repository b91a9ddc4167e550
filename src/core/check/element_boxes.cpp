#include "element_boxes.h"

#include <limits>

#include "mesh_bounds.h"
#include "pose_repair.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();

// By how much the squares of the rows of the rotation differ from 1, squared: finds all but shears.
Vector4d errorOfRows(const Isometry3d& X) {
  const auto column = [&](int i) -> Vector4d { return X.matrix().col(i); };
  const Vector4d rows = column(0).cwiseAbs2() + column(1).cwiseAbs2() + column(2).cwiseAbs2();
  return (rows - Vector4d(1.0, 1.0, 1.0, 0.0)).cwiseAbs2();
}

}  // namespace

void ElementBoxes::prepare(const CollisionScene& scene) {
  scene_ = &scene;
  const auto& elements = scene.elements();
  const std::uint32_t nb_static = scene.nbStaticElements();
  X_WE_.assign(elements.size(), Isometry3d::Identity());
  boxes_.assign(elements.size(), noBox());
  known_.assign(elements.size(), Known::TIGHT_BOX);
  models_.clear();
  for (const SceneElement& element : elements) models_.push_back(element.model);
  of_bodies_.clear();
  for (std::uint32_t i = 0; i < nb_static; ++i) {
    X_WE_[i] = elements[i].X_BE;
    boxes_[i] = scene.staticBoxes().box(i);
  }
  for (std::uint32_t i = nb_static; i < scene.endOfMovingElements(); ++i) {
    const SceneElement& element = elements[i];
    BodyBox box{Vector3d::Zero(), Vector3d::Zero(), 0.0, element.body,
                element.mesh_bounds != nullptr};
    if (box.is_loose) {
      const Aabb tight_B = element.boxAt(element.X_BE);
      box.center = tight_B.center();
      box.half = 0.5 * (tight_B.max - tight_B.min);
      // The margin of the tight box along the axes of W is not rotated with the body, since it
      // would shrink if the rotation is not quite orthonormal.
      const double growth = element.mesh_bounds->margin + element.box_padding;
      box.margin = growth + ROUNDING * (box.center.lpNorm<1>() + box.half.sum());
      box.half = (box.half.array() - growth).max(0.0);
    }
    of_bodies_.push_back(box);
  }
}

std::uint32_t ElementBoxes::rebuild(const BodyPoses& poses, bool all_tight,
                                    const PairSelection* selection) {
  poses_ = &soundPoses(poses);
  without_box_.clear();
  const std::uint32_t first = scene_->nbStaticElements();
  auto nb_boxes = static_cast<std::uint32_t>(of_bodies_.size());
  for (std::uint32_t i = first; i < first + of_bodies_.size(); ++i) {
    const BodyBox& of_body = of_bodies_[i - first];
    known_[i] = Known::BODY;
    if (selection && !selection->uses(models_[i])) {
      boxes_[i] = noBox();
      --nb_boxes;
      continue;
    }
    if (!poses_->known[of_body.body]) {
      boxes_[i] = noBox();
      without_box_.push_back(i);
      continue;
    }
    const bool is_loose = of_body.is_loose && !all_tight;
    if (is_loose && setLoose(of_body, poses_->X_WB[of_body.body], boxes_[i])) continue;
    tighten(i);
    if (!boxes_[i].valid()) without_box_.push_back(i);
  }
  return nb_boxes - static_cast<std::uint32_t>(without_box_.size());
}

// The narrow phase repairs rotations, or refuses them. A box of the matrix as it is would dismiss
// what it has never seen.
const BodyPoses& ElementBoxes::soundPoses(const BodyPoses& poses) {
  Vector4d error = Vector4d::Zero();
  for (std::size_t i = 0; i < poses.X_WB.size(); ++i) {
    if (poses.known[i]) error += errorOfRows(poses.X_WB[i]);
  }
  if (error.sum() <= ORTHONORMAL * ORTHONORMAL) return poses;
  repaired_ = poses;
  for (std::size_t i = 0; i < repaired_.X_WB.size(); ++i) {
    if (repaired_.known[i] && !repairPose(repaired_.X_WB[i])) repaired_.known[i] = 0;
  }
  return repaired_;
}

// False if it is not finite; the tight one may be finite.
bool ElementBoxes::setLoose(const BodyBox& box, const Isometry3d& X_WB, Aabb& loose) const {
  const auto column = [&](int i) -> Vector4d { return X_WB.matrix().col(i); };
  const Vector4d x = column(0), y = column(1), z = column(2), p_WB = column(3);
  const Vector4d center = p_WB + (x * box.center[0] + y * box.center[1] + z * box.center[2]);
  const Vector4d half =
      x.cwiseAbs() * box.half[0] + y.cwiseAbs() * box.half[1] + z.cwiseAbs() * box.half[2] +
      Vector4d::Constant(box.margin + (ROUNDING * p_WB.head<3>().cwiseAbs()).sum());
  loose.min = (center - half).head<3>();
  loose.max = (center + half).head<3>();
  return (half + center.cwiseAbs()).sum() <= std::numeric_limits<double>::max();
}

void ElementBoxes::place(std::uint32_t i) {
  if (known_[i] != Known::BODY) return;
  const SceneElement& element = scene_->elements()[i];
  X_WE_[i] = poses_->X_WB[element.body] * element.X_BE;
  known_[i] = Known::POSE;
}

void ElementBoxes::tighten(std::uint32_t i) {
  if (known_[i] == Known::TIGHT_BOX) return;
  place(i);
  boxes_[i] = scene_->elements()[i].boxAt(X_WE_[i]);
  known_[i] = Known::TIGHT_BOX;
}

}  // namespace collision_pairs
