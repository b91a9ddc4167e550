// What all tools do alike: one line on standard error that says what and where, exit code 2.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace collision_pairs {

/// Parses the command line and runs `work`. 0: done; 2: wrong input, said in one line.
int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& work);

/// "warning: …" on standard error.
void warn(const std::string& message);

/// "a, b, c"
std::string joined(const std::vector<std::string>& words);

}  // namespace collision_pairs
