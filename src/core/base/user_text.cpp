#include "user_text.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <numeric>

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

}  // namespace

// std::from_chars() for double came with GCC 11; Ubuntu 20.04 has GCC 9.
bool parseNumber(const std::string& text, double& value) {
  static const locale_t C_LOCALE = ::newlocale(LC_ALL_MASK, "C", nullptr);
  constexpr const char* SPACE = " \t\n\v\f\r";
  const std::size_t begin = text.find_first_not_of(SPACE);
  if (begin == std::string::npos) return false;
  const std::string number = text.substr(begin, text.find_last_not_of(SPACE) + 1 - begin);
  // Excludes hexadecimal numbers, "nan" and "infinity", which strtod() accepts.
  if (number.find_first_not_of("+-.0123456789eE") != std::string::npos) return false;
  char* rest = nullptr;
  value = ::strtod_l(number.c_str(), &rest, C_LOCALE);
  return rest == number.c_str() + number.size() && std::isfinite(value);
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

std::string didYouMean(const std::string& given, const std::vector<std::string>& names,
                       std::size_t most_edits) {
  const std::string nearest = nearestName(given, names, most_edits);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string firstOf(const std::vector<std::string>& words) {
  constexpr std::size_t MOST = 10;
  if (words.size() <= MOST) return joined(words);
  return joined({words.begin(), words.begin() + MOST}) + " and " +
         std::to_string(words.size() - MOST) + " more";
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string inWords(double seconds) { return formatted("%.2f s", seconds); }

std::string formatted(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

}  // namespace collision_pairs
