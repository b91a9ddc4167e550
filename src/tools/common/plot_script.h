// Scripts beside a tool that draw what it found.
#pragma once

#include <string>
#include <vector>

namespace collision_pairs {

/// Runs a script that lies beside this program; its output goes to standard error. False if it
/// fails. Throws InputError if it is not there.
bool runPlotScript(const std::string& name, const std::vector<std::string>& arguments);

}  // namespace collision_pairs
