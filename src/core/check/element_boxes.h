// Poses of the elements in one cycle, and their boxes, loose or tight.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/aabb.h"
#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/pair_selection.h"

namespace collision_pairs {

/// The box of an element is SceneElement::boxAt(). For a mesh it costs a loop over its outermost
/// vertices. Most elements are near no other, which a looser box shows as well: the element's box
/// along its body's axes, computed once, with half sizes |R_WB| h along the axes of W (G. van den
/// Bergen, "Collision Detection in Interactive 3D Environments", 2003, 4.3). It encloses the tight
/// box, so that no candidate is missed; inReach() rejects pairs of which only the loose boxes are
/// in reach.
///
/// Only memory is kept between cycles.
class ElementBoxes {
 public:
  /// Call once, first. Cost: a tight box for each element.
  void prepare(const CollisionScene& scene);

  /// For all moving elements except those of clouds and those that a selection (may be null) does
  /// not use; returns the number of boxes. `poses` must outlive the cycle. About 15 ns for a loose
  /// box, 50 for the tight one of a mesh; those of primitives are always tight.
  std::uint32_t rebuild(const BodyPoses& poses, bool all_tight,
                        const PairSelection* selection = nullptr);

  /// Moving elements without a box, ascending: without a pose, or not finite.
  const std::vector<std::uint32_t>& withoutBox() const { return without_box_; }

  /// Computes X_WE() and the tight box of an element that has a box.
  void place(std::uint32_t element);
  void tighten(std::uint32_t element);

  /// True if the tight boxes are within squaredReach().
  bool inReach(const BoxPair& pair, double squared_reach) {
    tighten(pair.first);
    tighten(pair.second);
    return squaredGap(boxes_[pair.first], boxes_[pair.second]) <= squared_reach;
  }

  /// One per element, in W: tight if requested, else loose or invalid. Those of clouds are written
  /// by the caller.
  std::vector<Aabb>& boxes() { return boxes_; }
  const std::vector<Aabb>& boxes() const { return boxes_; }
  std::vector<Eigen::Isometry3d>& X_WE() { return X_WE_; }
  /// SceneElement::model of each, contiguous.
  const std::vector<std::uint32_t>& models() const { return models_; }

 private:
  enum class Known : std::uint8_t { BODY, POSE, TIGHT_BOX };

  /// For a moving element: its box along the axes of its body, measured and expressed in B.
  struct BodyBox {
    Eigen::Vector3d center, half;
    double margin;  // metres along the axes of W
    int body;
    bool is_loose;  // false: the tight one costs no more
  };
  bool setLoose(const BodyBox& box, const Eigen::Isometry3d& X_WB, Aabb& loose) const;
  const BodyPoses& soundPoses(const BodyPoses& poses);

  const CollisionScene* scene_ = nullptr;
  const BodyPoses* poses_ = nullptr;
  BodyPoses repaired_;
  std::vector<BodyBox> of_bodies_;
  std::vector<std::uint32_t> models_;
  std::vector<Known> known_;
  std::vector<Aabb> boxes_;
  std::vector<Eigen::Isometry3d> X_WE_;
  std::vector<std::uint32_t> without_box_;
};

}  // namespace collision_pairs
