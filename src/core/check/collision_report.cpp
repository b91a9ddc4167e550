#include "collision_pairs/collision_report.h"

#include <array>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

constexpr std::array<const char*, 4> FIDELITY_NAMES = {"aabb", "obb", "convex", "mesh"};

}  // namespace

const char* fidelityName(Fidelity fidelity) { return FIDELITY_NAMES[static_cast<int>(fidelity)]; }

Fidelity parseFidelity(const std::string& name) {
  for (std::size_t i = 0; i < FIDELITY_NAMES.size(); ++i) {
    if (name == FIDELITY_NAMES[i]) return static_cast<Fidelity>(i);
  }
  throw InputError("unknown fidelity '" + name + "'; known are aabb, obb, convex and mesh");
}

}  // namespace collision_pairs
