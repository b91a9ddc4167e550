#include "markers.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry_conversions.h"
#include "marker_style.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

enum class BoxKind { OTHER, INVESTIGATED, IN_CONTACT };

const std_msgs::ColorRGBA GREEN = color(0.10f, 0.75f, 0.20f, 1.0f);
const std_msgs::ColorRGBA AMBER = color(1.0f, 0.55f, 0.0f, 1.0f);
const std_msgs::ColorRGBA RED = color(1.0f, 0.0f, 0.0f, 1.0f);

struct Style {
  const char* text;  ///< namespace, or word
  std_msgs::ColorRGBA rgba;
};

Style styleOf(BoxKind kind) {
  static const Style STYLES[] = {{"other_boxes", color(0.60f, 0.65f, 0.70f, 0.12f)},
                                 {"investigated_boxes", color(1.00f, 0.75f, 0.00f, 0.30f)},
                                 {"boxes_in_contact", color(0.90f, 0.10f, 0.10f, 0.45f)}};
  return STYLES[static_cast<int>(kind)];
}

Style styleOf(std::uint8_t verdict) {
  if (verdict == CollisionPairs::FREE) return {"FREE", GREEN};
  if (verdict == CollisionPairs::COLLISION) return {"COLLISION", color(0.95f, 0.05f, 0.05f, 1.0f)};
  return {"UNKNOWN", color(0.75f, 0.20f, 0.95f, 1.0f)};
}

/// Lines of at most `width` characters, broken at spaces if possible.
/// The begin of the character (of UTF-8) that this byte is of.
std::size_t characterAt(const std::string& text, std::size_t byte) {
  while (byte > 0 && (static_cast<unsigned char>(text[byte]) & 0xC0) == 0x80) --byte;
  return byte;
}

std::string wrapped(std::string text, std::size_t width) {
  for (std::size_t begin = 0; text.size() - begin > width;) {
    const std::size_t space = text.rfind(' ', begin + width);
    if (space == std::string::npos || space <= begin) {
      const std::size_t end = characterAt(text, begin + width);
      text.insert(end, "\n");
      begin = end + 1;
    } else {
      text[space] = '\n';
      begin = space + 1;
    }
  }
  return text;
}

/// The deepest pair in contact, or the first reason.
std::string verdictDetail(const CollisionPairs& message) {
  constexpr std::size_t LONGEST = 120, WIDTH = 48;  // characters; the message has the full text
  if (message.verdict == CollisionPairs::COLLISION && !message.pairs.empty()) {
    const auto deepest = std::min_element(
        message.pairs.begin(), message.pairs.end(),
        [](const CollisionPair& a, const CollisionPair& b) {
          const bool touches = a.state == CollisionPair::CONTACT;
          const bool other = b.state == CollisionPair::CONTACT;  // an unresolved one has a bound
          return touches != other ? touches : a.distance < b.distance;
        });
    return deepest->first_link + " | " + deepest->second_link;
  }
  std::string why =
      message.unknown_because.empty() ? message.unchecked : message.unknown_because.front();
  if (why.size() > LONGEST) why = why.substr(0, characterAt(why, LONGEST)) + "...";
  return wrapped(why, WIDTH);
}

class MarkerWriter {
 public:
  MarkerWriter(std::string frame, const ros::Time& stamp)
      : frame_(std::move(frame)), stamp_(stamp) {
    array_.markers.push_back(clearAll(frame_, stamp_));
  }

  void addBox(const Aabb& box, BoxKind kind, std::uint32_t id) {
    const Style style = styleOf(kind);
    Marker& marker = add(style.text, id, Marker::CUBE, style.rgba);
    // rviz does not draw a box with an edge of length 0.
    const Vector3d size = (box.max - box.min).cwiseMax(1e-6);
    marker.pose.position = toPoint(box.center());
    marker.scale = toVector3(size);
  }

  void addContact(const Contact& contact, std::uint32_t id, double size) {
    const bool touches = contact.depth >= 0.0;
    addLine("contacts", contact, id, size, touches ? RED : AMBER);
    if (!touches) return;
    Marker& arrow = add("normals", id, Marker::ARROW, color(0.1f, 0.2f, 1.0f, 1.0f));
    arrow.scale.x = 0.4 * size;
    arrow.scale.y = 0.9 * size;
    arrow.points = {toPoint(contact.p_WSecond),
                    toPoint(contact.p_WSecond + 8.0 * size * contact.nhat_W)};
  }

  void addVerdict(const CollisionPairs& message, const Aabb& space) {
    const double height = textHeight(space);
    const auto [word, rgba] = styleOf(message.verdict);
    addText("verdict", 0, word, rgba, space, height, 1.9 * height);
    const std::string detail = verdictDetail(message);
    if (!detail.empty()) {
      addText("verdict", 1, detail, rgba, space, 0.35 * height, 0.6 * height);
    }
  }

  /// Below the verdict, or above it where the verdict has a detail there.
  void addLimit(const ShownLimit& shown, bool has_detail, const Aabb& space, double size) {
    const SpeedLimit& limit = shown.limit;
    const auto rgba = limit.scale >= 1.0 ? GREEN : limit.scale > 0.0 ? AMBER : RED;
    const double height = textHeight(space);
    std::string words = "speed " + std::to_string(std::lround(100.0 * limit.scale)) + " %";
    if (!limit.first_link.empty()) words += '\n' + limit.first_link + " | " + limit.second_link;
    addText("speed_limit", 0, words, rgba, space, 0.45 * height, (has_detail ? 3.1 : 0.8) * height);
    if (shown.nearest) addLine("speed_limit", *shown.nearest, 1, 2.0 * size, rgba);
  }

  MarkerArray take() { return std::move(array_); }

 private:
  static double textHeight(const Aabb& space) {
    return std::max(1e-3, 0.07 * (space.max - space.min).norm());
  }

  /// Above the space, without a stamp.
  void addText(const char* ns, int id, const std::string& words, const std_msgs::ColorRGBA& rgba,
               const Aabb& space, double size, double above) {
    Marker& text = add(ns, id, Marker::TEXT_VIEW_FACING, rgba);
    text.header.stamp = ros::Time();
    text.text = words;
    text.scale.z = size;
    const Vector3d center = space.center();
    text.pose.position = toPoint(Vector3d(center.x(), center.y(), space.max.z() + above));
  }

  /// Between the two points of a contact, with a sphere at either end.
  void addLine(const char* ns, const Contact& contact, std::uint32_t id, double size,
               const std_msgs::ColorRGBA& rgba) {
    Marker& line = add(ns, 2 * id, Marker::LINE_LIST, rgba);
    line.scale.x = 0.2 * size;
    line.points = {toPoint(contact.p_WFirst), toPoint(contact.p_WSecond)};
    Marker& ends = add(ns, 2 * id + 1, Marker::SPHERE_LIST, rgba);
    ends.scale.x = ends.scale.y = ends.scale.z = size;
    ends.points = {toPoint(contact.p_WFirst), toPoint(contact.p_WSecond)};
  }

  Marker& add(const char* ns, std::uint32_t id, int type, const std_msgs::ColorRGBA& rgba) {
    Marker marker;
    marker.header.frame_id = frame_;
    marker.header.stamp = stamp_;
    marker.ns = ns;
    marker.id = static_cast<int>(id);
    marker.type = type;
    marker.color = rgba;
    marker.pose.orientation.w = 1.0;
    array_.markers.push_back(marker);
    return array_.markers.back();
  }

  std::string frame_;
  ros::Time stamp_;
  MarkerArray array_;
};

bool isBounded(const Aabb& box) {  // half-spaces are not
  return box.min.minCoeff() > -1e100 && box.max.maxCoeff() < 1e100;
}

std::vector<BoxKind> kindsOf(const CollisionReport& report) {
  std::vector<BoxKind> kinds(report.boxes.size(), BoxKind::OTHER);
  if (kinds.empty()) return kinds;  // not listed
  for (const BoxPair& pair : report.candidates) {
    kinds[pair.first] = kinds[pair.second] = BoxKind::INVESTIGATED;
  }
  for (const Contact& contact : report.contacts) {
    if (contact.depth < 0.0) continue;
    kinds[contact.elements.first] = kinds[contact.elements.second] = BoxKind::IN_CONTACT;
  }
  return kinds;
}

/// Size of spheres and arrows, suitable for a hand and for a crane: a twentieth of the median box.
double contactSize(const CollisionReport& report) {
  std::vector<double> sizes;
  for (const Aabb& box : report.boxes) {
    if (box.valid() && isBounded(box)) sizes.push_back((box.max - box.min).norm());
  }
  if (sizes.empty()) return 0.01;
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
  return std::max(1e-4, 0.05 * sizes[sizes.size() / 2]);
}

/// The box around all bounded boxes.
Aabb boundedSpace(const CollisionReport& report) {
  Aabb space = noBox();
  for (const Aabb& box : report.boxes) {
    if (box.valid() && isBounded(box)) space = enclosing(space, box);
  }
  return space.valid() ? space : Aabb{Vector3d::Constant(-1.0), Vector3d::Constant(1.0)};
}

Aabb cutTo(const Aabb& space, Aabb box) {
  box.min = box.min.cwiseMax(space.min).cwiseMin(space.max);
  box.max = box.max.cwiseMin(space.max).cwiseMax(box.min);
  return box;
}

}  // namespace

MarkerArray toMarkers(const CollisionPairs& message, const CollisionReport* report,
                      bool only_investigated, const std::optional<ShownLimit>& limit) {
  MarkerWriter writer(message.header.frame_id, message.header.stamp);
  const bool has_detail = !verdictDetail(message).empty();
  if (!report) {
    const Aabb nothing{Vector3d::Constant(-0.5), Vector3d::Constant(0.5)};
    writer.addVerdict(message, nothing);
    if (limit) writer.addLimit(*limit, has_detail, nothing, 0.01);
    return writer.take();
  }
  const Aabb bounded = boundedSpace(*report);
  writer.addVerdict(message, bounded);
  const std::vector<BoxKind> kinds = kindsOf(*report);
  // Half-spaces are clipped to twice the size of all bounded boxes.
  const Vector3d margin = 0.5 * (bounded.max - bounded.min);
  const Aabb space{bounded.min - margin, bounded.max + margin};
  for (std::uint32_t i = 0; i < report->boxes.size(); ++i) {
    if (!report->boxes[i].valid()) continue;
    if (only_investigated && kinds[i] == BoxKind::OTHER) continue;
    const Aabb& box = report->boxes[i];
    writer.addBox(isBounded(box) ? box : cutTo(space, box), kinds[i], i);
  }
  const double size = contactSize(*report);
  for (std::uint32_t i = 0; i < report->contacts.size(); ++i) {
    writer.addContact(report->contacts[i], i, size);
  }
  if (limit) writer.addLimit(*limit, has_detail, bounded, size);
  return writer.take();
}

ShownLimit shownLimit(const SpeedLimit& limit, CollisionDetector& detector, const BodyPoses& poses,
                      Fidelity fidelity) {
  ShownLimit shown{limit, {}};
  const int first = detector.scene().findModel(limit.first_link);
  const int second = detector.scene().findModel(limit.second_link);
  if (first < 0 || second < 0) return shown;
  CheckSettings settings;
  settings.alarm_distance = 1.0;
  settings.fidelity = fidelity;
  detector.beginNarrowPhase(poses, settings);
  detector.addCollisionPair(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second));
  const CollisionReport& report = detector.endNarrowPhase();
  if (report.pairs.empty()) return shown;
  const Contact* nearest = report.nearestContact(report.pairs.front());
  if (nearest) shown.nearest = *nearest;
  return shown;
}

}  // namespace collision_pairs
