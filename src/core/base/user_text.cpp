#include "user_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <sstream>

#include <locale.h>

namespace collision_pairs {
namespace {

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

// Of a number too large or too small for a double; from_chars does not say which. Zero is what is
// meant by 1e-400.
double outOfRange(const std::string& number) {
  static const locale_t C_LOCALE = ::newlocale(LC_ALL_MASK, "C", nullptr);
  return ::strtod_l(number.c_str(), nullptr, C_LOCALE);
}

}  // namespace

bool parseNumber(const std::string& text, double& value) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  while (begin != end && std::isspace(static_cast<unsigned char>(*begin))) ++begin;
  while (begin != end && std::isspace(static_cast<unsigned char>(end[-1]))) --end;
  if (begin != end && *begin == '+' && begin + 1 != end && begin[1] != '-') ++begin;
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error == std::errc::result_out_of_range) value = outOfRange(std::string(begin, rest));
  return rest != begin && rest == end && std::isfinite(value);
}

bool parseVector3(const std::string& text, Eigen::Vector3d& value) {
  std::istringstream words(text);
  std::string word;
  for (int i = 0; i < 3; ++i) {
    if (!(words >> word) || !parseNumber(word, value[i])) return false;
  }
  return !(words >> word);
}

std::string nearestName(const std::string& given, const std::vector<std::string>& names,
                        std::size_t most_edits) {
  std::string nearest;
  std::size_t least = most_edits + 1;
  for (const std::string& name : names) {
    const std::size_t distance = editDistance(given, name);
    if (distance >= least) continue;
    least = distance;
    nearest = name;
  }
  return nearest;
}

std::string inWords(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", seconds);
  return text;
}

}  // namespace collision_pairs
