// Checks many states of one scene on several threads.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

class BatchStage;

/// Keeps one detector per thread, so that later batches reuse its memory. The answer for a state
/// does not depend on the thread that computes it.
class BatchCheck {
 public:
  /// threads: 0 means one per core.
  explicit BatchCheck(std::shared_ptr<const CollisionScene> scene, unsigned threads = 0);
  ~BatchCheck();

  /// Calls pose(i, poses) and then, on the same thread, take(i, report), once for each i below
  /// `count`, in any order and from several threads at a time. Both must only touch data of their
  /// own i. The first exception from either ends the batch and is rethrown here.
  using Pose = std::function<void(std::size_t, BodyPoses&)>;
  using Take = std::function<void(std::size_t, const CollisionReport&)>;
  void run(std::size_t count, const CheckSettings& settings, const Pose& pose, const Take& take);

  /// The same for joint states: positions(i, q) fills in one entry per joint of the robot (rad or
  /// m), with mimic joints applied; poses are forwardKinematics() of the robot of scene(). Up to 16
  /// states are requested before the first of them is taken.
  ///
  /// With verdict_only, several states are processed together, and few of them need the exact
  /// check: the batch stage (docs/many_states.md). Verdicts are the same, except that at SPHERES a
  /// state may rightly be FREE where a single check takes spheres that lie outside the box of a
  /// static element to be touched. For a state settled by it the report contains only the verdict,
  /// one pair in contact or none, and times.total, its share of the group's time; no counts and no
  /// boxes. The stage is prepared by the first batch with which STATES_WORTH_A_STAGE states have
  /// been requested. It is not used with a time budget, a selection, a predicate, a fidelity other
  /// than MESH and SPHERES, in scenes with clouds, coarser links or FCL, nor for states beyond
  /// 10,000 rad; all of these are checked exactly.
  using Positions = std::function<void(std::size_t, std::vector<double>&)>;
  void runJoints(std::size_t count, const CheckSettings& settings, const Positions& positions,
                 const CloudVoxels& voxels, const Take& take);
  /// Preparing the batch stage costs about as much as checking this many states exactly.
  static constexpr std::size_t STATES_WORTH_A_STAGE = 30000;
  /// Bytes of the batch stage without the scratch memory of threads; 0: it is not in use.
  std::size_t stageMemory() const;

  const CollisionScene& scene() const { return *scene_; }

 private:
  class JointsOfThread;
  struct StageOfThread;
  struct Stage;
  /// Null if all states are checked by the detectors.
  Stage* stageFor(std::size_t count, const CheckSettings& settings);

  std::shared_ptr<const CollisionScene> scene_;
  std::vector<CollisionDetector> detectors_;
  std::map<Fidelity, std::unique_ptr<Stage>> stages_;
};

}  // namespace collision_pairs
