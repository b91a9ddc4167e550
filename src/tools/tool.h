// Common behaviour of all tools: wrong input produces one line on standard error and exit code 2.
#pragma once

#include <functional>
#include <string>

#include "command_line.h"

namespace collision_pairs {

/// Parses the command line and runs `work`. 0: done; 2: wrong input, reported in one line.
int runTool(CommandLine& command_line, int argc, char** argv, const std::function<void()>& work);

/// "warning: …" on standard error.
void warn(const std::string& message);

}  // namespace collision_pairs
