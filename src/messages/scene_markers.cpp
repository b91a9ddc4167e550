#include "scene_markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include <geometric_shapes/bodies.h>
#include <geometric_shapes/shapes.h>

#include "geometry_conversions.h"
#include "marker_style.h"
#include "sphere_cover.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr std::size_t MOST_ELEMENTS = 10000;
constexpr double SQUARE_OF_HALF_SPACE = 10.0;  // m
constexpr int NB_SPHERES = 127;                // of a tree: those that distances are measured from

std::vector<Vector3d> cornersOfTriangles(const TriangleMesh& mesh) {
  std::vector<Vector3d> corners;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) corners.push_back(mesh.vertices[vertex]);
  }
  return corners;
}

std::vector<Vector3d> cornersOfHull(const TriangleMesh& mesh) {
  shapes::Mesh points(static_cast<unsigned>(mesh.vertices.size()), 0);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Eigen::Map<Vector3d>(points.vertices + 3 * i) = mesh.vertices[i];
  }
  const bodies::ConvexMesh hull(&points);
  std::vector<Vector3d> corners;
  for (const unsigned vertex : hull.getTriangles()) {
    corners.push_back(hull.getVertices()[vertex]);
  }
  return corners;
}

/// A triangle on the unit sphere, as 4^times smaller ones.
void divide(const Vector3d& a, const Vector3d& b, const Vector3d& c, int times,
            std::vector<Vector3d>& corners) {
  if (times == 0) {
    corners.insert(corners.end(), {a, b, c});
    return;
  }
  const Vector3d ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
  divide(a, ab, ca, times - 1, corners);
  divide(b, bc, ab, times - 1, corners);
  divide(c, ca, bc, times - 1, corners);
  divide(ab, bc, ca, times - 1, corners);
}

std::vector<Vector3d> cornersOfUnitSphere() {
  std::vector<Vector3d> corners;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        const Vector3d of_x(x, 0, 0), of_y(0, y, 0), of_z(0, 0, z);
        const bool is_right_handed = x * y * z > 0.0;
        divide(of_x, is_right_handed ? of_y : of_z, is_right_handed ? of_z : of_y, 2, corners);
      }
    }
  }
  return corners;
}

/// Without the triangles that are inside of another sphere.
std::vector<Vector3d> cornersOfSpheres(const std::vector<OuterSphere>& tree) {
  static const std::vector<Vector3d> UNIT_SPHERE = cornersOfUnitSphere();
  const int nb_spheres = std::min(static_cast<int>(tree.size()), NB_SPHERES);
  std::vector<PlacedSphere> leaves;
  for (auto sphere = tree.begin(); sphere != tree.begin() + nb_spheres; ++sphere) {
    const bool is_leaf = sphere->first_child == 0 || sphere->first_child >= nb_spheres;
    if (is_leaf && sphere->radius > 0.0) leaves.push_back(*sphere);
  }
  std::vector<Vector3d> corners;
  for (const PlacedSphere& sphere : leaves) {
    for (std::size_t i = 0; i < UNIT_SPHERE.size(); i += 3) {
      std::array<Vector3d, 3> triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        triangle[k] = sphere.center + sphere.radius * UNIT_SPHERE[i + k];
      }
      const auto holds = [&](const PlacedSphere& other) {
        return std::all_of(triangle.begin(), triangle.end(), [&](const Vector3d& p) {
          return (p - other.center).norm() < (1.0 - 1e-9) * other.radius;
        });
      };
      if (std::any_of(leaves.begin(), leaves.end(), holds)) continue;
      corners.insert(corners.end(), triangle.begin(), triangle.end());
    }
  }
  return corners;
}

/// The colour of a triangle that is lit from both sides: rviz lights triangles by the order of
/// their corners, and so draws those of a mesh that is inside out in black.
std_msgs::ColorRGBA shaded(const std_msgs::ColorRGBA& of, const Vector3d& a, const Vector3d& b,
                           const Vector3d& c) {
  // Along no axis and in no plane of symmetry: a box has three shades.
  static const Vector3d TO_LIGHT = Vector3d(0.35, 0.5, 0.8).normalized();
  const Vector3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  const double facing = length > 0.0 ? std::abs(TO_LIGHT.dot(normal)) / length : 1.0;
  const auto light = static_cast<float>(0.55 + 0.45 * facing);
  return color(light * of.r, light * of.g, light * of.b, 1.0f);
}

/// Draws one element, in the frame of its body.
class ElementDrawer {
 public:
  ElementDrawer(MarkerArray& array, Marker pattern, const Isometry3d& X_BE)
      : array_(array), pattern_(std::move(pattern)), X_BE_(X_BE) {}

  void operator()(const Box& box) { solid(Marker::CUBE, box.size, X_BE_); }
  void operator()(const Sphere& sphere) {
    solid(Marker::SPHERE, Vector3d::Constant(2.0 * sphere.radius), X_BE_);
  }
  void operator()(const Cylinder& cylinder) {
    const double width = 2.0 * cylinder.radius;
    solid(Marker::CYLINDER, {width, width, cylinder.length}, X_BE_);
  }
  void operator()(const Capsule& capsule) {
    (*this)(Cylinder{capsule.radius, capsule.length});
    for (const double end : {-0.5, 0.5}) {
      Isometry3d X = X_BE_;
      X.translation() += X.linear() * Vector3d(0.0, 0.0, end * capsule.length);
      solid(Marker::SPHERE, Vector3d::Constant(2.0 * capsule.radius), X);
    }
  }
  void operator()(const HalfSpace&) {
    const double depth = 1e-3;
    Isometry3d X = X_BE_;
    X.translation() -= X.linear() * Vector3d(0.0, 0.0, 0.5 * depth);
    solid(Marker::CUBE, {SQUARE_OF_HALF_SPACE, SQUARE_OF_HALF_SPACE, depth}, X);
  }
  void operator()(const Convex& convex) { triangles(cornersOfHull(*convex.mesh)); }
  void operator()(const Mesh& mesh) { triangles(cornersOfTriangles(*mesh.mesh)); }
  void operator()(const FineSpheres& spheres) { triangles(cornersOfSpheres(spheres.get())); }

 private:
  void solid(int type, const Vector3d& size, const Isometry3d& X_BS) {
    Marker& marker = add(type, X_BS);
    // rviz does not draw a box with an edge of length 0.
    marker.scale = toVector3(size.cwiseMax(1e-6));
  }

  void triangles(const std::vector<Vector3d>& corners) {
    if (corners.empty()) return;  // rviz complains
    Marker& marker = add(Marker::TRIANGLE_LIST, X_BE_);
    marker.scale = toVector3(Vector3d::Ones());
    for (const Vector3d& corner : corners) marker.points.push_back(toPoint(corner));
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      marker.colors.push_back(shaded(marker.color, corners[i], corners[i + 1], corners[i + 2]));
    }
  }

  Marker& add(int type, const Isometry3d& X) {
    array_.markers.push_back(pattern_);
    Marker& marker = array_.markers.back();
    marker.id = static_cast<int>(array_.markers.size());
    marker.type = type;
    marker.pose = toPose(X);
    return marker;
  }

  MarkerArray& array_;
  Marker pattern_;
  Isometry3d X_BE_;
};

/// With namespace and colour. Links are grey, since red, amber and green say how near they are.
Marker patternFor(const CollisionScene& scene, const SceneElement& element) {
  const bool is_static = element.body < 0, is_object = scene.models()[element.model].is_object;
  Marker pattern;
  pattern.ns = is_static ? "standing" : is_object ? "attached_objects" : "links";
  pattern.color = !is_object  ? color(0.72f, 0.74f, 0.77f, 1.0f)
                  : is_static ? color(0.35f, 0.60f, 0.40f, 0.6f)
                              : color(0.60f, 0.30f, 0.70f, 0.9f);
  return pattern;
}

void draw(const SceneElement& element, Fidelity fidelity, Marker pattern, MarkerArray& array) {
  const Fidelity shown = std::min(fidelity, element.finest);
  const Rung& rung = element.rung(shown == Fidelity::AABB ? Fidelity::OBB : shown);
  // A rung that no pair of this element asks for was not prepared.
  const Isometry3d X_BS = rung.shape ? element.X_BE * rung.X_ER : element.X_BE;
  ElementDrawer drawer(array, std::move(pattern), X_BS);
  if (shown == Fidelity::SPHERES && element.spheres) return drawer(*element.spheres);
  std::visit(drawer, rung.shape ? rung.shape->shape() : element.shape);
}

struct ByCoordinates {
  bool operator()(const VoxelCell& a, const VoxelCell& b) const {
    return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
  }
};
/// 0: touching; 1: as far as reach.
using Nearness = std::map<VoxelCell, float, ByCoordinates>;

Nearness nearVoxels(const OccupiedVoxels& voxels, const std::vector<Aabb>& boxes, double reach) {
  Nearness near;
  for (const Aabb& box : boxes) {
    if (!box.valid()) continue;
    voxels.forEachWithin(box, reach, [&](const VoxelCell& cell) {
      const double gap = std::sqrt(squaredGap(voxels.boxOf(cell, Eigen::Vector3i::Ones()), box));
      const auto share = static_cast<float>(std::min(1.0, gap / reach));
      const auto [known, is_new] = near.emplace(cell, share);
      if (!is_new) known->second = std::min(known->second, share);
    });
  }
  return near;
}

Marker markerOf(const std::string& name, const std::string& world_frame) {
  Marker marker;
  marker.header.frame_id = world_frame;
  marker.ns = "cloud " + name;
  marker.type = Marker::CUBE_LIST;
  marker.pose.orientation.w = 1.0;
  return marker;
}

}  // namespace

MarkerArray toSceneMarkers(const CollisionScene& scene, Fidelity fidelity,
                           const std::string& world_frame) {
  MarkerArray array;
  array.markers.push_back(clearAll(world_frame, ros::Time(0)));
  const std::uint32_t nb_standing = scene.nbStaticElements();
  const auto nb_elements = static_cast<std::uint32_t>(scene.elements().size());
  const std::size_t nb_drawn = std::min<std::size_t>(nb_elements, MOST_ELEMENTS);
  for (std::size_t n = 0; n < nb_drawn; ++n) {
    const std::uint32_t id = static_cast<std::uint32_t>(n + nb_standing) % nb_elements;
    if (scene.cloudOf(id) >= 0) continue;  // drawn separately: toMarker()
    const SceneElement& element = scene.elements()[id];
    Marker pattern = patternFor(scene, element);
    pattern.header.frame_id = element.body < 0 ? world_frame : scene.bodies()[element.body].link;
    pattern.frame_locked = element.body >= 0;
    draw(element, fidelity, std::move(pattern), array);
  }
  return array;
}

Marker toMarker(const OccupiedVoxels& voxels, const std::string& name,
                const std::vector<Aabb>& boxes, double reach, const std::string& world_frame) {
  Marker marker = markerOf(name, world_frame);
  marker.scale = toVector3(Eigen::Vector3d::Constant(voxels.voxelSize()));
  marker.color = color(0.30f, 0.55f, 0.75f, 1.0f);
  const auto add = [&](const VoxelCell& cell, const std_msgs::ColorRGBA& shade) {
    if (marker.points.size() == MOST_DRAWN_VOXELS) return;
    const Eigen::Vector3d center =
        (cell.cast<double>() + Eigen::Vector3d::Constant(0.5)) * voxels.voxelSize();
    marker.points.push_back(toPoint(center));
    marker.colors.push_back(shade);
  };
  const Nearness near = nearVoxels(voxels, boxes, reach);
  for (const auto& [cell, share] : near) {
    add(cell, color(0.95f - 0.05f * share, 0.15f + 0.60f * share, 0.10f, 1.0f));
  }
  voxels.forEach([&](const VoxelCell& cell) {
    if (near.empty() || near.count(cell) == 0) add(cell, marker.color);
  });
  if (marker.points.empty()) marker.action = Marker::DELETE;  // rviz complains
  return marker;
}

Marker noMarker(const std::string& name, const std::string& world_frame) {
  Marker marker = markerOf(name, world_frame);
  marker.action = Marker::DELETE;
  return marker;
}

}  // namespace collision_pairs
