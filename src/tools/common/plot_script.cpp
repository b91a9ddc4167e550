#include "plot_script.h"

#include <cerrno>
#include <filesystem>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

bool runPlotScript(const std::string& name, const std::vector<std::string>& arguments) {
  namespace fs = std::filesystem;
  const std::string script = (fs::read_symlink("/proc/self/exe").parent_path() / name).string();
  if (!fs::exists(script)) throw InputError(script + ", which draws, does not exist");
  std::vector<char*> words{const_cast<char*>(script.c_str())};
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_t child = 0;
  if (::posix_spawn(&child, words[0], nullptr, nullptr, words.data(), ::environ) != 0) return false;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return false;
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace collision_pairs
