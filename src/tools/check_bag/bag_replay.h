// A bag as a node would have heard it, in simulated time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bag_index.h"
#include "joint_transforms.h"
#include "monitor.h"
#include "recorded_scenes.h"
#include "robot_frames.h"

namespace collision_pairs {

struct BagReplayOptions {
  PoseLimits limits;
  std::string prefix;  ///< of this robot's names in the bag
};

/// Where the scene is from, if it is recorded.
struct SceneSource {
  const RecordedScenes* recorded = nullptr;  ///< null: the parameters that are given stay
  std::function<SceneParameters(const Scene&)> parameters_of = nullptr;
  std::function<SceneObjects(const Scene&)> objects_of = nullptr;
  /// Of each scene that was built; may throw.
  std::function<void(const CollisionScene&)> review = nullptr;
};

/// Feeds a Monitor with the messages of a bag, in the order and at the times at which they were
/// recorded, and takes a snapshot after each message of transforms, as a node with ~trigger: tf,
/// and when the clock reaches a stamp that was ahead of it. If joint states know more of the robot
/// than TF does, what robot_state_publisher would have made of them stands for the transforms of
/// its links.
class BagReplay {
 public:
  /// `wants`: of the index. Builds the first scene; throws InputError.
  BagReplay(std::string path, const BagIndex& index, const RawMessageFilter& wants,
            const BagReplayOptions& options, const SceneSource& scenes, SceneParameters parameters,
            std::shared_ptr<SceneCache> cache);

  /// Once. Throws InputError also if there is no stamp at which a body of the robot could be known.
  /// Visits the last report of each stamp, in their order; consecutive stamps differ. `nb_taken`:
  /// messages so far.
  using Visit = std::function<void(const Snapshot& report, std::size_t nb_taken)>;
  void run(const Visit& visit);

  const Monitor& monitor() const { return monitor_; }
  const ActiveScenePtr& scene() const { return scene_; }
  /// As they were given, with what was read; the last call.
  SceneParameters takeParameters();
  /// As the bag calls the frame of the reports.
  std::string frameInBag() const { return frames_.inBag(scene_->frame); }
  /// Assumptions, and what was not used; one sentence each. Complete after run().
  std::vector<std::string> notes() const;

 private:
  /// For notes.
  struct CloudNotes {
    std::size_t nb_clouds = 0, nb_refused = 0, nb_dropped = 0, nb_warned = 0;
    std::string first_problem, first_warning;
  };

  void load(SceneParameters parameters, std::optional<SceneObjects> objects = {});
  void run(SceneJob job);
  void choosePoses();
  [[noreturn]] void refuse(const std::vector<std::string>& problems) const;
  void take(const RawMessage& raw);
  void advance(const ros::Time& now);
  void take(const tf2_msgs::TFMessage& message, bool is_static, const std::string& publisher);
  void takeTransforms(tf2_msgs::TFMessage message, bool is_static, const std::string& publisher);
  void takeCloud(const RawMessage& raw);
  void takeScene(const RawMessage& raw);
  void filterClouds();
  void report();
  void flush();

  const std::string path_;
  const BagIndex& index_;
  const RawMessageFilter wants_;
  const BagReplayOptions options_;
  const SceneSource scenes_;
  Monitor monitor_;
  ActiveScenePtr scene_;
  Scene shown_;                             ///< the last one that was recorded
  std::vector<std::string> static_joints_;  ///< as given
  std::vector<std::string> at_zero_;        ///< joints, all of them if some are at zero
  RobotFrames frames_;
  ActiveScenePtr scene_of_joints_;            ///< whose robot they refer to
  std::optional<JointTransforms> joints_;     ///< none: TF places the robot
  std::set<std::string> made_frames_;         ///< by joints_
  std::vector<std::string> unknown_because_;  ///< of every report
  std::vector<std::string> notes_;
  std::map<std::string, CloudNotes> clouds_;  ///< by name
  std::optional<Snapshot> latest_;
  std::set<ros::Time> ahead_;  ///< stamps of transforms that the clock has not reached
  std::size_t nb_taken_ = 0;
  const Visit* visit_ = nullptr;
};

}  // namespace collision_pairs
