#include "bag_outputs.h"

#include <iostream>
#include <memory>

#include "bag_report.h"
#include "text_files.h"

namespace collision_pairs {

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
  summary.print(table_on_stdout ? std::cerr : std::cout);
}

}  // namespace collision_pairs
