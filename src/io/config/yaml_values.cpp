#include "yaml_values.h"

#include <cmath>
#include <set>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

std::string shown(const YAML::Node& node) {
  YAML::Emitter out;
  out << YAML::Flow << node;
  return out.c_str();
}

void refuseRepeatedKeys(const YAML::Node& node) {
  std::set<std::string> keys;
  for (const auto& entry : node) {
    if (!node.IsMap()) {
      refuseRepeatedKeys(entry);
      continue;
    }
    if (!keys.insert(shown(entry.first)).second) {
      throw InputError("line " + std::to_string(entry.first.Mark().line + 1) + ": '" +
                       shown(entry.first) + "' is given twice");
    }
    refuseRepeatedKeys(entry.second);
  }
}

}  // namespace

YAML::Node loadYaml(const std::string& text) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      throw InputError("it has " + std::to_string(documents.size()) +
                       " documents (after '---' or '...'), but must have one");
    }
    if (documents.empty()) return YAML::Node(YAML::NodeType::Null);
    refuseRepeatedKeys(documents.front());
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
                double least) {
  double found = NAN;
  const bool is_number = value.IsScalar() && YAML::convert<double>::decode(value, found);
  if (!is_number || !std::isfinite(found) || found < least) refuseValue(key, value, rule);
  return found;
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
                const std::function<void(const std::string&, const YAML::Node&)>& read) {
  if (!value.IsMap()) refuseValue(key, value, rule);
  for (const auto& entry : value) read(textOf(key, entry.first, rule), entry.second);
}

}  // namespace collision_pairs
