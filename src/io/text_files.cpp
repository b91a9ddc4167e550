#include "text_files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include <unistd.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

namespace fs = std::filesystem;

std::string readTextFile(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path + ": is a directory, not a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  std::ostringstream content;
  content << file.rdbuf();
  std::string text = content.str();
  if (text.compare(0, 3, "\xEF\xBB\xBF") == 0) text.erase(0, 3);
  return text;
}

void writeTextFile(const std::string& path, const std::function<void(std::ostream&)>& write) {
  if (path.empty() || path == "-") {
    write(std::cout);
    std::cout.flush();
    return;
  }
  std::error_code error;
  // A device or pipe has no content to protect, and must not be replaced by a file.
  const bool in_place = fs::exists(path, error) && !fs::is_regular_file(path, error);
  const std::string target = in_place ? path : path + ".part" + std::to_string(::getpid());
  std::ofstream file(target, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be written: " + std::strerror(errno));
  try {
    write(file);
    file.close();
    if (!file) throw InputError(path + ": writing failed (disk full?)");
    if (!in_place) fs::rename(target, path);
  } catch (...) {
    if (!in_place) fs::remove(target, error);
    throw;
  }
}

}  // namespace collision_pairs
