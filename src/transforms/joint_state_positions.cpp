#include "joint_state_positions.h"

#include <cmath>
#include <iterator>

#include "user_text.h"

namespace collision_pairs {

std::map<std::string, double> positionsIn(const sensor_msgs::JointState& state) {
  std::map<std::string, double> positions;
  if (differInNumber(state)) return positions;
  for (std::size_t i = 0; i < state.name.size(); ++i) {
    positions.emplace(withoutLeadingSlash(state.name[i]), state.position[i]);  // the first stays
  }
  return positions;
}

std::map<std::string, double> finitePositionsIn(const sensor_msgs::JointState& state) {
  std::map<std::string, double> positions = positionsIn(state);
  for (auto entry = positions.begin(); entry != positions.end();) {
    entry = std::isfinite(entry->second) ? std::next(entry) : positions.erase(entry);
  }
  return positions;
}

}  // namespace collision_pairs
