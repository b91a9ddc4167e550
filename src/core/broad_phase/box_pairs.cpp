#include "box_pairs.h"

#include <algorithm>

namespace collision_pairs {
namespace {

constexpr int MAX_DIGIT_BITS = 14;
constexpr std::size_t IN_CACHE = 65536;  // pairs, 512 KiB
constexpr std::size_t FEW = 64;          // up to here a comparison sort is as fast

/// Some bits of both ids as one number, the first id above the second.
struct Digit {
  int id_bits, shift;
  std::uint32_t mask;

  std::uint32_t operator()(const BoxPair& pair) const {
    const std::uint64_t both = std::uint64_t{pair.first} << id_bits | pair.second;
    return static_cast<std::uint32_t>(both >> shift) & mask;
  }
};

/// Number of pairs with each value of a digit, then the position of the next one with that value.
struct Places {
  std::uint32_t of[1 << MAX_DIGIT_BITS];

  void clear(const Digit& digit) { std::fill_n(of, digit.mask + 1, 0u); }
  void count(const BoxPair* pairs, std::size_t nb_pairs, const Digit& digit) {
    clear(digit);
    for (std::size_t i = 0; i < nb_pairs; ++i) ++of[digit(pairs[i])];
  }
  void addUp(const Digit& digit) {
    std::uint32_t begin = 0;
    for (std::uint32_t value = 0; value <= digit.mask; ++value) {
      const std::uint32_t nb_pairs = of[value];
      of[value] = begin;
      begin += nb_pairs;
    }
  }
};

int bitsOf(std::size_t value) {
  int bits = 1;
  while (bits < 32 && (value >> bits) != 0) ++bits;
  return bits;
}

// Stable passes over the lowest bits of both ids, least significant digit first; each also counts
// the next pass's digit. The result is in `to` after an odd number of passes, else in `from`.
void sortByLowBits(BoxPair* from, BoxPair* to, std::size_t nb_pairs, int id_bits, int bits,
                   int passes) {
  const int digit_bits = (bits + passes - 1) / passes;
  Places places[2];
  Digit digit{id_bits, 0, (1u << digit_bits) - 1u};
  places[0].count(from, nb_pairs, digit);
  for (int pass = 0; pass < passes; ++pass) {
    const Digit next{id_bits, std::min(pass + 1, passes - 1) * digit_bits, digit.mask};
    places[pass % 2].addUp(digit);
    places[(pass + 1) % 2].clear(next);
    const Digit this_digit = digit;
    std::uint32_t* const place_of = places[pass % 2].of;
    std::uint32_t* const count_of = places[(pass + 1) % 2].of;
    for (std::size_t i = 0; i < nb_pairs; ++i) {
      const BoxPair pair = from[i];
      ++count_of[next(pair)];
      to[place_of[this_digit(pair)]++] = pair;
    }
    digit = next;
    std::swap(from, to);
  }
}

// Splits by the highest bits into parts that fit the L1 cache, where the passes are fast.
void sortInParts(BoxPair* pairs, BoxPair* scratch, std::size_t nb_pairs, int id_bits) {
  constexpr std::size_t PART = 2048;
  constexpr int MAX_TOP_BITS = 10, LOW_DIGIT_BITS = 10;
  const int bits = 2 * id_bits;
  const int top_bits = std::min({MAX_TOP_BITS, bitsOf(nb_pairs / PART), bits - 1});
  const Digit top{id_bits, bits - top_bits, (1u << top_bits) - 1u};
  Places places;
  places.count(pairs, nb_pairs, top);
  places.addUp(top);
  for (std::size_t i = 0; i < nb_pairs; ++i) scratch[places.of[top(pairs[i])]++] = pairs[i];
  const int low_bits = bits - top_bits;
  const int passes = (low_bits + LOW_DIGIT_BITS - 1) / LOW_DIGIT_BITS | 1;  // odd
  std::size_t begin = 0;
  for (std::uint32_t value = 0; value <= top.mask; ++value) {
    const std::size_t end = places.of[value], nb_in_part = end - begin;
    if (nb_in_part > FEW) {
      sortByLowBits(scratch + begin, pairs + begin, nb_in_part, id_bits, low_bits, passes);
    } else {
      std::sort(scratch + begin, scratch + end);
      std::copy(scratch + begin, scratch + end, pairs + begin);
    }
    begin = end;
  }
}

}  // namespace

void sortPairs(std::vector<BoxPair>* pairs, std::size_t nb_ids, std::vector<BoxPair>* scratch) {
  if (pairs->size() <= FEW) {
    std::sort(pairs->begin(), pairs->end());
    return;
  }
  const int id_bits = bitsOf(nb_ids);
  scratch->resize(pairs->size());
  // Digits so large that the counters of a pass cost about as much as its pairs.
  const int largest = std::min(MAX_DIGIT_BITS, bitsOf(pairs->size()));
  const int passes = (2 * id_bits + largest - 1) / largest;
  if (passes > 2 && pairs->size() > IN_CACHE) {
    sortInParts(pairs->data(), scratch->data(), pairs->size(), id_bits);
    return;
  }
  sortByLowBits(pairs->data(), scratch->data(), pairs->size(), id_bits, 2 * id_bits, passes);
  if (passes % 2 != 0) pairs->swap(*scratch);
}

}  // namespace collision_pairs
