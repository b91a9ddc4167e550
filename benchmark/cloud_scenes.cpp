#include "cloud_scenes.h"

#include <cmath>
#include <limits>
#include <random>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr int WIDTH = 640, HEIGHT = 480;
constexpr double FOCAL_LENGTH = 525.0;  // pixels
constexpr double NOISE = 0.002;         // metres

/// Where the ray enters the box, in lengths of `along`; infinite where it misses it.
double rayMeetsBox(const Vector3d& from, const Vector3d& along, const Aabb& box) {
  double enters = 0.0, leaves = INF;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min[axis] - from[axis]) / along[axis];
    const double b = (box.max[axis] - from[axis]) / along[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters <= leaves ? enters : INF;
}

/// T. Moeller, B. Trumbore, "Fast, minimum storage ray-triangle intersection" (1997).
double rayMeetsTriangle(const Vector3d& from, const Vector3d& along, const Vector3d& a,
                        const Vector3d& b, const Vector3d& c) {
  const Vector3d u = b - a, v = c - a, p = along.cross(v), t = from - a, q = t.cross(u);
  const double determinant = u.dot(p);
  if (std::abs(determinant) < 1e-14) return INF;
  const double x = t.dot(p) / determinant, y = along.dot(q) / determinant;
  const double far = v.dot(q) / determinant;
  return x >= 0.0 && y >= 0.0 && x + y <= 1.0 && far > 0.0 ? far : INF;
}

struct SeenPart {
  Isometry3d X_EW;
  Aabb box;  ///< in E; of what is no mesh the camera sees this
  std::shared_ptr<const TriangleMesh> mesh;
};

double rayMeetsPart(const Vector3d& from_W, const Vector3d& along_W, const SeenPart& part) {
  const Vector3d from = part.X_EW * from_W, along = part.X_EW.linear() * along_W;
  const double at_box = rayMeetsBox(from, along, part.box);
  if (at_box == INF || !part.mesh) return at_box;
  double nearest = INF;
  for (const auto& t : part.mesh->triangles) {
    const auto& v = part.mesh->vertices;
    nearest = std::min(nearest, rayMeetsTriangle(from, along, v[t[0]], v[t[1]], v[t[2]]));
  }
  return nearest;
}

std::vector<SeenPart> partsOf(const RobotModel& robot, const std::vector<Isometry3d>& X_WB) {
  std::vector<SeenPart> parts;
  for (const Link& link : robot.links()) {
    for (const Element& element : link.elements) {
      const Isometry3d X_WE = X_WB[static_cast<std::size_t>(link.body)] * link.X_BL * element.X_LE;
      SeenPart part{X_WE.inverse(), computeAabb(element.shape, Isometry3d::Identity()), nullptr};
      if (const auto* mesh = std::get_if<Mesh>(&element.shape)) part.mesh = mesh->mesh;
      if (const auto* cylinder = std::get_if<Cylinder>(&element.shape)) {  // its inner box
        const double half = cylinder->radius / std::sqrt(2.0);
        part.box = {{-half, -half, -0.5 * cylinder->length}, {half, half, 0.5 * cylinder->length}};
      }
      if (const auto* sphere = std::get_if<Sphere>(&element.shape)) {
        const Vector3d half = Vector3d::Constant(sphere->radius / std::sqrt(3.0));
        part.box = {-half, half};
      }
      parts.push_back(part);
    }
  }
  return parts;
}

}  // namespace

Room::Room(int nb_boxes) {
  std::mt19937 engine(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  boxes_.push_back({{-3.0, -3.0, -0.1}, {3.0, 3.0, 0.0}});
  boxes_.push_back({{-3.1, -3.0, 0.0}, {-3.0, 3.0, 2.5}});
  boxes_.push_back({{-3.0, -3.1, 0.0}, {3.0, -3.0, 2.5}});
  for (int i = 0; i < nb_boxes; ++i) {
    const Vector3d corner(uniform(-1.5, 1.2), uniform(-1.5, 1.2), uniform(0.0, 1.3));
    const Vector3d size(uniform(0.05, 0.4), uniform(0.05, 0.4), uniform(0.05, 0.4));
    boxes_.push_back({corner, corner + size});
  }
}

Points Room::points(double step) const {
  Points points;
  for (const Aabb& box : boxes_) {
    const Vector3d size = box.max - box.min;
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (double x = 0.5 * step; x < size[u]; x += step) {
        for (double y = 0.5 * step; y < size[v]; y += step) {
          for (const double side : {box.min[axis], box.max[axis]}) {
            Vector3d p;
            p[axis] = side;
            p[u] = box.min[u] + x;
            p[v] = box.min[v] + y;
            points.push_back(p);
          }
        }
      }
    }
  }
  return points;
}

Points Room::seenFrom(const Vector3d& p_WC, const Vector3d& p_WT, const RobotModel& robot,
                      const std::vector<Isometry3d>& X_WB, unsigned seed) const {
  const std::vector<SeenPart> parts = partsOf(robot, X_WB);
  Matrix3d R_WC;  // z ahead, y down
  R_WC.col(2) = (p_WT - p_WC).normalized();
  R_WC.col(0) = R_WC.col(2).cross(Vector3d::UnitZ()).normalized();
  R_WC.col(1) = R_WC.col(2).cross(R_WC.col(0));
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0.0, NOISE);
  Points points;
  for (int row = 0; row < HEIGHT; ++row) {
    for (int column = 0; column < WIDTH; ++column) {
      const Vector3d along = R_WC * Vector3d((column - 0.5 * WIDTH) / FOCAL_LENGTH,
                                             (row - 0.5 * HEIGHT) / FOCAL_LENGTH, 1.0);
      double nearest = INF;
      for (const Aabb& box : boxes_) nearest = std::min(nearest, rayMeetsBox(p_WC, along, box));
      for (const SeenPart& part : parts) {
        nearest = std::min(nearest, rayMeetsPart(p_WC, along, part));
      }
      nearest += noise(engine);
      points.push_back(nearest < INF ? Vector3d(p_WC + nearest * along)
                                     : Vector3d::Constant(std::nan("")));
    }
  }
  return points;
}

}  // namespace collision_pairs
