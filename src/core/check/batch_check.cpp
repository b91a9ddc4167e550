#include "collision_pairs/batch_check.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "in_parallel.h"

namespace collision_pairs {
namespace {

constexpr std::size_t BLOCK = 16;  // states taken at a time: less than 0.1 ms of work, mostly

}  // namespace

BatchCheck::BatchCheck(std::shared_ptr<const CollisionScene> scene, unsigned threads)
    : scene_(std::move(scene)) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 0; i < threads; ++i) detectors_.emplace_back(scene_);
}

void BatchCheck::run(std::size_t count, const CheckSettings& settings, const Pose& pose,
                     const Take& take) {
  // Each thread of the loop is one detector, which takes blocks of states until none are left.
  std::atomic<std::size_t> next{0};
  const auto takeBlocks = [&](std::size_t thread) {
    BodyPoses poses;
    poses.resize(scene_->bodies().size());
    try {
      for (std::size_t begin = next.fetch_add(BLOCK); begin < count;
           begin = next.fetch_add(BLOCK)) {
        for (std::size_t i = begin; i < std::min(begin + BLOCK, count); ++i) {
          pose(i, poses);
          take(i, detectors_[thread].detect(poses, settings));
        }
      }
    } catch (...) {
      next = count;  // the others end too
      throw;
    }
  };
  inParallel(std::min(detectors_.size(), (count + BLOCK - 1) / BLOCK), takeBlocks);
}

}  // namespace collision_pairs
