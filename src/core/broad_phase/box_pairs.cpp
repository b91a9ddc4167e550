#include "box_pairs.h"

#include <algorithm>

namespace collision_pairs {
namespace {

constexpr int MAX_DIGIT_BITS = 14;

// One stable pass: by some bits of one of the two ids.
void scatterByDigit(const std::vector<BoxPair>& from, std::vector<BoxPair>* to,
                    std::uint32_t BoxPair::*id, int shift, int bits) {
  std::uint32_t places[1 << MAX_DIGIT_BITS];
  const std::uint32_t mask = (1u << bits) - 1u;
  std::fill_n(places, mask + 1, 0u);
  for (const BoxPair& pair : from) ++places[pair.*id >> shift & mask];
  std::uint32_t begin = 0;
  for (std::uint32_t digit = 0; digit <= mask; ++digit) {
    const std::uint32_t count = places[digit];
    places[digit] = begin;
    begin += count;
  }
  BoxPair* const out = to->data();
  for (const BoxPair& pair : from) out[places[pair.*id >> shift & mask]++] = pair;
}

int bitsOf(std::size_t value) {
  int bits = 1;
  while (bits < 32 && (value >> bits) != 0) ++bits;
  return bits;
}

}  // namespace

void sortPairs(std::vector<BoxPair>* pairs, std::size_t nb_ids, std::vector<BoxPair>* scratch) {
  constexpr std::size_t FEW = 64;
  if (pairs->size() <= FEW) {
    std::sort(pairs->begin(), pairs->end());
    return;
  }
  // Digits so large that a pass costs about as much for its counters as for its pairs.
  const int bits = bitsOf(nb_ids);
  const int largest = std::min(MAX_DIGIT_BITS, bitsOf(pairs->size()));
  const int passes = (bits + largest - 1) / largest;
  const int digit_bits = (bits + passes - 1) / passes;
  scratch->resize(pairs->size());
  for (std::uint32_t BoxPair::*id : {&BoxPair::second, &BoxPair::first}) {
    for (int pass = 0; pass < passes; ++pass) {
      scatterByDigit(*pairs, scratch, id, pass * digit_bits, digit_bits);
      pairs->swap(*scratch);
    }
  }
}

}  // namespace collision_pairs
