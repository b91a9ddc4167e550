// Numbers and names in user input and output.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace collision_pairs {

/// Parses the whole text, except blanks at its ends, as finite numbers; false for anything else.
/// Independent of the locale.
bool parseNumber(const std::string& text, double& value);

/// The name with the smallest edit distance from `given` (Levenshtein 1965); the first of several,
/// empty if none is within `most_edits`.
std::string nearestName(const std::string& given, const std::vector<std::string>& names,
                        std::size_t most_edits = std::numeric_limits<std::size_t>::max() - 1);

/// "; did you mean 'NAME'?" with the nearest name; empty if there is none.
std::string didYouMean(const std::string& given, const std::vector<std::string>& names,
                       std::size_t most_edits = std::numeric_limits<std::size_t>::max() - 1);

/// Of things with a name: joints, links, models.
template <class Named>
std::vector<std::string> namesOf(const std::vector<Named>& things) {
  std::vector<std::string> names;
  for (const Named& thing : things) names.push_back(thing.name);
  return names;
}

/// Without the leading slash that tf used ("/base"), and some drivers do for joints.
inline std::string withoutLeadingSlash(const std::string& name) {
  return !name.empty() && name.front() == '/' ? name.substr(1) : name;
}

/// The namespace of a name, with a slash at its end; of one without: empty.
inline std::string namespaceOf(const std::string& name) {
  return name.substr(0, name.rfind('/') + 1);
}

/// Whether a name is in a namespace that does not contain the other: an SRDF there may be of
/// another robot than the URDF `other`.
inline bool isOutsideNamespaceOf(const std::string& other, const std::string& name) {
  return name.rfind(namespaceOf(other), 0) != 0;
}

/// Without leading and trailing slashes.
inline std::string withoutSlashes(std::string name) {
  while (!name.empty() && name.front() == '/') name.erase(0, 1);
  while (!name.empty() && name.back() == '/') name.pop_back();
  return name;
}

/// Without the UTF-8 byte order mark that some editors begin a file with.
inline std::string withoutByteOrderMark(std::string text) {
  if (text.compare(0, 3, "\xEF\xBB\xBF") == 0) text.erase(0, 3);
  return text;
}

inline std::string quoted(const std::string& name) { return "'" + name + "'"; }

/// "a, b, c"
std::string joined(const std::vector<std::string>& words, const std::string& separator = ", ");

/// The same, of more than ten the first: "a, b, ... and 3 more".
std::string firstOf(const std::vector<std::string>& words);

bool contains(const std::vector<std::string>& words, const std::string& word);

/// "0.25 s"
std::string inWords(double seconds);

/// As printf() writes it; at most 511 characters.
__attribute__((format(printf, 1, 2))) std::string formatted(const char* format, ...);

/// The number with all its digits: "0.10000000000000001".
inline std::string allDigits(double number) { return formatted("%.17g", number); }

}  // namespace collision_pairs
