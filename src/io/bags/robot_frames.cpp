#include "robot_frames.h"

#include "collision_pairs/robot_model.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::set<std::string> framesOf(const BagIndex& bag) {
  std::set<std::string> frames;
  for (const BagIndex::Edge& edge : bag.transforms) frames.insert({edge.parent, edge.child});
  return frames;
}

}  // namespace

RobotFrames::RobotFrames(const BagIndex& bag, const std::vector<std::string>& links,
                         const std::string& prefix) {
  if (prefix.empty()) return;
  const std::set<std::string> frames = framesOf(bag);
  for (const std::string& link : links) of_robot_[link] = link + " (without prefix)";
  for (const std::string& link : links) {
    const std::string below = withPrefix(prefix, link), joined = prefix + link;
    const bool is_joined = frames.count(below) == 0 && frames.count(joined) > 0;
    const bool is_plain = link == links.front() && !is_joined && frames.count(below) == 0;
    in_bag_[link] = is_joined ? joined : is_plain && frames.count(link) > 0 ? link : below;
    of_robot_[below] = of_robot_[in_bag_[link]] = link;
    if (frames.count(below) == 0) of_robot_[joined] = link;
  }
}

std::string RobotFrames::ofRobot(const std::string& frame_in_bag) const {
  const std::string frame = withoutLeadingSlash(frame_in_bag);
  const auto found = of_robot_.find(frame);
  return found == of_robot_.end() ? frame : found->second;
}

std::string RobotFrames::inBag(const std::string& frame) const {
  const auto found = in_bag_.find(frame);
  return found == in_bag_.end() ? frame : found->second;
}

std::set<std::string> possiblePrefixes(const BagIndex& bag, const std::vector<std::string>& links) {
  std::set<std::string> prefixes;
  for (const std::string& frame : framesOf(bag)) {
    for (const std::string& link : links) {
      if (endsWith(frame, "/" + link)) {
        prefixes.insert(frame.substr(0, frame.size() - link.size() - 1));
      }
    }
  }
  for (const auto& [topic, names] : bag.joints) {
    const std::string ns = topic.substr(0, topic.rfind('/'));
    if (ns.size() > 1) prefixes.insert(ns.substr(ns.front() == '/' ? 1 : 0));
  }
  return prefixes;
}

}  // namespace collision_pairs
