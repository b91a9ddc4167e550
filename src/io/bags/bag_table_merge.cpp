#include <algorithm>
#include <fstream>
#include <memory>

#include "bag_table.h"
#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

/// A file read line by line.
class Table {
 public:
  explicit Table(const std::string& path) : path_(path), file_(path, std::ios::binary) {
    if (!file_) throw InputError(path_ + ": cannot be opened");
    std::string header;
    if (!next(header) || header != BAG_TABLE_HEADER) fail("is not a table of check_bag");
    is_part_ = file_.peek() == '#';
    if (!is_part_) return;
    std::string line;
    next(line);
    const std::string part = line.compare(0, 7, "# part ") == 0 ? line.substr(7) : "";
    const std::size_t space = std::min(part.find(' '), part.size());
    const auto shard = shardFrom(part.substr(0, space));
    if (!shard) fail("'" + line + "' does not say which part it is");
    shard_ = *shard;
    options_ = part.substr(std::min(space + 1, part.size()));
  }

  bool next(std::string& line) {
    if (!std::getline(file_, line)) {
      if (file_.bad()) fail("it cannot be read to its end");
      return false;
    }
    ++line_number_;
    return true;
  }
  std::string expect() {
    std::string line;
    if (!next(line)) fail("it is incomplete; its process may have been stopped");
    return line;
  }
  BagRow parse(const std::string& line) const { return parseLine(line, path_, line_number_); }
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(path_ + (line_number_ > 1 ? " line " + std::to_string(line_number_) : "") +
                     ": " + why);
  }
  bool isPart() const { return is_part_; }
  const Shard& shard() const { return shard_; }
  const std::string& options() const { return options_; }

 private:
  std::string path_;
  std::ifstream file_;
  std::size_t line_number_ = 0;
  bool is_part_ = false;
  Shard shard_;
  std::string options_;
};

using Tables = std::vector<std::unique_ptr<Table>>;

/// Sorted by part; each part exactly once, and all made with the same options.
void checkComplete(Tables& parts) {
  std::sort(parts.begin(), parts.end(),
            [](const auto& a, const auto& b) { return a->shard().index < b->shard().index; });
  const std::uint64_t count = parts.front()->shard().count;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i]->shard().count != count) parts[i]->fail("is a part of another run");
    if (parts[i]->shard().index > i) {
      throw InputError("part " + std::to_string(i + 1) + "/" + std::to_string(count) +
                       " is missing");
    }
    if (parts[i]->shard().index < i) parts[i]->fail("this part is given twice");
    if (parts[i]->options() != parts.front()->options()) {
      parts[i]->fail("is a part of another run: its options are '" + parts[i]->options() +
                     "', those of the first part '" + parts.front()->options() + "'");
    }
  }
  if (parts.size() != count) {
    throw InputError("part " + std::to_string(parts.size() + 1) + "/" + std::to_string(count) +
                     " is missing");
  }
}

/// The line of one part must be the next of all others, too.
void requireInAll(Tables& parts, const Table& first, const std::string& line) {
  for (auto& part : parts) {
    if (part.get() != &first && part->expect() != line) {
      part->fail("is a part of another run (expected '" + line + "')");
    }
  }
}

void mergeParts(Tables& parts, const BagLineVisitor& visit) {
  checkComplete(parts);
  std::uint64_t state = 0;
  std::size_t bag = 0;
  std::string name;  // of the bag
  for (;;) {
    Table& part = *parts[(state + bag) % parts.size()];
    const std::string line = part.expect();
    if (line.empty() || line.front() != '#') {
      const BagRow row = part.parse(line);
      if (row.state != state || (state > 0 && row.bag != name)) {
        part.fail("state " + std::to_string(state) + " is missing; is it a part of another run?");
      }
      name = row.bag;
      visit(line, row);
      ++state;
      continue;
    }
    requireInAll(parts, part, line);
    if (line == BAG_TABLE_END && state == 0) break;
    if (line != bagLine(name, state))
      part.fail("'" + line + "' does not end a bag of " + std::to_string(state) + " rows");
    state = 0;
    ++bag;
  }
  for (const auto& part : parts) {
    std::string line;
    if (part->next(line)) part->fail("'" + line + "' after its end");
  }
}

}  // namespace

void mergeBagTables(const std::vector<std::string>& paths, const BagLineVisitor& visit) {
  Tables tables;
  for (const std::string& path : paths) tables.push_back(std::make_unique<Table>(path));
  const auto is_part = [](const auto& table) { return table->isPart(); };
  const auto nb_parts = std::count_if(tables.begin(), tables.end(), is_part);
  if (nb_parts == static_cast<std::ptrdiff_t>(tables.size())) return mergeParts(tables, visit);
  if (nb_parts > 0)
    throw InputError("parts of a run and whole tables are mixed; merge the parts first");
  for (auto& table : tables) {
    for (std::string line; table->next(line);) visit(line, table->parse(line));
  }
}

}  // namespace collision_pairs
