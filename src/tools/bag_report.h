// The HTML page about a checked bag.
#pragma once

#include <fstream>
#include <string>

namespace collision_pairs {

/// Collects the table in `folder`, then has plot_bag_report (beside this program) make
/// folder/index.html of it. Whatever goes wrong, no part of a page stays there.
class BagReport {
 public:
  /// Makes the folder. Throws InputError if it cannot be written.
  explicit BagReport(const std::string& folder);
  ~BagReport();
  BagReport(const BagReport&) = delete;
  BagReport& operator=(const BagReport&) = delete;

  void addLine(const std::string& line) { table_ << line << '\n'; }
  /// `alarm_distance` in metres, `max_gap` in seconds, as the table was made with.
  void finish(double alarm_distance, double max_gap);

 private:
  std::string folder_;
  std::string table_path_;
  std::ofstream table_;
};

}  // namespace collision_pairs
