#include "bag_summary.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace collision_pairs {
namespace {

constexpr std::size_t LONGEST_LIST = 20;  // lines of pairs or gaps; the table lists all

double seconds(StampNs begin, StampNs end) { return 1e-9 * static_cast<double>(end - begin); }

__attribute__((format(printf, 1, 2))) std::string formatted(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

void printRest(std::size_t count, std::ostream& out) {
  if (count > LONGEST_LIST) out << "    and " << count - LONGEST_LIST << " more\n";
}

}  // namespace

void BagSummary::add(const BagRow& row) {
  if (bags_.empty() || bags_.back().name != row.bag) {
    bags_.emplace_back();
    bags_.back().name = row.bag;
    bags_.back().first_stamp = row.stamp;
  } else {
    pass(bags_.back(), row.stamp);
  }
  Bag& bag = bags_.back();
  ++bag.nb_rows;
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

/// The last row applies until then.
void BagSummary::pass(Bag& bag, StampNs until) const {
  const double length = seconds(bag.last.stamp, until);
  if (length > max_gap_) return bag.gaps.push_back({bag.last.stamp, length});
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

void BagSummary::print(std::ostream& out) const {
  for (const Bag& bag : bags_) print(bag, out);
}

void BagSummary::print(const Bag& bag, std::ostream& out) const {
  const auto offset = [&](StampNs stamp) { return seconds(bag.first_stamp, stamp); };
  out << bag.name << ": " << bag.nb_rows << " stamps over "
      << formatted("%.3f s\n", offset(bag.last.stamp));
  out << formatted("  in contact    %9.3f s, %llu stamps\n", bag.in_contact,
                   static_cast<unsigned long long>(bag.nb_in_contact));
  out << formatted("  unknown       %9.3f s, %llu stamps\n", bag.unknown,
                   static_cast<unsigned long long>(bag.nb_unknown));
  out << formatted("  near only     %9.3f s\n", bag.in_alarm);
  if (bag.closest) {
    out << formatted("  closest       %+9.4f m at +%.3f s\n", *bag.closest,
                     offset(bag.closest_stamp));
  } else {
    out << "  closest       beyond the alarm distance (--min-distance finds it)\n";
  }

  std::vector<std::pair<std::string, Approach>> pairs(bag.pairs.begin(), bag.pairs.end());
  std::stable_sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
    return a.second.distance < b.second.distance;
  });
  if (!pairs.empty()) out << "  closest approach of each pair:\n";
  for (std::size_t i = 0; i < std::min(pairs.size(), LONGEST_LIST); ++i) {
    const Approach& approach = pairs[i].second;
    out << formatted("    %+9.4f m at +%.3f s", approach.distance, offset(approach.stamp)) << "  "
        << pairs[i].first
        << (approach.in_contact > 0.0 ? formatted("  (in contact %.3f s)", approach.in_contact)
                                      : "")
        << '\n';
  }
  printRest(pairs.size(), out);

  if (bag.gaps.empty()) {
    out << formatted("  no gap longer than %g s\n", max_gap_);
  } else {
    out << formatted("  gaps longer than %g s:\n", max_gap_);
    for (std::size_t i = 0; i < std::min(bag.gaps.size(), LONGEST_LIST); ++i) {
      out << formatted("    %.3f s after +%.3f s\n", bag.gaps[i].length, offset(bag.gaps[i].begin));
    }
    printRest(bag.gaps.size(), out);
  }
  if (!bag.left_out.empty()) out << "  left out (no pose; clouds: too old or incomplete):\n";
  std::size_t nb_printed = 0;
  for (const auto& [link, count] : bag.left_out) {
    if (++nb_printed > LONGEST_LIST) break;
    out << "    " << link << "  at " << count << " stamps\n";
  }
  printRest(bag.left_out.size(), out);
}

}  // namespace collision_pairs
