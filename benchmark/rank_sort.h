// A sort for a trial: few boxes along the axis on which they vary most.
#pragma once

#include <cstdint>
#include <vector>

#include "packed_records.h"

namespace collision_pairs {

/// The records in the order of their lower ends on the axis on which their corners vary most, and
/// where the row of each ends: after the last whose lower end is not beyond its upper end. Keeps
/// its memory.
class RankSort {
 public:
  /// For 16, 8 or 4 lanes: the machine must have AVX-512, AVX2, or nothing.
  explicit RankSort(std::size_t lanes) : lanes_(lanes) {}
  void sort(const std::vector<Record>& records, std::uint32_t count, PackedStorage* packed,
            std::vector<std::uint32_t>* row_end);

 private:
  std::size_t lanes_;
  std::vector<float> lower_, upper_;
  std::vector<std::int32_t> rank_, last_;
  std::vector<std::uint32_t> taken_;
};

}  // namespace collision_pairs
