// The batch stage for motions, shared by all checks of a scene.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "edge_group.h"
#include "motion_pairs.h"
#include "pair_certifier.h"
#include "uncertified_pairs.h"

namespace collision_pairs {

/// Made once searches have cost as much as making it does, by one thread while others wait. Each
/// thread has a group of its own, with its tables. Thread safe.
class EdgeStage {
 public:
  /// That of all MotionChecks of the scene that live.
  static std::shared_ptr<EdgeStage> of(const std::shared_ptr<const CollisionScene>& scene);

  explicit EdgeStage(std::shared_ptr<const CollisionScene> scene) : scene_(std::move(scene)) {}

  /// True if the stage answers what is asked: whether all pairs stay apart on the line, by more
  /// than nothing. Then what it calls free the search does, too, since it keeps the resolution.
  static bool maySettle(const MotionSettings& settings, const JointMotion& motion,
                        const PlacedBodies& placed);
  /// A search that the stage might have saved.
  void count(const MotionReport& report);
  bool isMade() const { return is_made_.load(std::memory_order_acquire); }
  /// If it is made.
  std::unique_ptr<BatchStage::EdgeGroup> makeGroup() const;

 private:
  const std::shared_ptr<const CollisionScene> scene_;
  std::atomic<std::uint64_t> work_{0};
  std::once_flag once_;
  std::unique_ptr<const BatchStage> stage_;
  std::atomic<bool> is_made_{false};
};

/// What the group has left open, with a clearance of APART.
std::vector<OpenPair> openPairsOf(const BatchStage::EdgeGroup& edge, const CollisionScene& scene,
                                  const MotionPairs& pairs);

}  // namespace collision_pairs
