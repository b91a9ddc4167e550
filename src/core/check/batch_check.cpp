#include "collision_pairs/batch_check.h"

#include <algorithm>
#include <limits>

#include "in_parallel.h"

namespace collision_pairs {
namespace {

constexpr std::size_t BLOCK = 16;  // states taken at a time: less than 0.1 ms of work, mostly

}  // namespace

BatchCheck::BatchCheck(std::shared_ptr<const CollisionScene> scene, unsigned threads)
    : scene_(std::move(scene)) {
  const std::size_t nb_detectors = nbThreads(threads, std::numeric_limits<std::size_t>::max());
  for (std::size_t i = 0; i < nb_detectors; ++i) detectors_.emplace_back(scene_);
}

void BatchCheck::run(std::size_t count, const CheckSettings& settings, const Pose& pose,
                     const Take& take) {
  std::vector<BodyPoses> poses(detectors_.size());
  for (BodyPoses& of_thread : poses) of_thread.resize(scene_->bodies().size());
  const std::size_t nb_blocks = count / BLOCK + (count % BLOCK > 0);
  inParallel(detectors_.size(), nb_blocks, [&](std::size_t thread, std::size_t block) {
    const std::size_t begin = block * BLOCK, end = std::min(begin + BLOCK, count);
    for (std::size_t i = begin; i < end; ++i) {
      pose(i, poses[thread]);
      take(i, detectors_[thread].detect(poses[thread], settings));
    }
  });
}

}  // namespace collision_pairs
