// The parts of an SRDF that a collision check needs. Named states are not read.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace collision_pairs {

struct Srdf {
  using LinkPair = std::pair<std::string, std::string>;  ///< first < second

  std::string robot;                        ///< its name; empty: not said
  std::vector<std::string> disabled_links;  ///< disable_default_collisions
  std::vector<LinkPair> enabled_pairs;      ///< enable_collisions
  std::vector<LinkPair> disabled_pairs;     ///< disable_collisions

  /// A <group> as listed; its members need not exist.
  struct Group {
    std::string name;
    std::vector<std::string> links, joints, subgroups;
    std::vector<std::pair<std::string, std::string>> chains;  ///< base link, tip link
  };
  struct VirtualJoint {
    std::string name, child_link;
  };
  std::vector<Group> groups;
  std::vector<VirtualJoint> virtual_joints;
  /// Joints without a drive. They move as TF says, so their links are checked like all others.
  std::vector<std::string> passive_joints;
  /// Elements and attributes that are unknown, with their lines.
  std::vector<std::string> warnings;

  /// Throws InputError with the line, also for a URDF, and where a name is within two letters of
  /// one that is read. Repeated pairs and a link paired with itself are common in generated files
  /// and are ignored.
  static Srdf fromXml(const std::string& xml);

  /// The disabled pairs of `links`, in MoveIt's order: links disabled by default, then pairs
  /// enabled again, then pairs disabled. O(pairs).
  std::set<LinkPair> switchedOff(const std::vector<std::string>& links) const;

  /// Names in the SRDF that are not in `links`, sorted, for a warning.
  std::vector<std::string> unknownLinks(const std::vector<std::string>& links) const;
};

}  // namespace collision_pairs
