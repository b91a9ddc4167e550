#include "collision_pairs/pair_filter.h"

#include <algorithm>
#include <numeric>

namespace collision_pairs {

PairFilter::PairFilter(std::vector<std::uint32_t> classes) : classes_(std::move(classes)) {
  for (const std::uint32_t c : classes_) nb_classes_ = std::max<std::size_t>(nb_classes_, c + 1);
  words_ = (nb_classes_ + 63) / 64;
  bits_.assign(nb_classes_ * words_, ~std::uint64_t{0});
}

PairFilter PairFilter::allowAll(std::size_t nb_models) {
  std::vector<std::uint32_t> classes(nb_models);
  std::iota(classes.begin(), classes.end(), 0u);
  return PairFilter(std::move(classes));
}

void PairFilter::setClassPair(std::uint32_t class_a, std::uint32_t class_b, bool allowed) {
  const auto set = [&](std::uint32_t r, std::uint32_t c) {
    std::uint64_t& word = bits_[r * words_ + (c >> 6)];
    const std::uint64_t bit = std::uint64_t{1} << (c & 63);
    word = allowed ? word | bit : word & ~bit;
  };
  set(class_a, class_b);
  set(class_b, class_a);
}

}  // namespace collision_pairs
