// Adds lines to an SRDF, or creates one.
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

/// `given` with `lines` added at its end: every element and comment is kept, in its order and with
/// its attributes; only whitespace between them is reformatted. An empty `given` means an empty
/// document for a robot of that name. Throws InputError with the line.
std::string srdfWithLines(const std::string& given, const std::string& robot_name,
                          const std::vector<SrdfLine>& lines);

}  // namespace collision_pairs
