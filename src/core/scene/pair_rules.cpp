#include "collision_pairs/pair_rules.h"

#include <fnmatch.h>

namespace collision_pairs {

bool isPattern(const NamePattern& pattern) { return pattern.find_first_of("*?[") != pattern.npos; }

bool matches(const NamePattern& pattern, const std::string& name) {
  if (pattern == name) return true;  // also "box[1]", which as a pattern means "box1"
  return isPattern(pattern) && fnmatch(pattern.c_str(), name.c_str(), FNM_NOESCAPE) == 0;
}

}  // namespace collision_pairs
