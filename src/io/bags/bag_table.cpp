#include "bag_table.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "collision_pairs/input_error.h"
#include "csv.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr StampNs NS_PER_SECOND = 1000000000;

const char* nameOf(Verdict verdict) {
  return verdict == Verdict::FREE        ? "free"
         : verdict == Verdict::COLLISION ? "collision"
                                         : "unknown";
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  if (text.empty()) return parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

class LineReader {
 public:
  LineReader(const std::string& name, std::size_t line)
      : place_(name + " line " + std::to_string(line)) {}

  BagRow read(const std::string& line) const {
    CsvRecord record;
    if (!record.addLine(line)) fail("a quotation mark is not closed");
    const std::vector<std::string>& fields = record.fields();
    if (fields.size() != 11) fail("it has " + std::to_string(fields.size()) + " fields, not 11");
    BagRow row;
    row.bag = fields[0];
    row.state = number<std::uint64_t>(fields[1]);
    row.stamp = stamp(fields[2]);
    if (!fields[5].empty()) row.min_distance = metres(fields[5]);
    row.nb_pairs = number<std::uint64_t>(fields[6]);
    const std::vector<std::string> contacts = split(fields[4], ';');
    for (const std::string& pair : split(fields[7], ';'))
      row.pairs.push_back(bagPair(pair, contacts));
    row.left_out = split(fields[8], ';');
    row.verdict = verdict(fields[9]);
    row.unknown_because = fields[10];
    return row;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw InputError(place_ + ": " + why); }

  double metres(const std::string& text) const {
    double value = 0.0;
    if (!parseNumber(text, value)) fail("'" + text + "' is not a number");
    return value;
  }

  template <class Integer>
  Integer number(const std::string& text) const {
    static_assert(std::is_integral_v<Integer>, "GCC 9 reads no other numbers so");
    Integer value{};
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || rest != text.data() + text.size())
      fail("'" + text + "' is not a number");
    return value;
  }

  StampNs stamp(const std::string& text) const {
    const std::size_t point = text.find('.');
    if (point == std::string::npos || text.size() - point != 10)
      fail("'" + text + "' is not a stamp");
    return number<StampNs>(text.substr(0, point)) * NS_PER_SECOND +
           number<StampNs>(text.substr(point + 1));
  }

  Verdict verdict(const std::string& text) const {
    for (const Verdict known : {Verdict::FREE, Verdict::COLLISION, Verdict::UNKNOWN}) {
      if (text == nameOf(known)) return known;
    }
    fail("'" + text + "' is not a verdict");
  }

  BagPair bagPair(const std::string& text, const std::vector<std::string>& contacts) const {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos) fail("'" + text + "' is not a distance of a pair");
    const std::string links = text.substr(0, equals);
    return {links, metres(text.substr(equals + 1)),
            std::count(contacts.begin(), contacts.end(), links) > 0};
  }

  std::string place_;
};

}  // namespace

const char* const BAG_TABLE_HEADER =
    "bag,state,stamp,in_collision,pairs,min_distance,nb_pairs,distances,left_out,verdict,"
    "unknown_because";
const char* const BAG_TABLE_END = "# end";

std::string toLine(const BagRow& row) {
  const std::string stamp =
      formatted("%lld.%09lld", static_cast<long long>(row.stamp / NS_PER_SECOND),
                static_cast<long long>(row.stamp % NS_PER_SECOND));
  std::vector<std::string> contacts, distances;
  for (const BagPair& pair : row.pairs) {
    if (pair.in_contact) contacts.push_back(pair.links);
    distances.push_back(pair.links + '=' + allDigits(pair.distance));
  }
  return csvField(row.bag) + ',' + std::to_string(row.state) + ',' + stamp + ',' +
         (row.verdict == Verdict::FREE ? '0' : '1') + ',' + csvField(joined(contacts, ";")) + ',' +
         (row.min_distance ? allDigits(*row.min_distance) : "") + ',' +
         std::to_string(row.nb_pairs) + ',' + csvField(joined(distances, ";")) + ',' +
         csvField(joined(row.left_out, ";")) + ',' + nameOf(row.verdict) + ',' +
         csvField(row.unknown_because);
}

BagRow parseLine(const std::string& line, const std::string& name, std::size_t line_number) {
  return LineReader(name, line_number).read(line);
}

std::optional<Shard> shardFrom(const std::string& text) {
  unsigned long long index = 0, count = 0;
  char rest = 0;
  const bool is_shard = text.find('-') == std::string::npos &&
                        std::sscanf(text.c_str(), "%llu/%llu%c", &index, &count, &rest) == 2 &&
                        index >= 1 && index <= count;
  return is_shard ? std::optional<Shard>({index - 1, count}) : std::nullopt;
}

std::string partLine(const Shard& shard, const std::string& options) {
  return "# part " + std::to_string(shard.index + 1) + "/" + std::to_string(shard.count) +
         (options.empty() ? "" : " " + options);
}

std::string bagLine(const std::string& bag, std::uint64_t nb_rows) {
  return "# bag " + bag + ' ' + std::to_string(nb_rows);
}

}  // namespace collision_pairs
