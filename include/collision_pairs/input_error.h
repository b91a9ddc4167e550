// The exception for input that cannot be used.
#pragma once

#include <stdexcept>
#include <string>

namespace collision_pairs {

/// The message is one line that says what is wrong, where (file, line, link, column), and how to
/// repair it. A call that throws it changes nothing.
class InputError : public std::runtime_error {
 public:
  /// `message` may quote untrusted input: control bytes, which a terminal would interpret, are
  /// replaced by spaces, and beyond 1,000 bytes the middle is omitted.
  explicit InputError(std::string message);
};

}  // namespace collision_pairs
