#include "collision_pairs/scene_settings.h"

#include <array>

#include <fnmatch.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

constexpr std::array<const char*, 5> FIDELITY_NAMES = {"aabb", "spheres", "obb", "convex", "mesh"};

}  // namespace

const char* fidelityName(Fidelity fidelity) { return FIDELITY_NAMES[static_cast<int>(fidelity)]; }

Fidelity parseFidelity(const std::string& name) {
  for (std::size_t i = 0; i < FIDELITY_NAMES.size(); ++i) {
    if (name == FIDELITY_NAMES[i]) return static_cast<Fidelity>(i);
  }
  throw InputError("unknown fidelity '" + name +
                   "'; known are aabb, spheres, obb, convex and mesh");
}

bool isPattern(const NamePattern& pattern) { return pattern.find_first_of("*?[") != pattern.npos; }

bool matches(const NamePattern& pattern, const std::string& name) {
  if (pattern == name) return true;  // also "box[1]", which as a pattern matches "box1"
  return isPattern(pattern) && fnmatch(pattern.c_str(), name.c_str(), FNM_NOESCAPE) == 0;
}

}  // namespace collision_pairs
