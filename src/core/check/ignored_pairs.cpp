#include "ignored_pairs.h"

#include <algorithm>

namespace collision_pairs {
namespace {

constexpr std::size_t FIRST_SIZE = 64;

std::size_t hashOf(const IgnoredPairs::Pair& pair) {
  const std::uint64_t key = std::uint64_t{pair.first} << 32 | pair.second;
  return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> 20);
}

}  // namespace

bool IgnoredPairs::has(std::uint32_t model_a, std::uint32_t model_b) {
  if (!may_ignore_) return false;
  const Pair pair = std::minmax(model_a, model_b);
  if (answers_.size() < 2 * (nb_answers_ + 1)) grow();
  if (const Answer& known = find(pair); known.check == check_) return known.is_ignored;
  const bool is_ignored = (*may_ignore_)(pair.first, pair.second);
  find(pair) = {pair, check_, is_ignored};
  ++nb_answers_;
  return is_ignored;
}

IgnoredPairs::Answer& IgnoredPairs::find(const Pair& pair) {
  std::size_t i = hashOf(pair) & (answers_.size() - 1);
  while (answers_[i].check == check_ && answers_[i].pair != pair) {
    i = (i + 1) & (answers_.size() - 1);
  }
  return answers_[i];
}

void IgnoredPairs::grow() {
  std::vector<Answer> before(std::max(FIRST_SIZE, 2 * answers_.size()));
  before.swap(answers_);
  for (const Answer& answer : before) {
    if (answer.check == check_) find(answer.pair) = answer;
  }
}

void IgnoredPairs::list(std::vector<Pair>& pairs) const {
  pairs.clear();
  if (nb_answers_ == 0) return;
  for (const Answer& answer : answers_) {
    if (answer.check == check_ && answer.is_ignored) pairs.push_back(answer.pair);
  }
  std::sort(pairs.begin(), pairs.end());
}

bool allowsMoreThan(const std::vector<IgnoredPairs::Pair>& ignored, const CollisionScene& scene,
                    const PairFilter& filter) {
  const auto& models = scene.models();
  for (std::uint32_t a = 0; a < models.size(); ++a) {
    if (models[a].body < 0) continue;  // one of two moves
    for (std::uint32_t b = 0; b < models.size(); ++b) {
      if (!filter.allowed(a, b)) continue;
      const IgnoredPairs::Pair pair = std::minmax(a, b);
      if (!std::binary_search(ignored.begin(), ignored.end(), pair)) return true;
    }
  }
  return false;
}

}  // namespace collision_pairs
