// Settles pairs of elements at given poses by points and spheres of one in the field of the other.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include <Eigen/Geometry>

#include "batch_model.h"
#include "solid_field.h"

namespace collision_pairs {

/// If all spheres that enclose an element are apart from a solid, so is the element; if a corner of
/// it is inside, it is in contact. What neither tells is left open. Nothing is said in error: both
/// answers are those of the exact check. Only for two that move, are large meshes and have no
/// table: small ones cost the exact check little, and where a table is undecided, they are too
/// close to contact for this. The data of an element are made when pairs with it have been asked
/// for so often that it pays. Thread safe.
class SolidPairs {
 public:
  /// Both must outlive it.
  SolidPairs(const CollisionScene& scene, const BatchModel& model);

  enum class Outcome { OPEN, FREE, CONTACT };
  /// X_AB: of the second element in the frame of the first. Cost: 0.1 to 1 us.
  Outcome settle(const BoxPair& pair, const Eigen::Isometry3d& X_AB) const;
  std::size_t memory() const;  ///< bytes

  static constexpr int ASKED = 10000;                   ///< before the data are made
  static constexpr std::size_t LEAST_TRIANGLES = 1000;  ///< of the two together

 private:
  struct ElementData {
    std::atomic<int> nb_asked{0};
    std::once_flag once;
    std::atomic<bool> is_made{false};
    std::unique_ptr<const SolidField> field;  // null: there is none
    std::vector<PlacedSphere> spheres;        // that enclose the element
    std::vector<Eigen::Vector3d> corners;     // of the element
    SolidField::Points of_spheres, of_corners;
  };
  std::size_t indexOf(const BoxPair& pair) const;
  const ElementData& dataOf(std::uint32_t element) const;
  void make(std::uint32_t element, ElementData& data) const;
  static bool areApart(const ElementData& solid, const ElementData& other,
                       const Eigen::Isometry3d& X, double padding);
  static bool touch(const ElementData& solid, const ElementData& other, const Eigen::Isometry3d& X);

  const CollisionScene& scene_;
  const BatchModel& model_;
  mutable std::vector<ElementData> data_;  // by element, in that of the first one with its shape
  std::vector<std::uint32_t> first_with_shape_;
  std::vector<char> is_worth_;  // by indexOf()
};

}  // namespace collision_pairs
