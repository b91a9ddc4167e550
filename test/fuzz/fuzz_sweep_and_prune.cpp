// libFuzzer target: raw bytes as boxes. Each path through the sweep must find what looking at
// every pair finds, refuse what is unsound, and never read what it should not.
//   byte 0: how many boxes are static; byte 1: models, filter and alarm distance;
//   then 8 bytes of alarm distance if asked for, and 48 bytes a box.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "broad_phase_oracle.h"

namespace collision_pairs {
namespace {

constexpr std::size_t MOST_BOXES = 96;
constexpr std::size_t MANY_STATIC = 600;

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  template <class T>
  bool take(T* value) {
    if (size_ < sizeof(T)) return false;
    std::memcpy(value, data_, sizeof(T));
    data_ += sizeof(T);
    size_ -= sizeof(T);
    return true;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

// Static boxes must be sound, so the unsound ones of them are repaired here.
void repair(Aabb* box) {
  for (int k = 0; k < 3; ++k) {
    if (!(box->min[k] <= box->max[k])) std::swap(box->min[k], box->max[k]);
  }
  if (!box->valid()) *box = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()};
}

// So many static boxes that they are asked by their tree, which few are not: copies of those given.
void repeatStatic(BroadPhaseScene* scene) {
  if (scene->nb_static == 0) return;
  const std::size_t given = scene->nb_static;
  std::vector<Aabb> boxes;
  std::vector<std::uint32_t> models;
  for (std::size_t i = 0; i < MANY_STATIC; ++i) {
    boxes.push_back(scene->boxes[i % given]);
    models.push_back(scene->models[i % given]);
  }
  scene->boxes.insert(scene->boxes.begin(), boxes.begin(), boxes.end());
  scene->models.insert(scene->models.begin(), models.begin(), models.end());
  scene->nb_static += MANY_STATIC;
}

BroadPhaseScene readScene(const std::uint8_t* data, std::size_t size, PairFilter* filter) {
  BroadPhaseScene scene;
  Bytes bytes(data, size);
  std::uint8_t nb_static = 0, flags = 0;
  bytes.take(&nb_static);
  bytes.take(&flags);
  if (flags & 1) bytes.take(&scene.alarm_distance);
  if (!(scene.alarm_distance >= 0.0 && scene.alarm_distance <= 1e150)) scene.alarm_distance = 0.1;
  if (flags & 2) scene.filter = filter;
  Aabb box;
  while (scene.boxes.size() < MOST_BOXES && bytes.take(&box)) scene.add(box);
  if (flags & 6) {
    for (std::uint32_t& model : scene.models) model %= 8;
  }
  scene.nb_static = std::min<std::size_t>(nb_static, scene.boxes.size());
  for (std::size_t i = 0; i < scene.nb_static; ++i) repair(&scene.boxes[i]);
  if (flags & 8) repeatStatic(&scene);
  return scene;
}

void check(bool claim, const char* what) {
  if (claim) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

}  // namespace
}  // namespace collision_pairs

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace collision_pairs;
  PairFilter filter = PairFilter::allowAll(8);
  for (std::uint32_t a = 0; a < 8; ++a) filter.setClassPair(a, (a * 3) % 8, false);
  const BroadPhaseScene scene = readScene(data, size, &filter);
  const std::vector<BoxPair> expected = pairsByBruteForce(scene);
  for (const SweepTuning& tuning : allPaths()) {
    if (tuning.threads > 1) continue;
    SweepAndPrune sweep(tuning);
    check(pairsBySweep(scene, &sweep) == expected, "the pairs differ from brute force");
    std::size_t nb_unsound = 0;
    for (const Aabb& box : scene.boxes) nb_unsound += !box.valid();
    check(sweep.refused().size() == nb_unsound, "refused boxes are not the unsound ones");
    check(sweep.axis() >= 0 && sweep.axis() < 3, "no such axis");
  }
  return 0;
}
