// The table that check_bag writes: CSV with one row per stamp; complete, or one part of several.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "collision_pairs/collision_report.h"
#include "stamps.h"

namespace collision_pairs {

/// Two links within the alarm distance of each other.
struct BagPair {
  std::string links;  ///< "a|b", a < b, each as listedName()
  double distance;    ///< metres, signed; a lower bound if unresolved
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
  std::string unknown_because;  ///< in words, on one line
};

/// Rows are distributed round-robin over `count` parts, so that all parts have the same amount of
/// work wherever in a bag the robot is near something.
struct Shard {
  std::uint64_t index = 0;  ///< from 0
  std::uint64_t count = 1;
  bool owns(std::size_t bag, std::uint64_t state) const { return (state + bag) % count == index; }
};

/// bag,state,stamp,in_collision,pairs,min_distance,nb_pairs,distances,left_out,verdict,unknown_because
///
/// `verdict` is free, collision or unknown; `in_collision` is 0 if it is free. `pairs` are the
/// links in contact, "a|b;c|d"; `distances` all pairs within the alarm distance,
/// "a|b=0.012;c|d=-0.001"; `left_out` the links without a pose, "a;b"; `unknown_because` the
/// reasons of an unknown verdict. Names in lists are written by listedName() and fields by
/// csvField(), so that a row is a line. Stamps are seconds with nine decimals, numbers have all
/// their digits. A part also has lines that begin with '#': which part it is and its options, and
/// after the rows of each bag their number in all parts together.
extern const char* const BAG_TABLE_HEADER;
extern const char* const BAG_TABLE_END;  ///< last line of a part

std::string toLine(const BagRow& row);
/// Throws InputError with the line number (and `name` of the file).
BagRow parseLine(const std::string& line, const std::string& name, std::size_t line_number);

/// Of "2/4"; nothing if it is not I/N with I from 1 to N.
std::optional<Shard> shardFrom(const std::string& text);
/// `options`: on one line, those that all parts must have been made with.
std::string partLine(const Shard& shard, const std::string& options);
std::string bagLine(const std::string& bag, std::uint64_t nb_rows);

/// Merges tables into the one that a single process would have written for all bags. `paths` are
/// all parts of one run, in any order, or complete tables, which are concatenated in the given
/// order. Every row is passed on as it is written. Throws InputError if a part or a row is missing,
/// or parts of different runs, or made with different options, are mixed. Memory: one row per part.
using BagLineVisitor = std::function<void(const std::string& line, const BagRow& row)>;
void mergeBagTables(const std::vector<std::string>& paths, const BagLineVisitor& visit);

}  // namespace collision_pairs
