#include "pair_sort.h"

#include <algorithm>

namespace collision_pairs {
namespace {

constexpr int MAX_DIGIT_BITS = 11;

void scatterByDigit(const std::vector<BoxPair>& from, std::vector<BoxPair>* to, int shift,
                    int bits) {
  std::uint32_t places[1 << MAX_DIGIT_BITS] = {};
  const std::uint32_t mask = (1u << bits) - 1u;
  for (const BoxPair& pair : from) ++places[pair.first >> shift & mask];
  std::uint32_t begin = 0;
  for (std::uint32_t digit = 0; digit <= mask; ++digit) {
    const std::uint32_t count = places[digit];
    places[digit] = begin;
    begin += count;
  }
  for (const BoxPair& pair : from) (*to)[places[pair.first >> shift & mask]++] = pair;
}

// Pairs with one first id: most often one to ten of them.
void sortBySecond(BoxPair* begin, BoxPair* end) {
  constexpr std::ptrdiff_t FEW = 24;
  const auto less = [](const BoxPair& a, const BoxPair& b) { return a.second < b.second; };
  if (end - begin > FEW) {
    std::sort(begin, end, less);
    return;
  }
  for (BoxPair* next = begin + 1; next < end; ++next) {
    const BoxPair pair = *next;
    BoxPair* hole = next;
    for (; hole > begin && less(pair, hole[-1]); --hole) *hole = hole[-1];
    *hole = pair;
  }
}

}  // namespace

void sortPairs(std::vector<BoxPair>* pairs, std::size_t nb_ids, std::vector<BoxPair>* scratch) {
  constexpr std::size_t FEW = 64;
  if (pairs->size() <= FEW) {
    std::sort(pairs->begin(), pairs->end());
    return;
  }
  int bits = 1;
  while (bits < 32 && (nb_ids >> bits) != 0) ++bits;
  const int passes = (bits + MAX_DIGIT_BITS - 1) / MAX_DIGIT_BITS;
  const int digit_bits = (bits + passes - 1) / passes;
  scratch->resize(pairs->size());
  for (int pass = 0; pass < passes; ++pass) {
    scatterByDigit(*pairs, scratch, pass * digit_bits, digit_bits);
    pairs->swap(*scratch);
  }
  BoxPair* const end = pairs->data() + pairs->size();
  for (BoxPair* begin = pairs->data(); begin < end;) {
    BoxPair* next = begin + 1;
    while (next < end && next->first == begin->first) ++next;
    if (next - begin > 1) sortBySecond(begin, next);
    begin = next;
  }
}

}  // namespace collision_pairs
