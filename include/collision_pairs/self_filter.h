// Removes the points of a cloud that lie on the robot itself.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "collision_pairs/aabb.h"
#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// A point is the robot's own if it lies inside a link of a robot or an object attached to one, or
/// no further than `padding` from it. All links with geometry count, including links in no allowed
/// pair and ignored links; the world and static objects do not. The original shapes are used
/// (MESH), whatever the fidelity of the scene.
///
/// Error: a point no further than the padding is always removed, a point further than padding +
/// 1e-6 m is always kept.
///
///   filter.begin(poses);
///   if (!filter.isOwn(p_WP)) grid.add(p_WP);
///
/// Cost: some nanoseconds for a point far from every link. Near a link, a look-up in cells in the
/// link's frame (valid in every posture) that are known to be wholly inside or outside; in border
/// cells, and when a cell is first used, an exact distance of about a microsecond. The cells are
/// only a cache: the answer depends on the poses alone. Use one per thread.
class SelfFilter {
 public:
  /// padding in metres, >= 0, otherwise throws InputError. Reuses the meshes of `cache`. `only`:
  /// points of other links and objects are not the robot's; null: all count.
  SelfFilter(const SceneDescription& description, double padding, SceneCache* cache = nullptr,
             const std::set<std::string>* only = nullptr);
  ~SelfFilter();
  SelfFilter(SelfFilter&&) noexcept;
  SelfFilter& operator=(SelfFilter&&) noexcept;

  /// The bodies whose poses begin() takes; `body` is an index into RobotModel::bodies() of a scene
  /// of the same description. More bodies than those of the scene if links are in no allowed pair.
  const std::vector<SceneBody>& bodies() const;

  /// Starts a cloud, with the poses of bodies() at its stamp. Throws InputError if their number
  /// differs. Links of bodies without a known pose (BodyPoses) are not filtered.
  void begin(const BodyPoses& poses);
  /// Links and objects not filtered since begin(), whose points would appear as obstacles.
  const std::vector<std::string>& leftOut() const;

  /// True if the point (metres, in W) belongs to the robot.
  bool isOwn(const Eigen::Vector3d& p_WP);

  /// Cheaper: true for all points that belong to the robot, and for some within a few centimetres
  /// (two thirds of the padding) of those. The answer depends on the poses alone.
  bool mayBeOwn(const Eigen::Vector3d& p_WP);

  struct Nearest {
    std::string name;       ///< of the link or object; empty: none is within the padding
    std::size_t body;       ///< index in bodies()
    double distance = 0.0;  ///< metres, negative inside (inside a mesh: 0)
  };
  /// Of those in `only`; null: of all. Cost: about a microsecond per element near the point.
  Nearest nearest(const Eigen::Vector3d& p_WP, const std::set<std::string>* only = nullptr);
  /// A box in W, since begin(), that contains all points of the robot.
  Aabb bounds() const;
  /// The links and objects that are filtered.
  const std::vector<std::string>& names() const;

 private:
  struct Store;
  std::unique_ptr<Store> store_;
};

}  // namespace collision_pairs
