// Many segments, on all cores.
#include <mutex>

#include "collision_pairs/input_error.h"
#include "collision_pairs/motion_check.h"
#include "in_parallel.h"

namespace collision_pairs {

std::vector<MotionReport> checkSegments(const std::shared_ptr<const CollisionScene>& scene,
                                        const std::vector<std::vector<double>>& waypoints,
                                        const MotionSettings& settings,
                                        const SegmentOptions& options) {
  std::vector<MotionReport> reports(waypoints.empty() ? 0 : waypoints.size() - 1);
  const std::size_t threads = nbThreads(options.threads, reports.size());
  std::vector<MotionCheck> checks;
  for (std::size_t i = 0; i < threads; ++i) checks.emplace_back(scene);
  std::mutex mutex;
  std::size_t nb_done = 0;
  inParallel(threads, reports.size(), [&](std::size_t thread, std::size_t i) {
    try {
      reports[i] = checks[thread].check({waypoints[i], waypoints[i + 1]}, settings, options.placed,
                                        options.voxels, options.unknown_because);
    } catch (const InputError& error) {
      throw InputError("segment " + std::to_string(i) + ": " + error.what());
    }
    const std::lock_guard<std::mutex> lock(mutex);
    if (options.done) options.done(++nb_done);
  });
  return reports;
}

}  // namespace collision_pairs
