#include "tool.h"

#include <iostream>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

constexpr int WRONG_INPUT = 2;

}  // namespace

int runTool(CommandLine& command_line, int argc, char** argv, const std::function<void()>& work) {
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
