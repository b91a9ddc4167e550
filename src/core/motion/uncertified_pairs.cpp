#include "uncertified_pairs.h"

#include <algorithm>

#include "unknown_because.h"

namespace collision_pairs {

void UncertifiedPairs::clear() {
  models_.clear();
  beside_static_noted_.assign(scene_.elements().size(), 0);
}

void UncertifiedPairs::note(const BoxPair& pair, bool one_will_do) {
  const std::uint32_t model = scene_.elements()[pair.first].model;
  if (pair.second != ALL_STATIC) {
    models_.insert(std::minmax(model, scene_.elements()[pair.second].model));
  } else if (std::exchange(beside_static_noted_[pair.first], 1) == 0) {
    for (std::uint32_t other = 0; other < scene_.models().size(); ++other) {
      if (one_will_do && !models_.empty()) return;
      if (pairs_.static_pairs.allowed(model, other)) models_.insert(std::minmax(model, other));
    }
  }
}

std::vector<std::string> UncertifiedPairs::names() const {
  std::vector<std::string> names;
  for (const auto& [first, second] : models_) names.push_back(pairName(scene_, first, second));
  return names;
}

}  // namespace collision_pairs
