// Outputs of a table: file or standard output, report page, summary.
#pragma once

#include <functional>
#include <string>

#include "bag_table.h"

namespace collision_pairs {

struct BagOutputOptions {
  std::string out;     ///< empty: standard output, unless there is a report or `quiet`
  std::string report;  ///< folder; empty: none
  bool quiet = false;  ///< no table on standard output
  double alarm_distance = 0.05;
  double max_gap = 1.0;
};

/// Of --max-gap. Throws InputError unless it is finite and at least a nanosecond.
void requireGap(double seconds);

/// Receives a line of the table and its row (null for comment lines of parts).
using BagLineSink = std::function<void(const std::string& line, const BagRow* row)>;

/// Runs `produce`, which passes all lines except the header. On success, moves the table into
/// place, creates the page, and prints the summary to standard output, or to standard error if the
/// table is written there.
void writeBagOutputs(const BagOutputOptions& options,
                     const std::function<void(const BagLineSink&)>& produce);

}  // namespace collision_pairs
