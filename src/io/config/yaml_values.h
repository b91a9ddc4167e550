// Strict reading of YAML values: an invalid one throws InputError with key, value and rule.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace collision_pairs {

[[noreturn]] void refuseValue(const std::string& key, const YAML::Node& value,
                              const std::string& rule);

/// A text with one document. Throws InputError, with the line, for a key that is no scalar, or that
/// a map has twice: of the two, rosparam takes the last and yaml-cpp the first. Also where values
/// contain themselves by aliases, or stand for more than a million.
YAML::Node loadYaml(const std::string& text);

std::string textOf(const std::string& key, const YAML::Node& value, const std::string& rule);

struct Range {
  double least = -std::numeric_limits<double>::max(), most = std::numeric_limits<double>::max();
  bool is_above = false;  ///< `least` is excluded
};

/// A finite number in the range; `rule` says in which.
double numberOf(const std::string& key, const YAML::Node& value, const std::string& rule,
                const Range& range = {});
int wholeNumberOf(const std::string& key, const YAML::Node& value, int least, int most);

bool flagOf(const std::string& key, const YAML::Node& value);

/// 0 or more metres.
inline double metresOf(const std::string& key, const YAML::Node& value) {
  return numberOf(key, value, "0 or more metres", {0.0});
}

/// A list of names or patterns.
std::vector<std::string> namesOf(const std::string& key, const YAML::Node& value);

using ValueReader = std::function<void(const std::string& key, const YAML::Node&)>;

/// Calls `read` with each key and value of a map.
void forEntries(const std::string& key, const YAML::Node& value, const std::string& rule,
                const ValueReader& read);

/// Calls the reader of each entry of a map, with the key as `origin`/key. Throws InputError where
/// there is none: that it is not `what`, and which is the closest.
void readFields(const std::string& origin, const YAML::Node& value, const std::string& rule,
                const std::string& what, const std::map<std::string, ValueReader>& readers);

}  // namespace collision_pairs
