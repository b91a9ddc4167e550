#include "bag_report.h"

#include <cstring>
#include <filesystem>
#include <vector>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bag_table.h"
#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

namespace fs = std::filesystem;

fs::path plotScript() {
  const fs::path script = fs::read_symlink("/proc/self/exe").parent_path() / "plot_bag_report";
  if (!fs::exists(script)) throw InputError("there is no " + script.string() + " to make the page");
  return script;
}

/// Exit status; what it has to say goes to standard error.
int run(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (::posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), ::environ) != 0)
    return -1;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

BagReport::BagReport(const std::string& folder) : folder_(folder) {
  std::error_code error;
  fs::create_directories(folder_, error);
  table_path_ = folder_ + "/.table" + std::to_string(::getpid()) + ".csv";
  table_.open(table_path_, std::ios::binary);
  if (!table_) throw InputError(folder_ + ": cannot be written: " + std::strerror(errno));
  addLine(BAG_TABLE_HEADER);
}

BagReport::~BagReport() {
  std::error_code error;
  fs::remove(table_path_, error);
}

void BagReport::finish(double alarm_distance, double max_gap) {
  table_.close();
  if (!table_) throw InputError(folder_ + ": writing failed (disk full?)");
  const int status =
      run({plotScript().string(), table_path_, "--out", folder_ + "/index.html", "--alarm-distance",
           std::to_string(alarm_distance), "--max-gap", std::to_string(max_gap)});
  if (status != 0) throw InputError(folder_ + ": the page could not be made; see the line above");
}

}  // namespace collision_pairs
