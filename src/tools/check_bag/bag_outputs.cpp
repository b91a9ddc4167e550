#include "bag_outputs.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <vector>

#include <unistd.h>

#include "collision_pairs/input_error.h"
#include "plot_script.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t LONGEST_LIST = 20;  // lines of pairs or gaps; the table lists all

/// A line for each of the first.
template <class List, class Print>
void printList(const List& list, std::ostream& out, const Print& print) {
  std::size_t nb_printed = 0;
  for (const auto& item : list) {
    if (++nb_printed > LONGEST_LIST) break;
    out << "    ";
    print(item);
    out << '\n';
  }
  if (list.size() > LONGEST_LIST) out << "    and " << list.size() - LONGEST_LIST << " more\n";
}

/// A few lines about each bag, fed row by row in the order of the table. Durations count from a
/// stamp to the next one, unless there is a gap between them or the next one is earlier. Memory: a
/// few words per pair of links and per gap.
class BagSummary {
 public:
  /// Seconds: stamps further apart are a gap.
  explicit BagSummary(double max_gap) : max_gap_(max_gap) {}

  void add(const BagRow& row) {
    if (bags_.empty() || bags_.back().name != row.bag || row.state == 0) {
      bags_.emplace_back();
      bags_.back().name = row.bag;
      bags_.back().first_stamp = bags_.back().last_stamp = row.stamp;
    } else {
      pass(bags_.back(), row.stamp);
    }
    Bag& bag = bags_.back();
    ++bag.nb_rows;
    bag.first_stamp = std::min(bag.first_stamp, row.stamp);
    bag.last_stamp = std::max(bag.last_stamp, row.stamp);
    if (row.verdict == Verdict::COLLISION) ++bag.nb_in_contact;
    if (row.verdict == Verdict::UNKNOWN) ++bag.nb_unknown;
    if (row.min_distance && (!bag.closest || *row.min_distance < *bag.closest)) {
      bag.closest = row.min_distance;
      bag.closest_stamp = row.stamp;
    }
    for (const BagPair& pair : row.pairs) {
      const auto [entry, is_new] = bag.pairs.try_emplace(pair.links);
      Approach& approach = entry->second;
      if (is_new || pair.distance < approach.distance) {
        approach.distance = pair.distance;
        approach.stamp = row.stamp;
      }
    }
    for (const std::string& link : row.left_out) ++bag.left_out[link];
    bag.last = row;
  }

  void print(std::ostream& out) const {
    for (const Bag& bag : bags_) print(bag, out);
  }

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
    StampNs first_stamp = 0, last_stamp = 0;  ///< the earliest and the latest
    std::uint64_t nb_rows = 0;
    std::uint64_t nb_in_contact = 0, nb_unknown = 0;
    double in_contact = 0.0, unknown = 0.0, in_alarm = 0.0;  ///< seconds
    std::optional<double> closest;
    StampNs closest_stamp = 0;
    std::map<std::string, Approach> pairs;
    std::map<std::string, std::uint64_t> left_out;  ///< rows without the link
    std::vector<Gap> gaps;
  };

  /// The last row applies until then.
  void pass(Bag& bag, StampNs until) const {
    const double length = inSeconds(until - bag.last.stamp);
    if (length < 0.0 || length > max_gap_) return bag.gaps.push_back({bag.last.stamp, length});
    if (bag.last.verdict == Verdict::COLLISION) {
      bag.in_contact += length;
    } else if (bag.last.verdict == Verdict::UNKNOWN) {
      bag.unknown += length;
    } else if (!bag.last.pairs.empty()) {
      bag.in_alarm += length;
    }
    for (const BagPair& pair : bag.last.pairs) {
      if (pair.in_contact) bag.pairs[pair.links].in_contact += length;
    }
  }

  void print(const Bag& bag, std::ostream& out) const {
    const auto offset = [&](StampNs stamp) { return inSeconds(stamp - bag.first_stamp); };
    out << bag.name << ": " << bag.nb_rows << " stamps over "
        << formatted("%.3f s\n", offset(bag.last_stamp));
    out << formatted("  in contact    %9.3f s, %llu stamps\n", bag.in_contact,
                     static_cast<unsigned long long>(bag.nb_in_contact));
    out << formatted("  unknown       %9.3f s, %llu stamps\n", bag.unknown,
                     static_cast<unsigned long long>(bag.nb_unknown));
    out << formatted("  near only     %9.3f s\n", bag.in_alarm);
    if (bag.closest) {
      out << formatted("  closest       %+9.4f m at +%.3f s\n", *bag.closest,
                       offset(bag.closest_stamp));
    } else {
      out << (bag.nb_in_contact > 0
                  ? "  closest       not measured\n"
                  : "  closest       beyond the alarm distance (--min-distance finds it)\n");
    }

    std::vector<std::pair<std::string, Approach>> pairs(bag.pairs.begin(), bag.pairs.end());
    std::stable_sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
      return a.second.distance < b.second.distance;
    });
    if (!pairs.empty()) out << "  closest approach of each pair:\n";
    printList(pairs, out, [&](const auto& pair) {
      const Approach& approach = pair.second;
      out << formatted("%+9.4f m at +%.3f s", approach.distance, offset(approach.stamp)) << "  "
          << pair.first;
      if (approach.in_contact > 0.0) out << formatted("  (in contact %.3f s)", approach.in_contact);
    });
    out << formatted(
        bag.gaps.empty() ? "  no gap longer than %g s\n" : "  gaps longer than %g s:\n", max_gap_);
    printList(bag.gaps, out, [&](const Gap& gap) {
      out << formatted(gap.length < 0.0 ? "back by %.3f s after +%.3f s" : "%.3f s after +%.3f s",
                       std::abs(gap.length), offset(gap.begin));
    });
    if (!bag.left_out.empty()) out << "  left out (no pose; clouds: too old or incomplete):\n";
    printList(bag.left_out, out,
              [&](const auto& link) { out << link.first << "  at " << link.second << " stamps"; });
  }

  double max_gap_;
  std::vector<Bag> bags_;
};

/// The HTML page of a checked bag. Collects the table in `folder`, then runs plot_bag_report
/// (beside this program) to create folder/index.html from it. On any error, no partial page is
/// left.
class BagReport {
 public:
  /// Creates the folder. Throws InputError if it cannot be written.
  explicit BagReport(const std::string& folder)
      : folder_(folder), table_path_(folder + "/.table" + std::to_string(::getpid()) + ".csv") {
    std::error_code error;
    is_new_ = fs::create_directories(folder_, error);
    table_.open(table_path_, std::ios::binary);
    if (!table_) throw InputError(folder_ + ": cannot be written: " + std::strerror(errno));
    addLine(BAG_TABLE_HEADER);
  }
  ~BagReport() {
    std::error_code error;
    fs::remove(table_path_, error);
    if (is_new_) fs::remove(folder_, error);  // only if it is empty
  }
  BagReport(const BagReport&) = delete;
  BagReport& operator=(const BagReport&) = delete;

  void addLine(const std::string& line) { table_ << line << '\n'; }
  /// `alarm_distance` in metres, `max_gap` in seconds: those used for the table.
  void finish(double alarm_distance, double max_gap) {
    table_.close();
    if (!table_) throw InputError(folder_ + ": writing failed (disk full?)");
    const bool is_made = runPlotScript(
        "plot_bag_report", {table_path_, "--out", folder_ + "/index.html", "--alarm-distance",
                            std::to_string(alarm_distance), "--max-gap", std::to_string(max_gap)});
    if (!is_made) throw InputError(folder_ + ": the page could not be made; see the line above");
  }

 private:
  const std::string folder_, table_path_;
  bool is_new_ = false;
  std::ofstream table_;
};

}  // namespace

void requireGap(double seconds) {
  if (seconds >= 1e-9 && std::isfinite(seconds)) return;
  throw InputError("--max-gap must be a finite number, above 0");
}

void writeBagOutputs(const BagOutputOptions& options,
                     const std::function<void(const BagLineSink&)>& produce) {
  BagSummary summary(options.max_gap);
  std::unique_ptr<BagReport> report;
  if (!options.report.empty()) report = std::make_unique<BagReport>(options.report);
  const auto produceTo = [&](std::ostream* table) {
    if (table) *table << BAG_TABLE_HEADER << '\n';
    produce([&](const std::string& line, const BagRow* row) {
      if (table) *table << line << '\n';
      if (!row) return;
      summary.add(*row);
      if (report) report->addLine(line);
    });
    if (report) report->finish(options.alarm_distance, options.max_gap);
  };
  if (options.out.empty() && (options.quiet || report))
    produceTo(nullptr);
  else
    writeTextFile(options.out, [&](std::ostream& table) { produceTo(&table); });
  const bool table_on_stdout =
      options.out == "-" || (options.out.empty() && !options.quiet && !report);
  if (table_on_stdout) return summary.print(std::cerr);
  writeTextFile("-", [&](std::ostream& out) { summary.print(out); });
}

}  // namespace collision_pairs
