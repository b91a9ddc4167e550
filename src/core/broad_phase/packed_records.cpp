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

namespace {

/// The last box, so that a kernel can read 16 bytes past it.
struct LastBox {
  double sides[8] = {};
  explicit LastBox(const std::vector<Aabb>& boxes) {
    std::memcpy(sides, &boxes.back(), sizeof(Aabb));
  }
};

}  // namespace

void narrowBoxes(const SweepKernel& kernel, const NarrowMap& map, const std::vector<Aabb>& boxes,
                 const std::uint32_t* models, Record* out) {
  if (boxes.empty()) return;
  const auto last = static_cast<std::uint32_t>(boxes.size() - 1);
  kernel.narrow(map, boxes.data()->min.data(), models, 0, last, out);
  kernel.narrow(map, LastBox(boxes).sides, models + last, last, 1, out + last);
}

void PackedStorage::pack(const SweepKernel& kernel, const NarrowMap& map,
                         const std::vector<Aabb>& boxes) {
  resize(boxes.size());
  if (boxes.empty()) return;
  const auto last = static_cast<std::uint32_t>(boxes.size() - 1);
  kernel.pack(map, boxes.data()->min.data(), last, stride_, floats_.data());
  kernel.pack(map, LastBox(boxes).sides, 1, stride_, floats_.data() + last);
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
