#include "bag_outputs.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <vector>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "collision_pairs/input_error.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

namespace fs = std::filesystem;

fs::path plotScript() {
  const fs::path script = fs::read_symlink("/proc/self/exe").parent_path() / "plot_bag_report";
  if (!fs::exists(script))
    throw InputError(script.string() + ", which makes the page, does not exist");
  return script;
}

/// Returns the exit status; its output goes to standard error.
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

/// The HTML page of a checked bag. Collects the table in `folder`, then runs plot_bag_report
/// (beside this program) to create folder/index.html from it. On any error, no partial page is
/// left.
class BagReport {
 public:
  /// Creates the folder. Throws InputError if it cannot be written.
  explicit BagReport(const std::string& folder);
  ~BagReport();
  BagReport(const BagReport&) = delete;
  BagReport& operator=(const BagReport&) = delete;

  void addLine(const std::string& line) { table_ << line << '\n'; }
  /// `alarm_distance` in metres, `max_gap` in seconds: those used for the table.
  void finish(double alarm_distance, double max_gap);

 private:
  std::string folder_;
  bool is_new_ = false;
  std::string table_path_;
  std::ofstream table_;
};

BagReport::BagReport(const std::string& folder) : folder_(folder) {
  std::error_code error;
  is_new_ = fs::create_directories(folder_, error);
  table_path_ = folder_ + "/.table" + std::to_string(::getpid()) + ".csv";
  table_.open(table_path_, std::ios::binary);
  if (!table_) throw InputError(folder_ + ": cannot be written: " + std::strerror(errno));
  addLine(BAG_TABLE_HEADER);
}

BagReport::~BagReport() {
  std::error_code error;
  fs::remove(table_path_, error);
  if (is_new_) fs::remove(folder_, error);  // only if it is empty
}

void BagReport::finish(double alarm_distance, double max_gap) {
  table_.close();
  if (!table_) throw InputError(folder_ + ": writing failed (disk full?)");
  const int status =
      run({plotScript().string(), table_path_, "--out", folder_ + "/index.html", "--alarm-distance",
           std::to_string(alarm_distance), "--max-gap", std::to_string(max_gap)});
  if (status != 0) throw InputError(folder_ + ": the page could not be made; see the line above");
}

}  // namespace

void writeBagOutputs(const BagOutputOptions& options,
                     const std::function<void(const BagLineSink&)>& produce) {
  BagSummary summary(options.max_gap);
  std::unique_ptr<BagReport> report;
  if (!options.report.empty()) report = std::make_unique<BagReport>(options.report);
  const auto produceTo = [&](std::ostream* table) {
    if (table) *table << BAG_TABLE_HEADER << '\n';
    produce([&](const std::string& line, const BagRow* row) {
      if (table) *table << line << '\n';
      if (!row) return;
      summary.add(*row);
      if (report) report->addLine(line);
    });
    if (report) report->finish(options.alarm_distance, options.max_gap);
  };
  if (options.out.empty() && (options.quiet || report))
    produceTo(nullptr);
  else
    writeTextFile(options.out, [&](std::ostream& table) { produceTo(&table); });
  const bool table_on_stdout =
      options.out == "-" || (options.out.empty() && !options.quiet && !report);
  if (table_on_stdout) return summary.print(std::cerr);
  writeTextFile("-", [&](std::ostream& out) { summary.print(out); });
}

}  // namespace collision_pairs
