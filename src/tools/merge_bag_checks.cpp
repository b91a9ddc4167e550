// merge_bag_checks: tables of check_bag in, the table that one process would have written out.
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bag_outputs.h"
#include "tool.h"

namespace collision_pairs {
namespace {

struct Options {
  std::vector<std::string> tables;
  BagOutputOptions output;
};

void declare(CLI::App& app, Options& options) {
  app.add_option("tables", options.tables,
                 "all parts of one run (check_bag --shard), in any order; "
                 "or whole tables, to follow each other")
      ->required()
      ->type_name("TABLE.csv...");
  app.add_option("--out", options.output.out, "where to write (default: standard output)")
      ->type_name("OUT.csv");
  app.add_option("--report", options.output.report, "write a page for a browser there: index.html")
      ->type_name("DIR");
  app.add_option("--alarm-distance", options.output.alarm_distance, "as given to check_bag")
      ->type_name("METRES")
      ->capture_default_str();
  app.add_option("--max-gap", options.output.max_gap, "as given to check_bag")
      ->type_name("SECONDS")
      ->capture_default_str();
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
  CLI::App app("Puts tables of check_bag together.", "merge_bag_checks");
  collision_pairs::declare(app, options);
  return collision_pairs::runTool(app, argc, argv, [&] { collision_pairs::mergeAll(options); });
}
