// Many states against one scene, on several threads.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// Keeps a detector for each thread, so that a second batch finds its memory warm. Which thread
/// answers a state makes no difference to the answer.
class BatchCheck {
 public:
  /// threads: 0 means as many as the machine has.
  explicit BatchCheck(std::shared_ptr<const CollisionScene> scene, unsigned threads = 0);

  /// Calls pose(i, poses) and then, on the same thread, take(i, report) for each i below `count`,
  /// each i once, in any order and from several threads at a time: both must leave alone what
  /// belongs to another i.
  /// The first exception of either ends the batch and is thrown again here.
  using Pose = std::function<void(std::size_t, BodyPoses&)>;
  using Take = std::function<void(std::size_t, const CollisionReport&)>;
  void run(std::size_t count, const CheckSettings& settings, const Pose& pose, const Take& take);

  const CollisionScene& scene() const { return *scene_; }

 private:
  std::shared_ptr<const CollisionScene> scene_;
  std::vector<CollisionDetector> detectors_;
};

}  // namespace collision_pairs
