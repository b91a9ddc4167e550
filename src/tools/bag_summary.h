// The summary of a checked bag, in a few lines.
#pragma once

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "bag_table.h"

namespace collision_pairs {

/// Fed row by row, in the order of the table. Durations count from a stamp to the next one, unless
/// there is a gap between them. Memory: a few words per pair of links and per gap.
class BagSummary {
 public:
  /// Seconds: stamps further apart are a gap.
  explicit BagSummary(double max_gap) : max_gap_(max_gap) {}
  void add(const BagRow& row);
  void print(std::ostream& out) const;

 private:
  struct Approach {
    double distance = 0.0;
    StampNs stamp = 0;
    double in_contact = 0.0;  ///< seconds
  };
  struct Gap {
    StampNs begin;
    double length;  ///< seconds
  };
  struct Bag {
    std::string name;
    BagRow last;
    StampNs first_stamp = 0;
    std::uint64_t nb_rows = 0;
    std::uint64_t nb_in_contact = 0, nb_unknown = 0;
    double in_contact = 0.0, unknown = 0.0, in_alarm = 0.0;  ///< seconds
    std::optional<double> closest;
    StampNs closest_stamp = 0;
    std::map<std::string, Approach> pairs;
    std::map<std::string, std::uint64_t> left_out;  ///< rows without the link
    std::vector<Gap> gaps;
  };
  void pass(Bag& bag, StampNs until) const;
  void print(const Bag& bag, std::ostream& out) const;

  double max_gap_;
  std::vector<Bag> bags_;
};

}  // namespace collision_pairs
