// A ROS message as text, for tests that know all of its fields.
#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace collision_pairs {

/// As roscpp prints it, in one line, without the fields that are zero, false or empty: it says of
/// every field of the message what it is, and how many entries a list has.
template <class Message>
std::string printed(const Message& message) {
  struct Line {
    std::size_t indent;
    std::string name, value;
  };
  std::vector<Line> lines;
  std::stringstream text;
  text << message;
  for (std::string line; std::getline(text, line);) {
    const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t end = std::min(line.find(": "), line.find("[]"));
    if (end == std::string::npos) {
      if (!line.empty()) lines.back().value += '|' + line;  // of a text of several lines
      continue;
    }
    // The first field of an entry is indented twice.
    const std::size_t most = lines.empty() ? 0 : lines.back().indent + 2;
    lines.push_back({std::min(begin, most), line.substr(begin, end - begin), line.substr(end + 2)});
  }
  const auto isZero = [](const Line& line) {
    return line.value.find_first_not_of("-0.") == std::string::npos;
  };
  std::string all;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::size_t inner = i + 1;
    if (isZero(lines[i]) && lines[i].name.back() != ']') {
      while (inner < lines.size() && lines[inner].indent > lines[i].indent &&
             isZero(lines[inner])) {
        ++inner;
      }
      if (inner == lines.size() || lines[inner].indent <= lines[i].indent) continue;
    }
    if (i + 1 < lines.size() && lines[i + 1].name.rfind(lines[i].name + '[', 0) == 0) continue;
    all += (all.empty() ? "" : " ") + lines[i].name;
    if (!isZero(lines[i])) all += ' ' + lines[i].value;
  }
  return all;
}

}  // namespace collision_pairs
