// Whole text files, in and out.
#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace collision_pairs {

/// The file's content without a UTF-8 byte order mark. Throws InputError that names the file, also
/// where a zero byte says that it is no text, as of /dev/zero.
std::string readTextFile(const std::string& path);

/// The bytes of a regular file. Throws InputError that names it.
std::string readBinaryFile(const std::string& path);

/// Writes through a temporary file beside `path` that takes its name only when `write` is through:
/// whatever goes wrong, no part of an output stands under the final name. An empty path, or "-",
/// is standard output. Throws InputError.
void writeTextFile(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace collision_pairs
