// merge_bag_checks: tables of check_bag in, the table that one process would have written out.
#include <string>
#include <vector>

#include "bag_outputs.h"
#include "command_line.h"

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
  command_line.output("out", options.output.out, "OUT.csv",
                      "output file (default: standard output)");
  command_line.output("report", options.output.report, "DIR",
                      "write a report page to this folder: index.html", "/index.html");
  command_line.metres("alarm-distance", options.output.alarm_distance, "as given to check_bag");
  command_line.option("max-gap", options.output.max_gap, "SECONDS", "as given to check_bag");
}

void mergeAll(const Options& options) {
  requireGap(options.output.max_gap);
  writeBagOutputs(options.output, [&](const BagLineSink& sink) {
    mergeBagTables(options.tables,
                   [&](const std::string& line, const BagRow& row) { sink(line, &row); });
  });
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  return runTool(argc, argv, {"merge_bag_checks", "Merges tables of check_bag."}, declare,
                 mergeAll);
}
