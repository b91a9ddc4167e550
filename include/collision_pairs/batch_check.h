// Many states against one scene, on several threads.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

class BatchStage;

/// Keeps a detector for each thread, so that a second batch finds its memory warm. Which thread
/// answers a state makes no difference to the answer.
class BatchCheck {
 public:
  /// threads: 0 means as many as the machine has.
  explicit BatchCheck(std::shared_ptr<const CollisionScene> scene, unsigned threads = 0);
  ~BatchCheck();

  /// Calls pose(i, poses) and then, on the same thread, take(i, report) for each i below `count`,
  /// each i once, in any order and from several threads at a time: both must leave alone what
  /// belongs to another i.
  /// The first exception of either ends the batch and is thrown again here.
  using Pose = std::function<void(std::size_t, BodyPoses&)>;
  using Take = std::function<void(std::size_t, const CollisionReport&)>;
  void run(std::size_t count, const CheckSettings& settings, const Pose& pose, const Take& take);

  /// The same for joint states: positions(i, q) fills in an entry for each of the robot's joints,
  /// mimics applied, and their poses are RobotModel::forwardKinematics() of these. Up to 16 states
  /// are asked for before the first of them is taken.
  ///
  /// With verdict_only, several states are looked at at once, and few come to the exact check: the
  /// batch stage (docs/batch.md). Verdicts are the same. Of a state that it settles the report
  /// holds the verdict, one pair in contact or none, and times.total: its share of the group's
  /// time; nothing was counted, and there are no boxes. Made ready by the first batch with which
  /// STATES_WORTH_A_STAGE states were asked for. Not for a time budget, a fidelity other than MESH
  /// and SPHERES, scenes with clouds, coarser links or FCL, nor for states beyond 10,000 rad: these
  /// come to the exact check, all of them.
  using Positions = std::function<void(std::size_t, std::vector<double>&)>;
  void runJoints(std::size_t count, const CheckSettings& settings, const Positions& positions,
                 const CloudVoxels& voxels, const Take& take);
  /// What making the batch stage ready costs is about what the exact check of so many does.
  static constexpr std::size_t STATES_WORTH_A_STAGE = 30000;
  /// Bytes of the batch stage, scratch memory of threads not counted; 0: it is not in use.
  std::size_t stageMemory() const;

  const CollisionScene& scene() const { return *scene_; }

 private:
  class JointsOfThread;
  struct StageOfThread;
  struct Stage;
  /// Null where all come to the detectors.
  Stage* stageFor(std::size_t count, const CheckSettings& settings);

  std::shared_ptr<const CollisionScene> scene_;
  std::vector<CollisionDetector> detectors_;
  std::map<Fidelity, std::unique_ptr<Stage>> stages_;
};

}  // namespace collision_pairs
