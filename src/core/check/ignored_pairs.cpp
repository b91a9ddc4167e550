#include "ignored_pairs.h"

#include <algorithm>

namespace collision_pairs {
namespace {

constexpr std::size_t FIRST_SIZE = 64;

std::size_t hashOf(const IgnoredPairs::Pair& pair) {
  const std::uint64_t key = std::uint64_t{pair.first} << 32 | pair.second;
  return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> 32);  // bits that both reach
}

}  // namespace

void IgnoredPairs::begin(const MayIgnore& may_ignore, std::uint64_t revision) {
  may_ignore_ = may_ignore ? &may_ignore : nullptr;
  ++check_;
  keeps_some_ = false;
  left_out_.clear();
  const bool is_same = revision == std::exchange(revision_, revision);
  if (revision != 0 && is_same) return;
  ++asking_;
  nb_answers_ = 0;
}

bool IgnoredPairs::has(std::uint32_t model_a, std::uint32_t model_b) {
  if (!may_ignore_) return false;
  const Pair pair = std::minmax(model_a, model_b);
  if (answers_.size() < 2 * (nb_answers_ + 1)) grow();
  Answer& known = find(pair);
  if (known.asked_in != asking_) {
    const bool is_ignored = (*may_ignore_)(pair.first, pair.second);  // may throw
    known = {pair, asking_, 0, is_ignored};
    ++nb_answers_;
  }
  if (known.is_ignored && known.met_in != check_) left_out_.push_back(pair);
  known.met_in = check_;
  keeps_some_ = keeps_some_ || !known.is_ignored;
  return known.is_ignored;
}

IgnoredPairs::Answer& IgnoredPairs::find(const Pair& pair) {
  std::size_t i = hashOf(pair) & (answers_.size() - 1);
  while (answers_[i].asked_in == asking_ && answers_[i].pair != pair) {
    i = (i + 1) & (answers_.size() - 1);
  }
  return answers_[i];
}

void IgnoredPairs::grow() {
  std::vector<Answer> before(std::max(FIRST_SIZE, 2 * answers_.size()));
  before.swap(answers_);
  for (const Answer& answer : before) {
    if (answer.asked_in == asking_) find(answer.pair) = answer;
  }
}

const std::vector<IgnoredPairs::Pair>& IgnoredPairs::list() {
  if (!std::is_sorted(left_out_.begin(), left_out_.end())) {
    std::sort(left_out_.begin(), left_out_.end());
  }
  return left_out_;
}

}  // namespace collision_pairs
