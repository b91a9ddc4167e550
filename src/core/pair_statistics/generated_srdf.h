// Adds lines to an SRDF, or makes one.
#pragma once

#include <string>
#include <vector>

namespace collision_pairs {

/// A comment, and below it <disable_collisions> unless the reason is empty.
struct SrdfLine {
  std::string comment;
  std::string first_link;
  std::string second_link;
  std::string reason;
};

/// `given` with `lines` added at its end: every element and comment in it stays, in its order and
/// with its attributes; only blanks between them are laid out anew. An empty `given` is a
/// document of a robot of that name with nothing in it. Throws InputError with the line.
std::string srdfWithLines(const std::string& given, const std::string& robot_name,
                          const std::vector<SrdfLine>& lines);

}  // namespace collision_pairs
