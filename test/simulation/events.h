// What happens to a monitor: a robot, and a list of events from a seed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "plain_geometry.h"

namespace simulation {

/// Of a tree of links, each a ball in its frame's origin.
struct SimulatedLink {
  enum Joint { FLOATING, SLIDING, TURNING, FIXED };
  int parent;  ///< -1: the root, which has no geometry
  Joint joint;
  Pose X_PJ;
  double radius;
  bool is_static = false;   ///< published on /tf_static
  bool is_listed = false;   ///< … as static_joints allows
  bool is_relayed = false;  ///< a second node says the same of it
  bool is_double = false;   ///< there is a second ball in the first
  int hung_by = -1;         ///< link that is fixed to it, by whose frame TF hangs both; -1: its own
  bool is_led_away = false;  ///< its own frame hangs on one that nothing connects, on /tf_static
};

inline std::string linkName(int link) {
  std::string name = "root";
  if (link >= 0) name = 'l' + std::to_string(link);
  return name;
}

inline std::string jointName(int link) { return 'j' + std::to_string(link); }

struct Scenario {
  std::vector<SimulatedLink> links;
  double max_pose_age = 1.0, max_transform_age = 1.0;  // s
  bool is_simulated = false, allow_paused = false;
  double clock_begins = 0.0;  ///< s of wall time; before, ROS time is 0
  int cycle_through = 0;      ///< link on which the root is hung by who makes a cycle
  bool has_cloud = false;
  bool has_other_camera = false;  ///< which a second node tells of, in the same frame
  bool has_world = false;         ///< of a ball that is far away
  int camera_on = -1;             ///< link; -1: the root
  Pose X_LC;
  /// The camera is on a mast on that link, without geometry, whose joint may move; on /tf_static.
  bool has_mast = false, is_mast_listed = false;
  bool isCameraHeld() const { return has_mast && !is_mast_listed; }
  /// Reports are in a frame of TF that is no link. Links without a parent hang in it, each the root
  /// of a robot of its own.
  bool is_apart = false;
  int fixed_frame = -1;    ///< W: a link; -1: the root
  bool is_marked = false;  ///< … or a frame that is no link, which /tf_static has in its place
  int first_axis = 0;      ///< of the world, along which x of a Pose is; y and z along those after
  std::array<double, 3> inSpace(const Pose& p) const {
    const double of[] = {p.x, p.y, p.z};
    const auto at = [&](int axis) { return of[(axis + 3 - first_axis) % 3]; };
    return {at(0), at(1), at(2)};
  }
  /// Of a turn about z: x, y, z, w.
  std::array<double, 4> quaternion(double yaw) const {
    const auto v = inSpace({0.0, 0.0, std::sin(0.5 * yaw), 0.0});
    return {v[0], v[1], v[2], std::cos(0.5 * yaw)};
  }
  std::string frame() const { return is_marked ? "mark" : linkName(fixed_frame); }
  const SimulatedLink& of(int link) const { return links[static_cast<std::size_t>(link)]; }
  /// Of TF, which places the link in its parent; and where that frame is in the link.
  std::string hungFrame(int link) const {
    return linkName(of(link).hung_by < 0 ? link : of(link).hung_by);
  }
  Pose inHung(int link) const { return of(link).hung_by < 0 ? Pose() : of(of(link).hung_by).X_PJ; }

  /// Links whose joints lie between a link and W: up from the link, and up from W.
  struct Path {
    std::vector<int> links;
    std::size_t nb_up;
    auto begin() const { return links.begin(); }
    auto end() const { return links.end(); }
  };
  std::vector<Path> paths;  ///< by link + 1
  bool isOnPath(int link) const {
    return std::any_of(paths.begin() + 1, paths.end(), [&](const Path& path) {
      return std::find(path.begin(), path.end(), link) != path.end();
    });
  }
  const Path& pathTo(int link) const { return paths[static_cast<std::size_t>(link + 1)]; }
  void findPaths() {
    const auto above = [&](int link) {
      std::vector<int> all;
      for (; link >= 0; link = links[static_cast<std::size_t>(link)].parent) all.push_back(link);
      return all;
    };
    for (int link = -1; link < static_cast<int>(links.size()); ++link) {
      std::vector<int> up = above(link), down = above(fixed_frame);
      for (; !up.empty() && !down.empty() && up.back() == down.back(); down.pop_back())
        up.pop_back();
      const std::size_t nb_up = up.size();
      up.insert(up.end(), down.begin(), down.end());
      paths.push_back({up, nb_up});
    }
  }

  std::string text() const {
    std::string all = "W " + linkName(fixed_frame) + (is_marked ? " marked" : "") + ", ages " +
                      std::to_string(max_pose_age) + " " + std::to_string(max_transform_age);
    all += ", axis " + std::to_string(first_axis);
    if (is_simulated) all += ", simulated";
    if (is_apart) all += ", apart";
    if (has_cloud) all += ", camera on " + linkName(camera_on);
    all += ", cycles through " + linkName(cycle_through);
    for (int i = 0; i < static_cast<int>(links.size()); ++i) {
      const SimulatedLink& link = links[static_cast<std::size_t>(i)];
      const char* const joints[] = {"floats", "slides", "turns", "fixed"};
      all += "\n" + linkName(i) + " on " + linkName(link.parent) + ", " + joints[link.joint] +
             (link.is_static ? ", static" : "") + (link.is_listed ? ", listed" : "") +
             (link.hung_by < 0 ? "" : ", hung by " + linkName(link.hung_by)) +
             (link.is_led_away ? ", led away" : "");
    }
    return all + '\n';
  }
  int baseOf(int link) const {
    while (!isBase(link)) link = links[static_cast<std::size_t>(link)].parent;
    return link;
  }
  bool isBase(int link) const {
    return is_apart && links[static_cast<std::size_t>(link)].parent < 0;
  }
};

struct Event {
  enum Kind {
    WAIT,
    PUBLISH,      ///< who: link; at: its joint, or where it floats; what: 7: a gap after the last
    REPEAT,       ///< the last of link `who`, by another node
    BREAK,        ///< what: kind of a transform that is not usable; of link `who`
    LIE,          ///< another node says that link `who` is elsewhere; what: 1: on /tf_static, 2: in
                  ///< another parent, 3: that the root hangs on a link, which makes a cycle; 4: at
                  ///< the stamp of a truth, 6 and 7: `number` m from the last one
    SWITCH,       ///< to the other of /tf and /tf_static, of link `who`
    CAMERA,       ///< its mount, on /tf_static
    STEP_CLOCK,   ///< by up to 8 s; what: 0 to 6: by less, as of a computer that is being set
    RUN_CLOCK,    ///< at `number` times the speed
    CLOUD,        ///< what: kind; at: where its obstacle is, but for kinds that have it beside link
                  ///< `who`, or where it was; number > 0.3: of the other camera
    CLOUD_BEGIN,  ///< of the work on a cloud
    CLOUD_END,
    CLEAR,        ///< all clouds
    SCENE_BEGIN,  ///< what: the change, or to load; who: object, or link to ignore
    SCENE_END,
    JOINTS,   ///< joint states; what: 6: of link `who` alone, 7: not finite
    REHANG,   ///< link `who` in another parent, which is fixed to its own, or back
    REQUEST,  ///< what: of a stamp `number` from now, of joints at `at`, of a part of the scene
    NB_KINDS
  };
  Kind kind = WAIT;
  double dt = 0.0;   ///< s since the event before
  double lag = 0.0;  ///< s, of the stamp after the clock
  int who = 0, what = 0, other = 0;
  double number = 0.0;
  Pose at;

  std::string text() const {
    char line[300];
    std::snprintf(line, sizeof line,
                  "  {Event::Kind(%d), %.17g, %.17g, %d, %d, %d, %.17g, {%.17g, %.17g, %.17g, "
                  "%.17g}},\n",
                  kind, dt, lag, who, what, other, number, at.x, at.y, at.z, at.yaw);
    return line;
  }
};

class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  Scenario setup() {
    Scenario made;
    const int nb_links = 2 + integer(4);
    const bool floats = integer(2) == 0;
    made.is_apart = integer(3) == 0;
    for (int i = 0; i < nb_links; ++i) {
      SimulatedLink link;
      link.parent = integer(i + 1) - 1;
      const bool is_base = made.is_apart && link.parent < 0;
      const bool may_be_fixed = link.parent >= 0;
      link.joint = may_be_fixed && integer(4) == 0 ? SimulatedLink::FIXED
                   : floats || is_base             ? SimulatedLink::FLOATING
                   : integer(2) == 0               ? SimulatedLink::SLIDING
                                                   : SimulatedLink::TURNING;
      link.X_PJ = {0.0, std::pow(2.0, i), 0.0, 0.0};  // sums of powers of two differ
      if (link.joint == SimulatedLink::FLOATING) link.X_PJ = {};
      link.radius = 0.2 + 0.25 * real();
      link.is_static = integer(8) == 0;
      link.is_listed = integer(6) != 0;
      link.is_relayed = integer(6) == 0;
      link.is_double = integer(3) == 0;
      made.links.push_back(link);
    }
    const double ages[] = {1.0, 1.0, 0.4, 0.0}, gaps[] = {1.0, 0.5};
    made.max_pose_age = ages[integer(4)];
    made.max_transform_age = gaps[integer(2)];
    made.is_simulated = integer(2) == 0;
    made.allow_paused = integer(4) == 0;
    if (made.is_simulated && integer(6) == 0) made.clock_begins = 1.5 * real();
    made.cycle_through = integer(nb_links);
    made.has_cloud = integer(2) == 0;
    made.has_world = integer(5) == 0;
    made.camera_on = integer(3) == 0 ? integer(nb_links) : -1;
    made.X_LC = {-3.0, 0.0, 0.0, 0.3};
    made.has_mast = made.has_cloud && (made.camera_on >= 0 || !made.is_apart) && integer(6) == 0;
    made.is_mast_listed = integer(2) == 0;
    made.has_other_camera = integer(4) == 0;
    if (integer(4) == 0) made.fixed_frame = integer(nb_links);
    made.is_marked = integer(6) == 0;
    if (integer(6) == 0) addHungByAnother(made);
    made.first_axis = integer(3);
    made.findPaths();
    return made;
  }

  std::vector<Event> events(const Scenario& setup, int count) {
    const int nb_links = static_cast<int>(setup.links.size());
    // Each sequence has its own faults, some have one, and some have none.
    double weights[Event::NB_KINDS] = {4,  60, 2,  3, 3, 0.5, 1,  1, 1,
                                       12, 16, 16, 1, 4, 4,   20, 1, 12};
    const Event::Kind faults[] = {Event::BREAK,  Event::LIE,    Event::STEP_CLOCK, Event::RUN_CLOCK,
                                  Event::CAMERA, Event::SWITCH, Event::REPEAT,     Event::REHANG};
    const int nb_faults = integer(3), only = integer(8);  // 2: any number
    const bool is_calm = nb_faults == 0;
    for (int i = 0; i < 8; ++i) {
      const bool is_kept = nb_faults == 2 ? integer(2) == 0 : nb_faults == 1 && i == only;
      if (!is_kept) weights[faults[i]] = 0;
    }
    if (!setup.has_cloud) {
      for (int kind = Event::CLOUD; kind <= Event::CLEAR; ++kind) weights[kind] = 0;
    }
    if (integer(4) == 0) {
      for (const Event::Kind kind : {Event::SCENE_BEGIN, Event::SCENE_END}) weights[kind] *= 4;
    }
    const bool is_of_clouds = setup.has_cloud && integer(3) == 0;
    if (is_of_clouds) {
      for (int kind = Event::CLOUD; kind <= Event::CLOUD_END; ++kind) weights[kind] *= 3;
    }
    // One that changes between /tf and /tf_static again and again; -1: any does, now and then.
    const int switching = weights[Event::SWITCH] > 0.0 && integer(4) == 0 ? integer(nb_links) : -1;
    if (switching >= 0) weights[Event::SWITCH] = integer(2) == 0 ? 3 : 8;
    const double spread = integer(3) == 0 ? 8.0 : 3.0;
    const bool has_cycles = weights[Event::LIE] > 0.0 && integer(4) == 0;
    if (has_cycles) weights[Event::LIE] *= 8;
    std::discrete_distribution<int> kinds(std::begin(weights), std::end(weights));
    const bool is_together = is_of_clouds || integer(4) == 0;  // as robot_state_publisher does
    std::vector<Event> events;
    std::vector<Pose> walks;   // of each link
    std::vector<char> stands;  // of each, whether it is on /tf_static
    for (int i = 0; i < nb_links; ++i) {
      walks.push_back(anywhere(spread));
      stands.push_back(setup.links[static_cast<std::size_t>(i)].is_static);
      Event event;
      event.kind = Event::PUBLISH;
      event.who = i;
      event.at = walks.back();
      events.push_back(event);
    }
    if (setup.has_cloud && (is_calm || integer(4) != 0)) {
      events.emplace_back();
      events.back().kind = Event::CAMERA;
    }
    while (static_cast<int>(events.size()) < count) {
      Event event;
      event.kind = static_cast<Event::Kind>(kinds(random_));
      event.dt = integer(is_calm ? 400 : 40) == 0 ? 1.5 * real() : 0.02 * real();
      event.lag = integer(12) == 0 ? 1.2 * real() : 0.03 * real();
      if (integer(15) == 0) event.lag = -0.4 * real();
      if (integer(60) == 0) event.lag = std::max(setup.max_pose_age, 0.4);
      // In the order of their stamps, or one among many is not.
      if (nb_faults < 2 && (is_calm || integer(80) > 0)) event.lag = 0.01;
      event.who = integer(nb_links);
      event.other = integer(nb_links);
      event.what = integer(8);
      if (event.kind == Event::LIE && has_cycles) event.what = 3;
      if (event.kind == Event::CLOUD && (is_of_clouds || is_calm)) event.what = integer(3);
      if (event.kind == Event::PUBLISH && is_calm) event.what = 0;
      if (event.kind == Event::SWITCH && switching >= 0) event.who = switching;
      event.number = integer(3) == 0 ? 0.0 : 2.0 * real() - 1.0;
      event.at = anywhere(spread);
      if (event.kind == Event::SWITCH) stands[static_cast<std::size_t>(event.who)] ^= 1;
      const auto walkOn = [&] {
        const bool is_static = stands[static_cast<std::size_t>(event.who)] != 0;
        Pose& walk = walks[static_cast<std::size_t>(event.who)];
        Pose step = anywhere(integer(50) == 0 ? 2.0 : is_of_clouds ? 0.02 : 0.1);
        if (is_static && integer(20) != 0) step = {};
        // Equal, or not nearly so: which of two static poses within 0.1 mm counts is open.
        const auto rounded = [](double value) { return 1e-3 * std::round(1e3 * value); };
        walk = {rounded(walk.x + step.x), walk.y + step.y,
                (is_static ? 1.0 : 0.9) * walk.z + step.z, rounded(walk.yaw + 0.05 * step.yaw)};
        event.at = walk;
      };
      const bool is_of_all = event.kind == Event::PUBLISH && is_together;
      if (is_of_all) {
        for (event.who = 0; event.who + 1 < nb_links; ++event.who) {
          walkOn();
          events.push_back(event);
          event.dt = 0.0;
        }
      }
      if (event.kind == Event::PUBLISH) walkOn();
      events.push_back(event);
      if (!is_of_all || !is_of_clouds) continue;
      for (const Event::Kind kind : {Event::CLOUD_BEGIN, Event::CLOUD_END}) {
        events.push_back(event);
        events.back().kind = kind;
        events.back().dt = 0.005;
      }
    }
    return events;
  }

 private:
  /// A link that slides, and two that are fixed to it, by one of which TF hangs all.
  void addHungByAnother(Scenario& made) {
    const int first = static_cast<int>(made.links.size());
    for (int i = first; i < first + 3; ++i) {
      SimulatedLink link;
      const int lowest = made.is_apart ? 0 : -1;
      link.parent = i == first ? lowest + integer(first - lowest) : first;
      link.joint = i == first ? SimulatedLink::SLIDING : SimulatedLink::FIXED;
      link.X_PJ = {0.0, std::pow(2.0, i), 0.0, 0.0};
      link.radius = 0.2 + 0.25 * real();
      link.is_listed = integer(6) != 0;
      made.links.push_back(link);
    }
    SimulatedLink& hung = made.links[static_cast<std::size_t>(first)];
    hung.hung_by = first + 1;
    hung.is_static = integer(8) == 0;
    hung.is_led_away = made.fixed_frame < 0 && integer(2) == 0;
    if (integer(2) == 0) made.cycle_through = first + 2;
  }

  int integer(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }
  double real() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  Pose anywhere(double spread) {
    return {spread * (real() - 0.5), spread * (real() - 0.5), 0.5 * (real() - 0.5), 6.0 * real()};
  }

  std::mt19937 random_;
};

}  // namespace simulation
