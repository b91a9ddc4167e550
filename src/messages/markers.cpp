#include "markers.h"

#include <algorithm>
#include <vector>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

enum class BoxKind { OTHER, INVESTIGATED, IN_CONTACT };

std_msgs::ColorRGBA color(float r, float g, float b, float a) {
  std_msgs::ColorRGBA rgba;
  rgba.r = r;
  rgba.g = g;
  rgba.b = b;
  rgba.a = a;
  return rgba;
}

struct BoxStyle {
  const char* ns;
  std_msgs::ColorRGBA rgba;
};

BoxStyle styleOf(BoxKind kind) {
  switch (kind) {
    case BoxKind::IN_CONTACT:
      return {"boxes_in_contact", color(0.90f, 0.10f, 0.10f, 0.45f)};
    case BoxKind::INVESTIGATED:
      return {"investigated_boxes", color(1.00f, 0.75f, 0.00f, 0.30f)};
    default:
      return {"other_boxes", color(0.60f, 0.65f, 0.70f, 0.12f)};
  }
}

geometry_msgs::Point toPoint(const Vector3d& v) {
  geometry_msgs::Point point;
  point.x = v.x();
  point.y = v.y();
  point.z = v.z();
  return point;
}

class MarkerWriter {
 public:
  MarkerWriter(std::string frame, const ros::Time& stamp)
      : frame_(std::move(frame)), stamp_(stamp) {
    Marker clear;
    clear.header.frame_id = frame_;
    clear.header.stamp = stamp_;
    clear.action = Marker::DELETEALL;
    array_.markers.push_back(clear);
  }

  void addBox(const Aabb& box, BoxKind kind, std::uint32_t id) {
    const BoxStyle style = styleOf(kind);
    Marker& marker = add(style.ns, id, Marker::CUBE, style.rgba);
    const Vector3d center = box.center();
    // rviz shows nothing where an edge has no length.
    const Vector3d size = (box.max - box.min).cwiseMax(1e-6);
    marker.pose.position = toPoint(center);
    marker.scale.x = size.x();
    marker.scale.y = size.y();
    marker.scale.z = size.z();
  }

  void addContact(const Contact& contact, std::uint32_t id, double size) {
    const bool touches = contact.depth >= 0.0;
    const auto rgba = touches ? color(1.0f, 0.0f, 0.0f, 1.0f) : color(1.0f, 0.55f, 0.0f, 1.0f);
    Marker& line = add("contacts", 2 * id, Marker::LINE_LIST, rgba);
    line.scale.x = 0.2 * size;
    line.points = {toPoint(contact.p_WFirst), toPoint(contact.p_WSecond)};
    Marker& ends = add("contacts", 2 * id + 1, Marker::SPHERE_LIST, rgba);
    ends.scale.x = ends.scale.y = ends.scale.z = size;
    ends.points = {toPoint(contact.p_WFirst), toPoint(contact.p_WSecond)};
    if (!touches) return;
    Marker& arrow = add("normals", id, Marker::ARROW, color(0.1f, 0.2f, 1.0f, 1.0f));
    arrow.scale.x = 0.4 * size;
    arrow.scale.y = 0.9 * size;
    arrow.points = {toPoint(contact.p_WSecond),
                    toPoint(contact.p_WSecond + 8.0 * size * contact.nhat_W)};
  }

  MarkerArray take() { return std::move(array_); }

 private:
  Marker& add(const char* ns, std::uint32_t id, int type, const std_msgs::ColorRGBA& rgba) {
    Marker marker;
    marker.header.frame_id = frame_;
    marker.header.stamp = stamp_;
    marker.ns = ns;
    marker.id = static_cast<int>(id);
    marker.type = type;
    marker.action = Marker::ADD;
    marker.color = rgba;
    marker.pose.orientation.w = 1.0;
    array_.markers.push_back(marker);
    return array_.markers.back();
  }

  std::string frame_;
  ros::Time stamp_;
  MarkerArray array_;
};

std::vector<BoxKind> kindsOf(const CollisionReport& report) {
  std::vector<BoxKind> kinds(report.boxes.size(), BoxKind::OTHER);
  for (const BoxPair& pair : report.candidates) {
    kinds[pair.first] = kinds[pair.second] = BoxKind::INVESTIGATED;
  }
  for (const Contact& contact : report.contacts) {
    if (contact.depth < 0.0) continue;
    kinds[contact.elements.first] = kinds[contact.elements.second] = BoxKind::IN_CONTACT;
  }
  return kinds;
}

/// Balls and arrows that can be seen on a hand as on a crane: a fiftieth of the middle box.
double contactSize(const CollisionReport& report) {
  std::vector<double> sizes;
  for (const Aabb& box : report.boxes) {
    if (box.valid()) sizes.push_back((box.max - box.min).norm());
  }
  if (sizes.empty()) return 0.01;
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
  return std::max(1e-4, 0.05 * sizes[sizes.size() / 2]);
}

}  // namespace

MarkerArray toMarkers(const CollisionReport& report, bool only_investigated,
                      const std::string& frame, const ros::Time& stamp) {
  MarkerWriter writer(frame, stamp);
  const std::vector<BoxKind> kinds = kindsOf(report);
  for (std::uint32_t i = 0; i < report.boxes.size(); ++i) {
    if (!report.boxes[i].valid()) continue;
    if (only_investigated && kinds[i] == BoxKind::OTHER) continue;
    writer.addBox(report.boxes[i], kinds[i], i);
  }
  const double size = contactSize(report);
  for (std::uint32_t i = 0; i < report.contacts.size(); ++i) {
    writer.addContact(report.contacts[i], i, size);
  }
  return writer.take();
}

}  // namespace collision_pairs
