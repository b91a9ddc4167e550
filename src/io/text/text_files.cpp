#include "text_files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <utility>

#include <unistd.h>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {

namespace fs = std::filesystem;

namespace {
constexpr std::size_t BLOCK = std::size_t{1} << 16;         // bytes
constexpr std::size_t LONGEST_TEXT = std::size_t{4} << 30;  // bytes: a device may never end

/// Calls `take(bytes)` for each block.
template <class Take>
void readBlocks(const std::string& path, const Take& take) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path + ": is a directory, not a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  std::string block(BLOCK, '\0');
  while (file) {
    file.read(block.data(), BLOCK);
    take(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) throw InputError(path + ": cannot be read to its end: " + std::strerror(errno));
}

}  // namespace

std::string readBinaryFile(const std::string& path) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error) &&
      !fs::is_regular_file(path, error)) {
    throw InputError(path + ": is not a regular file");  // a device may never end
  }
  std::string bytes;
  readBlocks(path, [&](const char* block, std::size_t size) { bytes.append(block, size); });
  return bytes;
}

TextFrom textFromFile(const std::string& path) {
  return {path, readTextFile(path), fs::absolute(path).parent_path().string()};
}

std::string readTextFile(const std::string& path) {
  std::string text;
  readBlocks(path, [&](const char* block, std::size_t size) {
    if (text.size() > LONGEST_TEXT) throw InputError(path + ": is longer than 4 GiB");
    if (std::memchr(block, '\0', size) != nullptr) {
      throw InputError(path + ": contains a zero byte, so it is not text");
    }
    text.append(block, size);
  });
  return withoutByteOrderMark(std::move(text));
}

std::string behindLinks(const std::string& path) {
  std::error_code error;
  const fs::path target = fs::is_symlink(path, error) ? fs::canonical(path, error) : fs::path(path);
  return error ? path : target.string();
}

void writeTextFile(const std::string& path, const std::function<void(std::ostream&)>& write) {
  if (path.empty() || path == "-") {
    write(std::cout);
    if (!std::cout.flush()) throw InputError("standard output: writing failed (disk full?)");
    return;
  }
  std::error_code error;
  // A device or pipe has no content to protect, and must not be replaced by a file.
  const std::string end = behindLinks(path);
  const bool in_place =
      fs::is_symlink(end, error) || (fs::exists(end, error) && !fs::is_regular_file(end, error));
  const std::string target = in_place ? path : end + ".part" + std::to_string(::getpid());
  std::ofstream file(target, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be written: " + std::strerror(errno));
  try {
    write(file);
    file.close();
    if (!file) throw InputError(path + ": writing failed (disk full?)");
    if (!in_place) fs::rename(target, end);
  } catch (...) {
    if (!in_place) fs::remove(target, error);
    throw;
  }
}

}  // namespace collision_pairs
