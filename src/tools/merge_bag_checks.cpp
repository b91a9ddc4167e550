// merge_bag_checks: tables of check_bag in, the table that one process would have written out.
#include <string>
#include <vector>

#include "bag_outputs.h"
#include "tool.h"

namespace collision_pairs {
namespace {

struct Options {
  std::vector<std::string> tables;
  BagOutputOptions output;
};

void declare(CommandLine& command_line, Options& options) {
  command_line.operands(options.tables, "TABLE.csv...",
                        "all parts of one run (check_bag --shard) in any order, or complete "
                        "tables, which are concatenated");
  command_line.option("out", options.output.out, "OUT.csv",
                      "output file (default: standard output)");
  command_line.option("report", options.output.report, "DIR",
                      "write a report page to this folder: index.html");
  command_line.option("alarm-distance", options.output.alarm_distance, "METRES",
                      "as given to check_bag");
  command_line.option("max-gap", options.output.max_gap, "SECONDS", "as given to check_bag");
}

void mergeAll(const Options& options) {
  writeBagOutputs(options.output, [&](const BagLineSink& sink) {
    mergeBagTables(options.tables,
                   [&](const std::string& line, const BagRow& row) { sink(line, &row); });
  });
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  collision_pairs::Options options;
  collision_pairs::CommandLine command_line("merge_bag_checks", "Merges tables of check_bag.");
  collision_pairs::declare(command_line, options);
  return collision_pairs::runTool(command_line, argc, argv,
                                  [&] { collision_pairs::mergeAll(options); });
}
