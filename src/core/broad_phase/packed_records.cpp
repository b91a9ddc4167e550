#include "packed_records.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace collision_pairs {

static_assert(sizeof(Aabb) == 6 * sizeof(double) && sizeof(Record) == 32 &&
                  offsetof(Record, hi) == 12 && offsetof(Record, tag) == 24,
              "min and max, lo and hi follow one another, and then the tag");

NarrowMap makeNarrowMap(const Eigen::Vector3d& origin, double growth) {
  NarrowMap map{};
  for (int k = 0; k < 3; ++k) {
    map.grow[k] = -growth;
    map.grow[k + 3] = growth;
    map.origin[k] = map.origin[k + 3] = origin[k];
  }
  return map;
}

// The kernel reads 16 bytes past a box, which is past the end of the array for the last one.
void narrowBoxes(const SweepKernel& kernel, const NarrowMap& map, const std::vector<Aabb>& boxes,
                 const std::uint32_t* models, Record* out) {
  if (boxes.empty()) return;
  const auto last = static_cast<std::uint32_t>(boxes.size() - 1);
  kernel.narrow(map, boxes.data()->min.data(), models, 0, last, out);
  double padded[8] = {};
  std::memcpy(padded, &boxes[last], sizeof(Aabb));
  kernel.narrow(map, padded, models + last, last, 1, out + last);
}

Eigen::Vector3d sceneOrigin(const std::vector<Aabb>& boxes) {
  if (boxes.empty()) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d a = boxes.front().center();
  const Eigen::Vector3d b = boxes[boxes.size() / 2].center();
  const Eigen::Vector3d c = boxes.back().center();
  Eigen::Vector3d origin;
  for (int k = 0; k < 3; ++k) {
    const double median = std::max(std::min(a[k], b[k]), std::min(std::max(a[k], b[k]), c[k]));
    // The centre of a refused box (NaN) or of a half-space is no use as an origin.
    origin[k] = median > -1e150 && median < 1e150 ? median : 0.0;
  }
  return origin;
}

}  // namespace collision_pairs
