// What is thrown when something that a user gave cannot be used.
#pragma once

#include <stdexcept>
#include <string>

namespace collision_pairs {

/// The message is one line and says what is wrong, where (file, line, link, column), and how to
/// repair it. Nothing is changed by the call that throws it.
class InputError : public std::runtime_error {
 public:
  /// What `message` quotes is foreign: control bytes, which a terminal would obey, become spaces,
  /// and of more than 1,000 bytes the middle is left out.
  explicit InputError(std::string message);
};

}  // namespace collision_pairs
