// Objects and robots of a SimulatedNode.
#include <cmath>
#include <iterator>
#include <limits>

#include "object_messages.h"
#include "scene_message.h"
#include "simulated_node.h"

namespace simulation {
namespace {

enum Change { ADD, ADD_IN_LINK, MOVE, REMOVE, ATTACH, DETACH, CLEAR, LOAD };

SceneChange changeOf(std::uint8_t operation, const std::string& name) {
  SceneChange change;
  change.operation = operation;
  change.object.name = name;
  change.object.pose = poseAt(0.0, 0.0, 0.0);
  return change;
}

}  // namespace

/// That the oldest of the frames which place it has reached; nothing if one was not heard of.
std::optional<Ns> SimulatedNode::newestStampOf(int link, Ns now) const {
  Ns oldest = std::numeric_limits<Ns>::max();
  for (const int i : setup_.pathTo(link)) {
    const SimulatedLink& of = setup_.links[static_cast<std::size_t>(i)];
    if (of.joint == SimulatedLink::FIXED || knowledge_.told(i).is_static) continue;
    const auto& samples = knowledge_.told(i).samples;
    if (samples.empty()) return std::nullopt;
    const auto ahead = samples.upper_bound(now);
    const bool has_reached =
        ahead != samples.begin() && !knowledge_.isTooOld(std::prev(ahead)->first, now);
    // Of a node whose clock is ahead, the first that is.
    oldest = std::min(
        oldest, has_reached || ahead == samples.end() ? std::prev(ahead)->first : ahead->first);
  }
  return oldest;
}

/// As TF has it newest, at the latest time: a clock that is set back a little does not count.
std::optional<Pose> SimulatedNode::newestPoseOf(int link) const {
  std::optional<Ns> stamp = newestStampOf(link, ros_);
  if (stamp == std::numeric_limits<Ns>::max()) stamp = ros_;
  if (!stamp || knowledge_.isTooOld(*stamp, ros_)) return std::nullopt;
  return knowledge_.poseOf(link, *stamp);
}

/// Whether what TF has newest cannot be seen to age.
bool SimulatedNode::isStale(const PoseQuestion& question) const {
  if (question.link < 0) return false;
  bool moves = false;
  for (const int i : setup_.pathTo(question.link)) {
    const bool is_fixed = setup_.links[static_cast<std::size_t>(i)].joint == SimulatedLink::FIXED;
    moves = moves || !(is_fixed || knowledge_.told(i).is_static);
  }
  return moves && question.stamp == 0 && knowledge_.isClockSuspect();
}

bool SimulatedNode::isAnswered(const PoseQuestion& question) const {
  if (question.link < 0) return true;
  if (ros_ == 0 || isStale(question)) return false;
  std::optional<Ns> stamp = question.stamp;
  // At 0 what stands is asked for now, and what moves at its own newest stamp first.
  const auto isDisturbedNow = [&](int link) {
    const Told& told = knowledge_.told(link);
    const Ns newest = told.samples.empty() ? 0 : told.samples.rbegin()->first;
    return !told.is_static && knowledge_.isDisturbed(told, newest, newest);
  };
  const Scenario::Path& path = setup_.pathTo(question.link);
  // It is asked for from the link, from where TF leads elsewhere.
  const auto isLedAway = [&](int link) { return setup_.of(link).is_led_away; };
  if (std::any_of(path.begin(), path.end(), isLedAway)) return false;
  if (stamp == 0 && knowledge_.isPoseOpen(question.link)) return false;
  if (stamp == 0 && std::any_of(path.begin(), path.end(), isDisturbedNow)) return false;
  if (stamp == 0) stamp = newestStampOf(question.link, ros_);
  if (stamp == std::numeric_limits<Ns>::max()) stamp = ros_;
  const bool is_old = question.stamp == 0 && stamp && knowledge_.isTooOld(*stamp, ros_);
  return stamp && !is_old && knowledge_.isCertain(question.link, *stamp);
}

void SimulatedNode::beginScene(const Event& event) {
  const std::string name = "o" + std::to_string(event.other % 3);
  if (scene_works_.size() == 2) return;
  SceneWork work{monitor_.scenes().restrictedTo({}), revision_, objects_, settings_, false};
  PoseQuestion question;
  bool is_known = true;
  try {
    if (event.what == LOAD) {
      work.settings = {};
      if (event.number < 0.0) work.settings.ignored = {event.who};
      if (event.number > 0.7) work.settings.broken = event.other;
      if (event.at.x > 1.0) work.settings.padding = 0.1;
      if (event.at.y > 1.0) work.settings.source_timeout = event.at.y > 1.25 ? 0.0 : 0.4;
      work.may_show_more = true;
      work.job = monitor_.scenes().load(parameters(work.settings));
      scene_works_.push_back(std::move(work));
      return;
    }
    SceneChange change = changeOf(SceneChange::ADD, name);
    const auto known = work.objects.find(name);
    for (const auto& [other, object] : objects_) {
      const bool is_changed = other == name || event.what == CLEAR;
      work.may_show_more = work.may_show_more || (is_changed && object.link >= 0);
    }
    // What is not possible becomes what is.
    int what = event.what;
    if (known == work.objects.end()) {
      if (what == MOVE || what == ATTACH || what == DETACH) what = ADD;
    } else if (known->second.link < 0) {
      if (what == DETACH) what = ATTACH;
      if (what == ATTACH && known->second.solid.is_box) what = REMOVE;
    } else if (what == MOVE || what == ATTACH) {
      what = DETACH;
    }
    auto X_WL = newestPoseOf(event.who);
    const bool is_certain =
        !knowledge_.isLiedAbout(event.who) && !knowledge_.isUnsettled(event.who);
    switch (what) {
      case ADD:
      case ADD_IN_LINK: {
        const bool is_box = event.number > 0.3;
        const Solid solid{is_box, 0.15, {0.2, 0.3, 0.1}};
        const auto edges = setup_.inSpace({0.4, 0.6, 0.2, 0.0});
        change.object.primitives = {
            is_box ? primitive(shape_msgs::SolidPrimitive::BOX, {edges[0], edges[1], edges[2]})
                   : primitive(shape_msgs::SolidPrimitive::SPHERE, {0.15})};
        change.object.pose = message(event.at);
        PlainObject object{solid, -1, event.at, {}};
        const bool is_attached = event.number > -0.6 && event.number < -0.2;
        if (what == ADD_IN_LINK && is_attached) {
          change.object.header.frame_id = change.object.attached_link = linkName(event.who);
          object.link = event.who;
        } else if (what == ADD_IN_LINK) {
          if (!is_certain) return;
          change.object.header.frame_id = linkName(event.who);
          question = {event.who};
          if (event.number < -0.6 && ros_ > BEGIN) {
            question.stamp = ros_ - static_cast<Ns>(3e8);
            change.object.header.stamp.fromNSec(static_cast<std::uint64_t>(question.stamp));
            X_WL = knowledge_.poseOf(event.who, question.stamp);
            if (knowledge_.isOpen(event.who, question.stamp)) return;
          }
          object.X_PO = X_WL.value_or(Pose{1e9, 0, 0, 0}) * event.at;
        }
        work.objects[name] = object;
        break;
      }
      case MOVE:
        change.operation = SceneChange::MOVE;
        change.object.pose = message(event.at);
        known->second.X_PO = event.at;
        break;
      case REMOVE:
        change.operation = SceneChange::REMOVE;
        is_known = known != work.objects.end();
        work.objects.erase(name);
        for (auto& entry : work.objects) {
          PlainObject& object = entry.second;
          const bool is_named = object.touched_objects.erase(name) > 0;
          work.may_show_more = work.may_show_more || (is_named && object.link >= 0);
        }
        break;
      case ATTACH: {
        if (!is_certain) return;
        if (known->second.solid.is_box) return;  // two boxes may meet, which is not judged
        change.operation = SceneChange::ATTACH;
        change.object.attached_link = linkName(event.who);
        PlainObject& object = known->second;
        object.link = event.who;
        question = {event.who};
        if (event.number > 0.0)
          object.touches = {(event.who + 1) % static_cast<int>(setup_.links.size())};
        for (const int link : object.touches) change.object.touch_links.push_back(linkName(link));
        for (const auto& [touched, unused] : work.objects) {
          if (event.number > -0.3 || touched == name) continue;
          object.touched_objects.insert(touched);
          change.object.touch_links.push_back(touched);
        }
        object.X_PO = X_WL ? inverse(*X_WL) * object.X_PO : Pose{1e9, 0, 0, 0};
        break;
      }
      case DETACH: {
        if (knowledge_.isLiedAbout(known->second.link)) return;
        if (knowledge_.isUnsettled(known->second.link)) return;
        change.operation = SceneChange::DETACH;
        PlainObject& object = known->second;
        question = {object.link};
        const auto X_WP = newestPoseOf(object.link);
        object.X_PO = X_WP ? *X_WP * object.X_PO : Pose{1e9, 0, 0, 0};
        object.link = -1;
        object.touches.clear();
        object.touched_objects.clear();
        break;
      }
      default:
        change.operation = SceneChange::CLEAR;
        work.objects.clear();
    }
    // Who attaches or detaches means now, whatever the stamp.
    const bool is_hung = what == ATTACH || what == DETACH;
    if (is_hung && event.at.x > 0.0) change.object.header.stamp = toTime(stampOf(0.3));
    work.job = monitor_.scenes().update({change}, readAdded({change}, noMeshLoader()));
    for (const auto& [other, object] : work.objects) {
      if (object.X_PO.x > 1e8)
        return fail("object " + other + " is placed by a link that is nowhere");
    }
    if (!is_known) fail("an object is removed that is not there");
    if (isStale(question)) fail("an object is placed although the clock stands still");
    scene_works_.push_back(std::move(work));
  } catch (const InputError& error) {
    if (is_known && isAnswered(question)) fail(std::string("a change is refused: ") + error.what());
  }
}

void SimulatedNode::endScene(bool is_first) {
  if (scene_works_.empty()) return;
  const auto at = is_first ? scene_works_.begin() : std::prev(scene_works_.end());
  SceneWork work = std::move(*at);
  scene_works_.erase(at);
  const ActiveScenePtr before = monitor_.scenes().active();
  try {
    work.job.run();
  } catch (const InputError& error) {
    return fail(std::string("a scene is refused: ") + error.what());
  }
  const bool is_of_now = work.revision == revision_;
  if (monitor_.scenes().take(work.job) != is_of_now) return fail("a scene is built of an old one");
  if (!is_of_now) return;
  replaced_ = before;
  ++revision_;
  changed_ = ros_;
  objects_ = work.objects;
  const bool is_other_source = settings_.source_timeout != work.settings.source_timeout;
  settings_ = work.settings;
  if (is_other_source && setup_.has_cloud) forgetClouds();
  readAgain();
  judgeObjects();
  if (!work.may_show_more) return;
  complete_revision_ = revision_;
  seen_.reset();
}

void SimulatedNode::judgeObjects() {
  const SceneObjects& known = *monitor_.scenes().objects();
  if (known.size() != objects_.size()) return fail("the objects are others");
  for (const auto& [name, object] : objects_) {
    const auto found = known.find(name);
    if (found == known.end()) return fail("there is no object " + name);
    const RigidObject& is = found->second.object;
    const std::string link = object.link < 0 ? "" : linkName(object.link);
    const Eigen::Vector3d p = inSpace(object.X_PO);
    if (is.attached_link != link || (is.X_PO.translation() - p).norm() > 1e-5) {
      fail(name + " is elsewhere, or on another link");
    }
    if (is.touch_links.size() != object.touches.size() + object.touched_objects.size()) {
      fail(name + " may touch others");
    }
  }
}

/// What was recorded of the scene makes the same scene.
void SimulatedNode::readAgain() {
  const Scene message = toMessage(monitor_.scenes().stored());
  if (message.revision != revision_) fail("a scene's message has another revision");
  if (static_cast<Ns>(message.header.stamp.toNSec()) != ros_) {
    fail("a scene's message has another time");
  }
  judgeListed(message);
  read_again_ = std::make_unique<SceneStore>(monitor_.transforms());
  const MeshLoader none = noMeshLoader();
  SceneJob job = read_again_->load(parametersOf(message, none, [](const std::string&) {}),
                                   objectsOf(message, none));
  job.run();
  read_again_->take(job);
}

int SimulatedNode::bodyOf(int link) const {
  while (link >= 0 && setup_.links[static_cast<std::size_t>(link)].joint == SimulatedLink::FIXED) {
    link = setup_.links[static_cast<std::size_t>(link)].parent;
  }
  return link;
}

bool SimulatedNode::isCheckedAgainst(int link, const PlainObject& object) const {
  if (settings_.ignored.count(link) > 0 || object.touches.count(link) > 0) return false;
  return object.link < 0 || bodyOf(object.link) != bodyOf(link);
}

}  // namespace simulation
