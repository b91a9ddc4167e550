// The table that check_bag writes: CSV with one row per stamp; complete, or one part of several.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "collision_pairs/collision_report.h"
#include "tracks.h"

namespace collision_pairs {

/// Two links within the alarm distance of each other.
struct BagPair {
  std::string links;  ///< "a|b", a < b, each as listedName()
  double distance;    ///< metres, signed; of one that is unresolved a lower bound
  bool in_contact;    ///< or unresolved
};

struct BagRow {
  std::string bag;
  std::uint64_t state = 0;  ///< number of the stamp in its bag, from 0
  StampNs stamp = 0;
  std::vector<BagPair> pairs;  ///< sorted by name
  std::optional<double> min_distance;
  std::uint64_t nb_pairs = 0;         ///< investigated
  std::vector<std::string> left_out;  ///< each as listedName()
  Verdict verdict = Verdict::UNKNOWN;
};

/// Every count-th row is that of one part. Rows go round and round the parts, so that all have the
/// same amount of work wherever in a bag the robot is near something.
struct Shard {
  std::uint64_t index = 0;  ///< from 0
  std::uint64_t count = 1;
  bool owns(std::size_t bag, std::uint64_t state) const { return (state + bag) % count == index; }
};

/// bag,state,stamp,in_collision,pairs,min_distance,nb_pairs,distances,left_out,verdict
///
/// `verdict` is free, collision or unknown; `in_collision` is 0 if it is free. `pairs` are the
/// links in contact, "a|b;c|d"; `distances` all pairs within the alarm distance,
/// "a|b=0.012;c|d=-0.001"; `left_out` the links of which nothing was known, "a;b". Names in lists
/// are as listedName() writes them, and fields as csvField() does, so that a row is a line. Stamps
/// are seconds with nine decimals, numbers have all their digits. A part has, besides, lines that
/// begin with '#': which part it is, and at the beginning of each bag how many rows all parts
/// together have of it.
extern const char* const BAG_TABLE_HEADER;
extern const char* const BAG_TABLE_END;  ///< last line of a part

std::string toLine(const BagRow& row);
/// Throws InputError with the line number (and `name` of the file).
BagRow parseLine(const std::string& line, const std::string& name, std::size_t line_number);

std::string partLine(const Shard& shard);
std::string bagLine(const std::string& bag, std::uint64_t nb_rows);

/// Several tables as one: what one process would have written over all bags. `paths` are all parts
/// of one run, in any order, or whole tables, which follow each other in the given order. Every
/// row is handed over as it is written. Throws InputError if a part or a row is missing, or parts
/// of different runs are mixed. Memory: a row of each part.
using BagLineVisitor = std::function<void(const std::string& line, const BagRow& row)>;
void mergeBagTables(const std::vector<std::string>& paths, const BagLineVisitor& visit);

}  // namespace collision_pairs
