// Preloaded into a program that loads the nodelet, makes calls of it fail that no input makes fail:
//   FAILING_RUNS=N     the node's loop throws the first N times that it is entered
//   FAILING_DRAWING=1  the markers of a report are never made
#include <atomic>
#include <cstdlib>
#include <stdexcept>

#include <dlfcn.h>

#include "collision_pairs_node.h"

namespace collision_pairs {
namespace {

int wanted(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? std::atoi(value) : 0;
}

}  // namespace

void CollisionPairsNode::run() {
  static std::atomic<int> failures_left{wanted("FAILING_RUNS")};
  if (failures_left-- > 0) throw std::runtime_error("run() fails on purpose");
  using Run = void (*)(CollisionPairsNode*);  // as compilers call a member that is not virtual
  void* const nodelet = dlopen("libcollision_pairs_nodelet.so", RTLD_LAZY | RTLD_NOLOAD);
  if (!nodelet) std::abort();
  const auto its = dlsym(nodelet, "_ZN15collision_pairs18CollisionPairsNode3runEv");
  if (!its || its == dlsym(RTLD_DEFAULT, "_ZN15collision_pairs18CollisionPairsNode3runEv")) {
    std::abort();
  }
  reinterpret_cast<Run>(its)(this);
}

void ReportPublisher::publishMarkers(const CollisionPairs&, const CollisionReport*, bool,
                                     const std::optional<ShownLimit>&, double) {
  if (wanted("FAILING_DRAWING") > 0) throw std::runtime_error("drawing fails on purpose");
}

}  // namespace collision_pairs
