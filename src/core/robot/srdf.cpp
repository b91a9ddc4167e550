#include "collision_pairs/srdf.h"

#include <algorithm>

#include "xml_file.h"
#include "xml_names.h"

namespace collision_pairs {
namespace {

Srdf::LinkPair ordered(const std::string& a, const std::string& b) {
  return a < b ? Srdf::LinkPair(a, b) : Srdf::LinkPair(b, a);
}

std::vector<Srdf::LinkPair> readPairs(const tinyxml2::XMLElement& robot, const char* tag) {
  std::vector<Srdf::LinkPair> pairs;
  for (const auto* element : childrenOf(robot, tag)) {
    const std::string first = requiredAttribute(*element, "link1", SRDF);
    const std::string second = requiredAttribute(*element, "link2", SRDF);
    if (first != second) pairs.push_back(ordered(first, second));
  }
  return pairs;
}

std::vector<std::string> readNames(const tinyxml2::XMLElement& parent, const char* tag,
                                   const char* attribute = "name") {
  std::vector<std::string> names;
  for (const auto* element : childrenOf(parent, tag)) {
    names.push_back(requiredAttribute(*element, attribute, SRDF));
  }
  return names;
}

}  // namespace

Srdf Srdf::fromXml(const std::string& xml) {
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement* robot = parseXml(document, xml, "robot", SRDF);
  const auto* link = robot->FirstChildElement("link");
  if (link) failAt(*link, SRDF, "it has a <link>, so it is a URDF");
  Srdf srdf;
  srdf.warnings = checkNames(*robot, srdfGrammar(), SRDF);
  if (const char* name = robot->Attribute("name")) srdf.robot = name;
  srdf.disabled_pairs = readPairs(*robot, "disable_collisions");
  srdf.enabled_pairs = readPairs(*robot, "enable_collisions");
  srdf.disabled_links = readNames(*robot, "disable_default_collisions", "link");
  for (const auto* element : childrenOf(*robot, "group")) {
    Group group;
    group.name = requiredAttribute(*element, "name", SRDF);
    group.links = readNames(*element, "link");
    group.joints = readNames(*element, "joint");
    group.subgroups = readNames(*element, "group");
    for (const auto* chain : childrenOf(*element, "chain")) {
      group.chains.emplace_back(requiredAttribute(*chain, "base_link", SRDF),
                                requiredAttribute(*chain, "tip_link", SRDF));
    }
    srdf.groups.push_back(std::move(group));
  }
  for (const auto* element : childrenOf(*robot, "virtual_joint")) {
    srdf.virtual_joints.push_back({requiredAttribute(*element, "name", SRDF),
                                   requiredAttribute(*element, "child_link", SRDF)});
  }
  srdf.passive_joints = readNames(*robot, "passive_joint");
  return srdf;
}

std::set<Srdf::LinkPair> Srdf::switchedOff(const std::vector<std::string>& links) const {
  std::set<LinkPair> off;
  for (const std::string& disabled : disabled_links) {
    for (const std::string& other : links) {
      if (other != disabled) off.insert(ordered(disabled, other));
    }
  }
  for (const LinkPair& pair : enabled_pairs) off.erase(pair);
  off.insert(disabled_pairs.begin(), disabled_pairs.end());
  return off;
}

std::vector<std::string> Srdf::unknownLinks(const std::vector<std::string>& links) const {
  const std::set<std::string> known(links.begin(), links.end());
  std::set<std::string> unknown;
  const auto note = [&](const std::string& link) {
    if (known.count(link) == 0) unknown.insert(link);
  };
  for (const auto* pairs : {&enabled_pairs, &disabled_pairs}) {
    for (const LinkPair& pair : *pairs) {
      note(pair.first);
      note(pair.second);
    }
  }
  std::for_each(disabled_links.begin(), disabled_links.end(), note);
  return {unknown.begin(), unknown.end()};
}

}  // namespace collision_pairs
