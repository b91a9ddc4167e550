// The topics of point clouds and their current voxels.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <sensor_msgs/PointCloud2.h>

#include "cloud_gatherer.h"
#include "cloud_view.h"
#include "collision_pairs/scene_description.h"
#include "tf_poses.h"
#include "transform_input.h"

namespace collision_pairs {

/// The robot of one scene, as one source sees it.
struct FollowedRobot {
  RobotFilter filter;
  TfPoses poses;        ///< of filter.own.bodies()
  unsigned number = 0;  ///< of those that the source has followed
};

/// For diagnostics.
struct CloudHealth {
  std::uint64_t received = 0, used = 0, refused = 0;
  std::uint64_t dropped = 0;  ///< replaced by a newer one before processing
  double rate = 0.0;          ///< Hz, of clouds used, over about the last ten
  double latency = 0.0;       ///< s, from the stamp of the last one to its voxels
  double processing = 0.0;    ///< s, the part of it without waiting
  std::size_t points = 0, kept = 0, voxels = 0;
};

/// Receives clouds on one thread and computes their voxels on another, so that neither the cycle
/// nor the subscription ever waits. A cloud being processed waits for the transforms at its own
/// stamp; of those that arrive meanwhile the newest is kept and the others are dropped and counted.
/// A cloud that cannot be used is refused: it changes only the doubt, until a usable one arrives.
/// The doubt begins when no transform connects the cloud's frame, even if one may still arrive.
class CloudSource {
 public:
  struct Context {
    TransformInput& transforms;  ///< outlives the source
    std::string frame;           ///< W
    ros::Publisher filtered_cloud;
  };

  CloudSource(const ros::NodeHandle& node, const CloudConfig& config, Context context);
  ~CloudSource();

  const CloudConfig& config() const { return config_; }

  /// Applies from the next cloud on; clouds are not processed before the first call. If the filter
  /// may keep points that the one before left out, there is a doubt until that cloud.
  void follow(std::shared_ptr<FollowedRobot> robot, bool may_keep_more);

  CloudView view(const ros::Time& now) const;
  /// Discards everything: there is no view until a cloud that arrives later is used.
  void clear();
  CloudHealth health() const;

 private:
  using Cloud = sensor_msgs::PointCloud2;
  struct Instant {
    Eigen::Isometry3d X_WS;
    BodyPoses robot;
  };

  void onCloud(const Cloud::ConstPtr& cloud);
  void work();
  void use(const Cloud& cloud, const ros::Time& arrived, unsigned generation, FollowedRobot& robot);
  void keep(const std::shared_ptr<const OccupiedVoxels>& voxels, double measured,
            unsigned generation, const FollowedRobot& robot, double processing);
  void requireUsableStamp(const ros::Time& stamp, const ros::Time& now);
  Instant waitForInstant(const std_msgs::Header& header, unsigned generation,
                         const FollowedRobot& robot);
  /// Says in the log, every few seconds, what is wrong.
  void tell(const std::string& what);
  /// Why the poses are not known yet; empty: they are.
  struct Missing {
    std::string why;
    bool is_connected = true;  ///< the frame is: only the stamp is missing
  };
  Missing lookUp(const std_msgs::Header& header, const FollowedRobot& robot, Instant& found);
  void publishKept(const std_msgs::Header& header) const;

  const CloudConfig config_;
  const Context context_;

  // Used by the worker only.
  CloudGatherer gatherer_;
  std::vector<Eigen::Vector3d> points_;
  ros::Time last_stamp_;
  unsigned nb_clock_jumps_ = 0;
  unsigned cleared_for_ = 0;  // the grid's generation
  ros::SteadyTime next_telling_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wakes_worker_;
  bool stopping_ = false;
  unsigned generation_ = 0;  // counts calls of clear()
  Cloud::ConstPtr next_;
  ros::Time next_arrived_;
  unsigned next_clock_jumps_ = 0;  // on its arrival
  std::shared_ptr<FollowedRobot> robot_;
  LatestCloud latest_;
  unsigned latest_robot_ = 0;   // number of the robot that was filtered from it
  unsigned complete_from_ = 0;  // that of the first whose filter leaves out no more than today's
  unsigned latest_clock_jumps_ = 0;  // on arrival of the latest cloud
  CloudHealth health_;
  ros::SteadyTime last_use_;

  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_;
  std::thread worker_;
  ros::AsyncSpinner spinner_;  // last: stops before the members it uses are destroyed
};

/// All sources of ~clouds. May be used from several threads.
class CloudSources {
 public:
  /// Throws InputError for an invalid topic name. Topics are resolved like those of `node`.
  CloudSources(const ros::NodeHandle& node, const std::vector<CloudConfig>& configs,
               const CloudSource::Context& context);

  /// True if these sources match the parameter and the frame.
  bool areOf(const std::vector<CloudConfig>& configs, const std::string& frame) const;

  /// Filters for this scene's robot, one per source, and their activation. Creating them may take
  /// as long as the scene, and throws InputError.
  using FollowedRobots = std::vector<std::shared_ptr<FollowedRobot>>;
  FollowedRobots filtersFor(const SceneDescription& description, const CollisionScene& scene,
                            const std::vector<std::string>& static_joints, SceneCache* cache) const;
  void follow(FollowedRobots filters, bool may_keep_more);

  /// The views of all sources by name; null if unknown.
  std::map<std::string, CloudView> views(const ros::Time& now) const;

  void clear();
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  const CloudSource::Context context_;
  std::vector<std::unique_ptr<CloudSource>> sources_;
};

}  // namespace collision_pairs
