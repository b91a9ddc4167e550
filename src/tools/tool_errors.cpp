#include "tool_errors.h"

#include <algorithm>
#include <iostream>

namespace collision_pairs {
namespace {

constexpr int WRONG_INPUT = 2;

int refuse(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::cerr << "error: " << message << '\n';
  return WRONG_INPUT;
}

}  // namespace

int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& work) {
  try {
    app.parse(argc, argv);
    work();
    return 0;
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return refuse(std::string(error.what()) + "; see " + app.get_name() + " --help");
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

void warn(const std::string& message) { std::cerr << "warning: " << message << '\n'; }

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace collision_pairs
