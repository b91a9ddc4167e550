#include "yaml_values.h"

#include <cmath>
#include <set>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

std::string shown(const YAML::Node& node) {
  YAML::Emitter out;
  out << YAML::Flow << node;
  return out.c_str();
}

/// Keys that a map has twice or that are no names, and what aliases make endless or huge: a value
/// can contain itself, and a few lines can stand for more values than fit into any memory.
class Visit {
 public:
  void take(const YAML::Node& node, int depth = 1) {
    if (depth > MOST_DEPTH) {
      throw InputError("more than " + std::to_string(MOST_DEPTH) +
                       " values are nested in each other");
    }
    if (++nb_values_ > MOST_VALUES) throw InputError("it has more than a million values");
    std::set<std::string> keys;
    for (const auto& entry : node) {
      if (!node.IsMap()) {
        take(entry, depth + 1);
        continue;
      }
      const std::string line = "line " + std::to_string(entry.first.Mark().line + 1) + ": ";
      if (!entry.first.IsScalar()) throw InputError(line + "a key must be a name");
      if (!keys.insert(entry.first.Scalar()).second) {
        throw InputError(line + "'" + entry.first.Scalar() + "' is given twice");
      }
      take(entry.second, depth + 1);
    }
  }

 private:
  static constexpr int MOST_DEPTH = 100;
  static constexpr std::size_t MOST_VALUES = 1000000;
  std::size_t nb_values_ = 0;
};

}  // namespace

YAML::Node loadYaml(const std::string& text) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      throw InputError("it has " + std::to_string(documents.size()) +
                       " documents (after '---' or '...'), but must have one");
    }
    if (documents.empty()) return YAML::Node(YAML::NodeType::Null);
    Visit().take(documents.front());
    return documents.front();
  } catch (const YAML::Exception& error) {
    throw InputError(error.what());
  }
}

void refuseValue(const std::string& key, const YAML::Node& value, const std::string& rule) {
  throw InputError(key + " is " + shown(value) + ", but must be " + rule);
}

std::string textOf(const std::string& key, const YAML::Node& value, const std::string& rule) {
  if (!value.IsScalar()) refuseValue(key, value, rule);
  return value.Scalar();
}

double numberOf(const std::string& key, const YAML::Node& value, const std::string& rule,
                const Range& range) {
  double found = NAN;
  const bool is_number = value.IsScalar() && YAML::convert<double>::decode(value, found);
  const bool is_low = found < range.least || (range.is_above && found == range.least);
  if (!is_number || !std::isfinite(found) || is_low || found > range.most) {
    refuseValue(key, value, rule);
  }
  return found;
}

int wholeNumberOf(const std::string& key, const YAML::Node& value, int least, int most) {
  const std::string rule =
      "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
  const double found = numberOf(key, value, rule, {double(least), double(most)});
  if (found != std::floor(found)) refuseValue(key, value, rule);
  return static_cast<int>(found);
}

bool flagOf(const std::string& key, const YAML::Node& value) {
  bool found = false;
  if (!value.IsScalar() || !YAML::convert<bool>::decode(value, found)) {
    refuseValue(key, value, "true or false");
  }
  return found;
}

std::vector<std::string> namesOf(const std::string& key, const YAML::Node& value) {
  const std::string rule = "a list of names or patterns, such as [elbow, \"left_*\"]";
  if (!value.IsSequence()) refuseValue(key, value, rule);
  std::vector<std::string> found;
  for (const YAML::Node& entry : value) found.push_back(textOf(key, entry, rule));
  return found;
}

void forEntries(const std::string& key, const YAML::Node& value, const std::string& rule,
                const ValueReader& read) {
  if (!value.IsMap()) refuseValue(key, value, rule);
  for (const auto& entry : value) read(textOf(key, entry.first, rule), entry.second);
}

void readFields(const std::string& origin, const YAML::Node& value, const std::string& rule,
                const std::string& what, const std::map<std::string, ValueReader>& readers) {
  forEntries(origin, value, rule, [&](const std::string& key, const YAML::Node& entry) {
    const auto reader = readers.find(key);
    if (reader != readers.end()) return reader->second(origin + '/' + key, entry);
    std::vector<std::string> known;
    for (const auto& other : readers) known.push_back(other.first);
    throw InputError(origin + ": '" + key + "' is not " + what + didYouMean(key, known));
  });
}

}  // namespace collision_pairs
