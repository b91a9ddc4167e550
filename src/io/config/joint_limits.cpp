#include "joint_limits.h"

#include <sstream>

namespace collision_pairs {
namespace {

constexpr double TOLERANCE = 1e-6;  // rad or m

}  // namespace

std::vector<std::string> outsideLimits(const std::vector<std::vector<double>>& states,
                                       const RobotModel& robot, const std::string& what) {
  std::vector<std::string> sentences;
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    const Joint& joint = robot.joints()[j];
    if (!joint.hasLimits() || (joint.lower == 0.0 && joint.upper == 0.0)) continue;
    std::size_t nb_outside = 0, first = 0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      const double q = states[i][j];
      if (q >= joint.lower - TOLERANCE && q <= joint.upper + TOLERANCE) continue;
      if (nb_outside++ == 0) first = i;
    }
    if (nb_outside == 0) continue;
    std::ostringstream text;
    text << "joint '" << joint.name << "' is outside its limits, " << joint.lower << " to "
         << joint.upper << ", at " << nb_outside << ' ' << what
         << (nb_outside == 1 ? "; it is " : "s; the first is ") << what << ' ' << first
         << ", where it is " << states[first][j];
    sentences.push_back(text.str());
  }
  return sentences;
}

}  // namespace collision_pairs
