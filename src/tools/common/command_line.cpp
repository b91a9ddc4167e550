#include "command_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <system_error>

#include <boost/crc.hpp>

#include "collision_pairs/input_error.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

namespace po = boost::program_options;
namespace fs = std::filesystem;

constexpr unsigned LINE_LENGTH = 100, LEAST_DESCRIPTION_LENGTH = 66;  // characters of --help
constexpr std::size_t MOST_EDITS = 2;                                 // of a misspelled option

/// "; did you mean '--seed'?", or empty if no option is spelled like it.
std::string suggestion(const std::string& given, const po::options_description& options) {
  std::vector<std::string> names;
  for (const auto& option : options.options()) names.push_back("--" + option->long_name());
  return didYouMean(given, names, MOST_EDITS);
}

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::exists(a, error) && fs::exists(b, error)) {
    return fs::is_regular_file(a, error) && fs::equivalent(a, b, error);
  }
  const auto whole = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(path, error), error);
  };
  return whole(a) == whole(b);
}

}  // namespace

CommandLine::CommandLine(std::string tool, std::string purpose)
    : tool_(std::move(tool)),
      purpose_(std::move(purpose)),
      options_("Options", LINE_LENGTH, LEAST_DESCRIPTION_LENGTH) {
  options_.add_options()("help,h", "print this and exit");
}

void CommandLine::operand(std::string& word, const std::string& value_name,
                          const std::string& help) {
  operand_ = &word;
  operand_name_ = value_name;
  operand_help_ = help;
}

void CommandLine::operands(std::vector<std::string>& words, const std::string& value_name,
                           const std::string& help) {
  operands_ = &words;
  operand_name_ = value_name;
  operand_help_ = help;
}

void CommandLine::requiredOption(const std::string& name, std::string& value,
                                 const std::string& value_name, const std::string& help) {
  required_ += " --" + name + ' ' + value_name;
  inputs_.emplace_back("--" + name, &value);
  options_.add_options()(name.c_str(), po::value(&value)->value_name(value_name)->required(),
                         help.c_str());
}

void CommandLine::input(const std::string& name, std::string& path, const std::string& value_name,
                        const std::string& help) {
  option(name, path, value_name, help);
  inputs_.emplace_back("--" + name, &path);
}

void CommandLine::output(const std::string& name, std::string& path, const std::string& value_name,
                         const std::string& help, const std::string& ending,
                         const std::string& replaced) {
  option(name, path, value_name, help);
  outputs_.push_back({"--" + name, &path, ending, "--" + replaced});
}

void CommandLine::flag(const std::string& name, bool& value, const std::string& help) {
  options_.add_options()(name.c_str(), po::bool_switch(&value), help.c_str());
}

void CommandLine::metres(const std::string& name, double& value, const std::string& help) {
  option(name, value, "METRES", help);
  metres_.emplace_back(name, &value);
}

void CommandLine::givenOptions(std::string& text, const std::string& but) {
  given_ = &text;
  not_in_given_ = but;
}

void CommandLine::together(const std::string& first, const std::string& second) {
  together_.emplace_back(first, second);
  together_.emplace_back(second, first);
}

bool CommandLine::parse(int argc, char** argv) {
  po::parsed_options parsed(&options_);
  bool is_described = false;
  try {
    constexpr int STYLE =
        po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    parsed = po::command_line_parser(argc, argv).options(options_).style(STYLE).run();
    po::variables_map values;
    po::store(parsed, values);
    if (values.count("help") > 0) {
      printHelp();
      return false;
    }
    is_described = given_ != nullptr && values.count(not_in_given_) > 0;
    refuseNegativeCounts(parsed);
    takeOperands(parsed);
    for (const auto& [given, needed] : together_) {
      const bool is_given = values.count(given) > 0 && !values[given].defaulted();
      const bool is_there = values.count(needed) > 0 && !values[needed].defaulted();
      if (is_given && !is_there) throw InputError("--" + given + " requires --" + needed);
    }
    po::notify(values);
  } catch (const po::unknown_option& error) {
    throw InputError(error.what() + suggestion(error.get_option_name(), options_) + "; see " +
                     tool_ + " --help");
  } catch (const std::exception& error) {
    throw InputError(std::string(error.what()) + "; see " + tool_ + " --help");
  }
  for (const auto& [name, value] : metres_) {
    if (*value >= 0.0 && std::isfinite(*value)) continue;
    throw InputError("--" + name + " must be a finite number of metres, 0 or more");
  }
  refuseOverwriting();
  if (is_described) describe(parsed);
  return true;
}

void CommandLine::describe(const po::parsed_options& parsed) const {
  std::set<std::string> options;  // in whatever order they are given
  for (const po::option& option : parsed.options) {
    const std::string name = "--" + option.string_key;
    const bool is_output = std::any_of(outputs_.begin(), outputs_.end(),
                                       [&](const Output& output) { return output.option == name; });
    if (option.string_key.empty() || option.string_key == not_in_given_ || is_output) continue;
    std::string text = name;
    for (const std::string& word : option.value) {
      text += ' ' + word;
      std::error_code error;
      if (!fs::is_regular_file(word, error)) continue;
      const std::string content = readBinaryFile(word);
      boost::crc_32_type checksum;
      checksum.process_bytes(content.data(), content.size());
      text += formatted(" (%08x)", static_cast<unsigned>(checksum.checksum()));
    }
    options.insert(text);
  }
  *given_ = joined({options.begin(), options.end()}, " ");
  std::replace(given_->begin(), given_->end(), '\n', ' ');
}

void CommandLine::refuseOverwriting() const {
  std::vector<std::pair<std::string, std::string>> taken;  // what it is, and its path
  if (operand_ != nullptr) taken.emplace_back(operand_name_, *operand_);
  if (operands_ != nullptr) {
    for (const std::string& word : *operands_) taken.emplace_back(operand_name_, word);
  }
  for (const auto& [option, path] : inputs_) {
    if (!path->empty()) taken.emplace_back(option, *path);
  }
  for (const Output& output : outputs_) {
    if (output.path->empty() || *output.path == "-") continue;
    const std::string path = *output.path + output.ending;
    for (const auto& [what, other] : taken) {
      if (what == output.replaced || !isSameFile(path, other)) continue;
      throw InputError(output.option + ' ' + *output.path + ": would overwrite " + what + " (" +
                       other + ")");
    }
    taken.emplace_back(output.option, path);
  }
}

// Boost reads "-1" as the largest unsigned number.
void CommandLine::refuseNegativeCounts(const po::parsed_options& parsed) const {
  for (const po::option& option : parsed.options) {
    if (counts_.count(option.string_key) > 0 && option.value.front().rfind('-', 0) == 0) {
      throw InputError("--" + option.string_key + ' ' + option.value.front() +
                       ": must be 0 or more");
    }
  }
}

void CommandLine::takeOperands(const po::parsed_options& parsed) {
  std::vector<std::string> words;
  for (const po::option& option : parsed.options) {
    if (option.string_key.empty()) words.push_back(option.value.front());
  }
  if (words.empty()) throw InputError(operand_name_ + " is missing: " + operand_help_);
  if (operands_ != nullptr) {
    *operands_ = words;
  } else if (words.size() == 1) {
    *operand_ = words.front();
  } else {
    throw InputError("'" + words[1] + "': only one " + operand_name_ + " was expected");
  }
}

void CommandLine::printHelp() const {
  std::cout << purpose_ << "\n\nUsage: " << tool_ << ' ' << operand_name_ << required_
            << " [OPTIONS]\n  " << operand_name_ << ": " << operand_help_ << "\n\n"
            << options_;
}

int runTool(CommandLine& command_line, int argc, char** argv, const std::function<void()>& work) {
  constexpr int WRONG_INPUT = 2;
  try {
    if (command_line.parse(argc, argv)) work();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "error: " << InputError(error.what()).what() << '\n';
    return WRONG_INPUT;
  }
}

void warn(const std::string& message) {
  std::cerr << "warning: " << InputError(message).what() << '\n';
}

}  // namespace collision_pairs
