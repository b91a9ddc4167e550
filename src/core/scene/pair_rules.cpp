#include "collision_pairs/pair_rules.h"

#include <fnmatch.h>

namespace collision_pairs {

bool isPattern(const NamePattern& pattern) { return pattern.find_first_of("*?[") != pattern.npos; }

bool matches(const NamePattern& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

}  // namespace collision_pairs
