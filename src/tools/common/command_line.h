// The command line of a tool, parsed by Boost.Program_options, and what all tools do with it.
#pragma once

#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <boost/program_options.hpp>

namespace collision_pairs {

/// The operands and options of a tool: each is bound to a variable, whose initial value is the
/// default and is printed by --help. Names are given without dashes.
class CommandLine {
 public:
  CommandLine(std::string tool, std::string purpose);

  /// The words that belong to no option: exactly one, or one or more.
  void operand(std::string& word, const std::string& value_name, const std::string& help);
  void operands(std::vector<std::string>& words, const std::string& value_name,
                const std::string& help);

  /// T: a number, a std::string, or a std::vector of them, which takes all words up to the next
  /// option or to `--`, and may be repeated.
  template <typename T>
  void option(const std::string& name, T& value, const std::string& value_name,
              const std::string& help);
  /// A required option that names a file to be read.
  void requiredOption(const std::string& name, std::string& value, const std::string& value_name,
                      const std::string& help);
  /// A file to be read; empty: none.
  void input(const std::string& name, std::string& path, const std::string& value_name,
             const std::string& help);
  /// A file to be written, or with `ending` one in that folder; empty: none. Refused if it is an
  /// operand, an input but `replaced`, or another output too.
  void output(const std::string& name, std::string& path, const std::string& value_name,
              const std::string& help, const std::string& ending = "",
              const std::string& replaced = "");
  /// A finite number, 0 or more.
  void metres(const std::string& name, double& value, const std::string& help);
  void flag(const std::string& name, bool& value, const std::string& help);
  /// If `but` is given, sets `text` to all other options that are but outputs, on one line, with a
  /// checksum of the content after each file that they name.
  void givenOptions(std::string& text, const std::string& but);
  /// The two options must be given together.
  void together(const std::string& first, const std::string& second);

  /// False if --help was given: it was printed, and no variable is set. Throws InputError that
  /// names the option.
  bool parse(int argc, char** argv);

 private:
  void refuseNegativeCounts(const boost::program_options::parsed_options& parsed) const;
  void takeOperands(const boost::program_options::parsed_options& parsed);
  void refuseOverwriting() const;
  void describe(const boost::program_options::parsed_options& parsed) const;
  void printHelp() const;

  std::string tool_, purpose_, operand_name_, operand_help_;
  std::string required_;  ///< options as shown in the usage line
  std::string* operand_ = nullptr;
  std::vector<std::string>* operands_ = nullptr;
  std::string* given_ = nullptr;
  std::string not_in_given_;
  boost::program_options::options_description options_;
  std::set<std::string> counts_;  ///< options with unsigned values
  std::vector<std::pair<std::string, std::string>> together_;
  std::vector<std::pair<std::string, const double*>> metres_;
  struct Output {
    std::string option;
    const std::string* path;
    std::string ending, replaced;
  };
  std::vector<Output> outputs_;
  std::vector<std::pair<std::string, const std::string*>> inputs_;  ///< by option
};

template <typename T>
void CommandLine::option(const std::string& name, T& value, const std::string& value_name,
                         const std::string& help) {
  auto* semantic = boost::program_options::value(&value)->value_name(value_name);
  if constexpr (std::is_same_v<T, std::vector<std::string>>) {
    semantic->multitoken();
  } else if (std::is_arithmetic_v<T> || value != T()) {
    std::ostringstream shown;
    shown << value;
    semantic->default_value(value, shown.str());
  }
  if (std::is_unsigned_v<T>) counts_.insert(name);
  options_.add_options()(name.c_str(), semantic, help.c_str());
}

/// Parses the command line and runs `work`; returns the exit code of the tool. 0: done; 2: wrong
/// input, reported in one line on standard error.
int runTool(CommandLine& command_line, int argc, char** argv, const std::function<void()>& work);

/// main() of a tool, whose `declare` binds its Options.
template <class Options, class Work>
int runTool(int argc, char** argv, CommandLine command_line,
            void (*declare)(CommandLine&, Options&), const Work& work) {
  Options options;
  declare(command_line, options);
  return runTool(command_line, argc, argv, [&] { work(options); });
}

/// "warning: …" on standard error.
void warn(const std::string& message);

}  // namespace collision_pairs
