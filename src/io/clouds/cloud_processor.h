// Converts the points of one source into occupied voxels.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "cloud_config.h"
#include "collision_pairs/self_filter.h"
#include "collision_pairs/voxel_grid.h"

namespace collision_pairs {

class DepthMap;
class OccludedObstacles;

/// What tells points of the robot from obstacles, and obstacles near it from others.
struct RobotFilter {
  /// The filter is of all links, `near` of those that the scene checks against the cloud.
  RobotFilter(const SceneDescription& description, const CollisionScene& scene,
              const CloudConfig& cloud, SceneCache* cache = nullptr);

  SelfFilter own, near;  ///< of the same bodies()
  SelfFilter attached;   ///< of attached objects alone; as far as a voxel of their points may be
  /// May keep points that the filter of the last cloud left out: what appears may be these.
  bool keeps_more = false;
};

/// What the first of two scenes checks against a cloud, and the second does not.
std::vector<std::string> onlyCheckedBy(const CollisionScene& scene, const CollisionScene& other);

/// Crops, filters and collects points, and follows what it saw near the robot. Not thread safe.
class CloudProcessor {
 public:
  explicit CloudProcessor(const CloudConfig& config);
  ~CloudProcessor();
  CloudProcessor(CloudProcessor&&) noexcept;

  /// Points in the sensor's frame S, the pose of S in W and the robot's poses at that stamp, and
  /// the stamp in seconds. Throws InputError, and changes nothing, if a link of the robot has no
  /// pose, since its points would be obstacles, or if fewer than min_valid_points are valid.
  std::shared_ptr<const OccupiedVoxels> add(const std::vector<Eigen::Vector3d>& points,
                                            const Eigen::Isometry3d& X_WS, const BodyPoses& robot,
                                            double stamp, RobotFilter& filter);

  /// "vanished 2 cm from panda_link3: it may touch": an obstacle of an earlier cloud. Or empty.
  std::string mayTouch() const;
  /// Whether obstacles of earlier clouds are kept that the last one could not see.
  bool hidesAny() const;
  /// The points of the last cloud that are obstacles, in S.
  const std::vector<Eigen::Vector3d>& kept() const { return kept_; }
  /// A warning if the last cloud showed nothing: no valid point, which min_valid_points permits.
  const std::string& warning() const { return warning_; }
  void clear();

 private:
  using Points = std::vector<Eigen::Vector3d>;
  enum class Kind : char { KEPT, OWN, LEFT_OUT };

  void requireValid(const Points& points);
  void sort(const Points& points, const Eigen::Isometry3d& X_WS, SelfFilter& own);
  void remember(const Points& points, const Eigen::Isometry3d& X_WS, const BodyPoses& robot,
                RobotFilter& filter);
  void drawDepths(const Points& points);

  const CloudConfig config_;
  VoxelGrid grid_;
  std::unique_ptr<OccludedObstacles> memory_;
  std::unique_ptr<DepthMap> depths_;
  std::vector<Kind> kinds_;  ///< of the points
  Points kept_;
  std::vector<std::string> own_names_;  ///< of the last filter
  std::string warning_;
};

}  // namespace collision_pairs
