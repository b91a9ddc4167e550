#include "rank_sort.h"

#include <cstring>

namespace collision_pairs {
namespace {

// In the compiler's own terms: one register each, or two of the base target for a record.
typedef float Floats4 __attribute__((vector_size(16)));
typedef std::int32_t Ints4 __attribute__((vector_size(16)));
typedef float Floats8 __attribute__((vector_size(32)));
typedef std::int32_t Ints8 __attribute__((vector_size(32)));
typedef float Floats16 __attribute__((vector_size(64)));
typedef std::int32_t Ints16 __attribute__((vector_size(64)));
constexpr std::size_t MOST_LANES = 16;

// One pass: relative to an origin amid the boxes little cancels, and any axis is right.
inline __attribute__((always_inline)) int axisOf(const Record* records, std::uint32_t count) {
  const Ints8 sides = {-1, -1, -1, -1, -1, -1, 0, 0};
  Floats8 sum{}, square{};
  for (std::uint32_t i = 0; i < count; ++i) {
    Ints8 bits;
    std::memcpy(&bits, static_cast<const void*>(records + i), sizeof bits);
    bits &= sides;  // a tag is no number
    Floats8 x;
    std::memcpy(&x, &bits, sizeof x);
    sum += x;
    square += x * x;
  }
  int widest = 0;
  float most = -1.0f;
  for (int k = 0; k < 3; ++k) {
    const float mean = (sum[k] + sum[k + 3]) / static_cast<float>(2 * count);
    const float variance = square[k] + square[k + 3] - static_cast<float>(2 * count) * mean * mean;
    if (variance > most) {
      most = variance;
      widest = k;
    }
  }
  return widest;
}

// Each lane counts for one box: the lower ends below its own, and those up to its upper end.
template <class Floats, class Ints>
inline __attribute__((always_inline)) void rank(const float* lower, const float* upper,
                                                std::uint32_t count, std::int32_t* below,
                                                std::int32_t* up_to) {
  for (std::uint32_t i = 0; i < count; i += sizeof(Floats) / sizeof(float)) {
    Floats lo, hi;
    std::memcpy(&lo, lower + i, sizeof lo);
    std::memcpy(&hi, upper + i, sizeof hi);
    Ints nb_below{}, nb_up_to{};
    for (std::uint32_t j = 0; j < count; ++j) {
      const Floats other = Floats{} + lower[j];
      nb_below -= other < lo;
      nb_up_to -= other <= hi;
    }
    std::memcpy(below + i, &nb_below, sizeof nb_below);
    std::memcpy(up_to + i, &nb_up_to, sizeof nb_up_to);
  }
}

#define COLLISION_PAIRS_RANK(LANES, TARGET)                                              \
  TARGET int axisBy##LANES(const Record* records, std::uint32_t count) {                 \
    return axisOf(records, count);                                                       \
  }                                                                                      \
  TARGET void rankBy##LANES(const float* lower, const float* upper, std::uint32_t count, \
                            std::int32_t* below, std::int32_t* up_to) {                  \
    rank<Floats##LANES, Ints##LANES>(lower, upper, count, below, up_to);                 \
  }
COLLISION_PAIRS_RANK(4, )
#ifdef __x86_64__
COLLISION_PAIRS_RANK(8, __attribute__((target("avx2,fma"))))
COLLISION_PAIRS_RANK(16, __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw"))))
#else
COLLISION_PAIRS_RANK(8, )
COLLISION_PAIRS_RANK(16, )
#endif

}  // namespace

void RankSort::sort(const std::vector<Record>& records, std::uint32_t count, PackedStorage* packed,
                    std::vector<std::uint32_t>* row_end) {
  const auto axis_of = lanes_ == 16 ? axisBy16 : lanes_ == 8 ? axisBy8 : axisBy4;
  const auto rank_of = lanes_ == 16 ? rankBy16 : lanes_ == 8 ? rankBy8 : rankBy4;
  const int axis = axis_of(records.data(), count);
  if (lower_.size() < count + MOST_LANES) {
    for (auto* ends : {&lower_, &upper_}) ends->resize(2 * count + MOST_LANES);
    for (auto* ranks : {&rank_, &last_}) ranks->resize(2 * count + MOST_LANES);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    lower_[i] = records[i].lo[axis];
    upper_[i] = records[i].hi[axis];
  }
  rank_of(lower_.data(), upper_.data(), count, rank_.data(), last_.data());
  packed->resize(count);
  row_end->resize(count);
  taken_.assign(count, 0);
  const PackedStorage::Writer write = packed->writer();
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(rank_[i]);
    const std::uint32_t place = first + taken_[first]++;  // those with the same lower end
    write(place, records[i]);
    (*row_end)[place] = static_cast<std::uint32_t>(last_[i]);
  }
}

}  // namespace collision_pairs
