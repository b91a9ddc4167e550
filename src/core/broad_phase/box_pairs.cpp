#include "box_pairs.h"

#include <algorithm>

namespace collision_pairs {
namespace {

constexpr int MAX_DIGIT_BITS = 14;
constexpr std::size_t FEW = 64;  // up to here a comparison sort is as fast

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

/// Passes of digits so large that the counters of one cost about as much as its pairs.
int passesFor(int bits, std::size_t nb_pairs) {
  const int largest = std::min(MAX_DIGIT_BITS, bitsOf(nb_pairs));
  return (bits + largest - 1) / largest;
}

}  // namespace

void PairSorter::sort(const SweepKernel& kernel, std::size_t nb_ids, std::vector<BoxPair>* pairs) {
  const std::size_t nb_pairs = pairs->size();
  if (nb_pairs <= FEW) {
    std::sort(pairs->begin(), pairs->end());
  } else if (nb_pairs < 2 * nb_ids) {
    const int id_bits = bitsOf(nb_ids);
    const int passes = passesFor(2 * id_bits, nb_pairs);
    scratch_.resize(nb_pairs);
    sortByLowBits(pairs->data(), scratch_.data(), nb_pairs, id_bits, 2 * id_bits, passes);
    if (passes % 2 != 0) pairs->swap(scratch_);
  } else {
    fillRows(nb_ids, pairs);
    pairs->resize(nb_pairs + 1);
    kernel.sortRows(seconds_.data(), row_ends_.data(), nb_ids, &pairs->data()->first);
    pairs->resize(nb_pairs);
    if (longest_row_ > LONGEST_ROW) sortLongRows(pairs);
  }
}

// Counting sort by the first ids. The pairs come by cells of the grid, whose few rows stay in a
// cache while it is done.
void PairSorter::fillRows(std::size_t nb_ids, std::vector<BoxPair>* pairs) {
  constexpr std::size_t AHEAD = 16;
  const std::size_t nb_pairs = pairs->size();
  row_ends_.assign(nb_ids, 0);
  std::uint32_t* const ends = row_ends_.data();
  for (const BoxPair& pair : *pairs) ++ends[pair.first];
  std::uint32_t begin = 0;
  longest_row_ = 0;
  for (std::size_t id = 0; id < nb_ids; ++id) {
    const std::uint32_t in_row = ends[id];
    longest_row_ = std::max(longest_row_, in_row);
    ends[id] = begin;
    begin += in_row;
  }
  if (seconds_.size() < nb_pairs + PADDING) seconds_.resize(nb_pairs + nb_pairs / 4 + PADDING);
  std::uint32_t* const seconds = seconds_.data();
  pairs->resize(nb_pairs + AHEAD);
  const BoxPair* const from = pairs->data();
  for (std::size_t i = 0; i < nb_pairs; ++i) {
    __builtin_prefetch(seconds + ends[from[i + AHEAD].first], 1);
    seconds[ends[from[i].first]++] = from[i].second;
  }
}

void PairSorter::sortLongRows(std::vector<BoxPair>* pairs) {
  const int id_bits = bitsOf(row_ends_.size());
  std::uint32_t begin = 0;
  for (std::uint32_t id = 0; id < row_ends_.size(); ++id) {
    const std::uint32_t end = row_ends_[id];
    if (end - begin > LONGEST_ROW) {
      scratch_.clear();
      for (std::uint32_t i = begin; i < end; ++i) scratch_.push_back({id, seconds_[i]});
      const int passes =
          passesFor(id_bits, scratch_.size()) | 1;  // odd: the last one ends in pairs
      sortByLowBits(scratch_.data(), pairs->data() + begin, scratch_.size(), id_bits, id_bits,
                    passes);
    }
    begin = end;
  }
}

}  // namespace collision_pairs
