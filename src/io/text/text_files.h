// Texts, where they come from and where they go.
#pragma once

#include <functional>
#include <ostream>
#include <string>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

/// A text and its source, a file or a topic of a bag, for messages.
struct TextFrom {
  std::string origin, content;
  std::string folder = {};  ///< of the file; empty: it is from none
};

/// What `read` returns. An InputError of it gets the origin before it.
template <class Read>
auto naming(const std::string& origin, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(origin + ": " + error.what());
  }
}

/// The file's content without a UTF-8 byte order mark. Throws InputError that names the file, also
/// if it contains a zero byte and is therefore not text.
std::string readTextFile(const std::string& path);

TextFrom textFromFile(const std::string& path);

/// The bytes of a regular file. Throws InputError that names it.
std::string readBinaryFile(const std::string& path);

/// The file that a symbolic link leads to, so that what is renamed to it does not replace the link;
/// the path itself if it is none, or leads nowhere.
std::string behindLinks(const std::string& path);

/// Writes through a temporary file beside `path` that is renamed only after `write` has succeeded:
/// on any error, no partial output has the final name. An empty path, or "-", is standard output.
/// Throws InputError.
void writeTextFile(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace collision_pairs
