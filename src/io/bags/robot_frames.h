// The frames of one of several robots in a bag.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "bag_index.h"

namespace collision_pairs {

/// Frames whose names have the robot's prefix P, as P/link or Plink, get those of its links. A
/// frame that has the name of a link, but no prefix, is another robot's, and gets another name;
/// only a root that is not there under its prefixed name ("world") may be without.
class RobotFrames {
 public:
  /// The root is the first link. Without a prefix all names stay.
  RobotFrames(const BagIndex& bag, const std::vector<std::string>& links,
              const std::string& prefix);

  std::string ofRobot(const std::string& frame_in_bag) const;
  std::string inBag(const std::string& frame) const;

 private:
  std::map<std::string, std::string> of_robot_, in_bag_;
};

/// Prefixes with which the bag's frames or topics would be this robot's.
std::set<std::string> possiblePrefixes(const BagIndex& bag, const std::vector<std::string>& links);

}  // namespace collision_pairs
