// The defaults that a page of docs states.
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace collision_pairs {

/// Of the first table with the columns name (or key) and default: | `~name` | `default` unit | …
/// By name; without quotes and unit.
inline std::map<std::string, std::string> documentedDefaults(const std::string& page) {
  std::map<std::string, std::string> values;
  std::ifstream file(std::string(PROJECT_SOURCE_DIR) + "/docs/" + page);
  std::string line;
  while (std::getline(file, line) && line.find("| default |") == std::string::npos) {
  }
  std::getline(file, line);  // |---|---|---|
  while (std::getline(file, line) && !line.empty()) {
    std::istringstream cells(line.substr(1));
    std::string name, value;
    std::getline(cells, name, '|');
    std::getline(cells, value, '|');
    name.erase(0, name.find_first_not_of(" `~"));
    const bool is_quoted = value[1] == '`';
    value.erase(0, is_quoted ? 2 : 1);
    values[name.substr(0, name.find('`'))] = value.substr(0, value.find(is_quoted ? '`' : ' '));
  }
  return values;
}

}  // namespace collision_pairs
