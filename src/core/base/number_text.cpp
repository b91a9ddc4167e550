#include "number_text.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

namespace collision_pairs {

bool parseNumber(const std::string& text, double& value) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  while (begin != end && std::isspace(static_cast<unsigned char>(*begin))) ++begin;
  while (begin != end && std::isspace(static_cast<unsigned char>(end[-1]))) --end;
  if (begin != end && *begin == '+' && begin + 1 != end && begin[1] != '-') ++begin;
  const auto [rest, error] = std::from_chars(begin, end, value);
  return error == std::errc() && rest == end && std::isfinite(value);
}

bool parseVector3(const std::string& text, Eigen::Vector3d& value) {
  std::istringstream words(text);
  std::string word;
  for (int i = 0; i < 3; ++i) {
    if (!(words >> word) || !parseNumber(word, value[i])) return false;
  }
  return !(words >> word);
}

}  // namespace collision_pairs
