#include "collision_pairs/batch_check.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

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
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&](CollisionDetector& detector) {
    BodyPoses poses;
    poses.resize(scene_->bodies().size());
    try {
      for (std::size_t begin = next.fetch_add(BLOCK); begin < count;
           begin = next.fetch_add(BLOCK)) {
        for (std::size_t i = begin; i < std::min(begin + BLOCK, count); ++i) {
          pose(i, poses);
          take(i, detector.detect(poses, settings));
        }
      }
    } catch (...) {
      next = count;
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  const std::size_t nb_threads = std::min(detectors_.size(), (count + BLOCK - 1) / BLOCK);
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < nb_threads; ++i) {
    others.emplace_back([&work, this, i] { work(detectors_[i]); });
  }
  work(detectors_[0]);
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace collision_pairs
