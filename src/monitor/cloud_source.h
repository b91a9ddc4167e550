// A source of point clouds, and its current voxels.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sensor_msgs/PointCloud2.h>

#include "cloud_processor.h"
#include "cloud_view.h"
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

/// A cloud whose voxels are to be computed. A source hands out one at a time; anyone runs it on any
/// thread, and the source takes it back.
class CloudJob {
 public:
  /// Never throws: what is wrong with the cloud becomes its problem.
  void run();
  /// The points that are obstacles, in the cloud's own frame. Until the source takes it back.
  const std::vector<Eigen::Vector3d>& kept() const { return processor_->kept(); }
  const std_msgs::Header& header() const { return cloud_->header; }
  /// False: it had a problem.
  bool isUsed() const { return latest_.problem.empty(); }

 private:
  friend class CloudSource;
  sensor_msgs::PointCloud2::ConstPtr cloud_;
  ros::Time arrived_;
  Eigen::Isometry3d X_WS_ = Eigen::Isometry3d::Identity();
  BodyPoses robot_;  ///< at its stamp
  std::shared_ptr<FollowedRobot> followed_;
  std::shared_ptr<CloudProcessor> processor_;
  std::string publisher_;
  unsigned generation_ = 0, clock_jumps_ = 0;
  // Results.
  LatestCloud latest_;
  std::size_t nb_points_ = 0, nb_kept_ = 0;
  double seconds_ = 0.0;
};

/// A cloud waits for the transforms at its own stamp, for a second at most, or until a newer one
/// has all of its own; of those that arrive meanwhile the newest is kept. The others are dropped
/// and counted. A cloud that cannot be used is refused: it changes only the reason why the view is
/// not usable, until a usable one arrives. That begins when no transform connects the cloud's
/// frame, even if one may still arrive. Time is that of the transforms. Not thread safe.
class CloudSource {
 public:
  using Cloud = sensor_msgs::PointCloud2;
  static const std::string REFUSED;  ///< begins the note of a message that was refused

  /// `topic`: for messages. `frame`: W. The transforms must outlive it.
  CloudSource(const CloudConfig& config, std::string topic, std::string frame,
              const TransformInput& transforms);

  const CloudConfig& config() const { return config_; }
  const std::string& topic() const { return topic_; }
  const std::string& frame() const { return frame_; }

  /// Applies from the next cloud on; clouds are not processed before the first call. If the filter
  /// may keep points that the one before left out, the view has a problem until that cloud. Returns
  /// the one before.
  std::shared_ptr<FollowedRobot> follow(std::shared_ptr<FollowedRobot> robot, bool may_keep_more);

  /// What may touch by the clouds of that source may do so until clear(), since this one has not
  /// seen where it went.
  void replace(const CloudSource& before);

  /// `publisher`: the node that sent it. A cloud of another frame than those that were used, or of
  /// another node while clouds of the one before are not too old, is refused, and the view has a
  /// problem for source_timeout: of two cameras on one topic nothing would tell that one is silent.
  void take(const Cloud::ConstPtr& cloud, const std::string& publisher);
  /// The next cloud, if there is one, all that it needs is known, and none is being processed.
  std::shared_ptr<CloudJob> next();
  /// True while a cloud waits for what next() needs.
  bool isWaiting() const { return waiting_.cloud || next_.cloud; }
  void take(CloudJob& job);
  /// The view has a problem until a cloud is used.
  void refuse(const std::string& why);

  CloudView view() const;
  /// Discards everything: there is no view until a cloud that arrives later is used.
  void clear();

  CloudHealth health() const;
  /// What to tell people, once each.
  std::string takeNote() { return std::exchange(note_, ""); }

 private:
  struct Arrived {
    Cloud::ConstPtr cloud;  ///< null: none
    std::string publisher;
    ros::Time when;
    double steady = 0.0;
    unsigned clock_jumps = 0;
    std::optional<std::uint64_t> nb_taken = {};  ///< messages of transforms when last looked
  };

  struct Camera {
    std::string frame, publisher;
  };
  /// What is wrong with a cloud of it; empty: it is the one that clouds were used of, or the first.
  std::string otherCamera(const std::string& frame, const std::string& publisher) const;
  void requireUsableStamp(const ros::Time& stamp) const;
  /// Why the poses are not known yet; empty: they are.
  struct Missing {
    std::string why;
    bool is_connected = true;  ///< the frame is: only the stamp is missing
  };
  Missing lookUp(const std_msgs::Header& header, CloudJob& found) const;
  /// Throws InputError if the cloud is to be refused; null: something is missing that may come.
  std::shared_ptr<CloudJob> begin(Arrived& arrived);
  std::shared_ptr<CloudJob> beginNewer();
  void rememberWhatMayTouch();

  const CloudConfig config_;
  const std::string topic_, frame_;
  const TransformInput& transforms_;

  Arrived next_, waiting_;
  std::weak_ptr<const CloudJob> running_;
  std::shared_ptr<CloudProcessor> processor_;
  unsigned gathered_clock_jumps_ = 0, gathered_generation_ = 0;  // of the processor
  ros::Time last_stamp_;
  std::optional<Camera> camera_;  // of the clouds that were used
  std::string other_camera_;      // what is wrong with clouds of another
  double other_at_ = 0.0;         // s, steady: when the last of them arrived
  unsigned generation_ = 0;       // counts calls of clear()
  std::shared_ptr<FollowedRobot> robot_;
  LatestCloud latest_;
  std::string may_touch_;       // by the clouds of the source that this one replaced
  unsigned latest_robot_ = 0;   // number of the robot that was filtered from it
  unsigned complete_from_ = 0;  // that of the first whose filter leaves out no more than today's
  unsigned latest_clock_jumps_ = 0;  // on arrival of the latest cloud
  CloudHealth health_;
  double last_use_ = 0.0;
  std::string note_;
};

}  // namespace collision_pairs
