#include "depth_image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double NOTHING = std::numeric_limits<double>::infinity();
constexpr double LEAST_DEPTH = 1e-3;  // m: what is nearer may be anywhere in the image

/// Of the depths at which a ray enters and leaves, the first before the camera.
double firstOf(double enter, double leave) {
  if (enter > leave || leave <= 0.0) return NOTHING;
  return enter > 0.0 ? enter : leave;
}

/// The ray o + t d within |x_axis| <= half, as an interval of t.
std::pair<double, double> slab(const Vector3d& o, const Vector3d& d, int axis, double half) {
  if (d[axis] == 0.0) {
    return std::abs(o[axis]) <= half ? std::pair{-NOTHING, NOTHING} : std::pair{NOTHING, -NOTHING};
  }
  const double a = (-half - o[axis]) / d[axis], b = (half - o[axis]) / d[axis];
  return {std::min(a, b), std::max(a, b)};
}

/// a t^2 + 2 b t + c <= 0 as an interval of t.
std::pair<double, double> between(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return {NOTHING, -NOTHING};
  if (a == 0.0) return c <= 0.0 ? std::pair{-NOTHING, NOTHING} : std::pair{NOTHING, -NOTHING};
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

double hitBall(const Vector3d& o, const Vector3d& d, double radius) {
  const auto [enter, leave] = between(d.squaredNorm(), o.dot(d), o.squaredNorm() - radius * radius);
  return firstOf(enter, leave);
}

double hitBox(const Vector3d& o, const Vector3d& d, const Vector3d& half) {
  double enter = -NOTHING, leave = NOTHING;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [from, to] = slab(o, d, axis, half[axis]);
    enter = std::max(enter, from);
    leave = std::min(leave, to);
  }
  return firstOf(enter, leave);
}

double hitCylinder(const Vector3d& o, const Vector3d& d, double radius, double length) {
  const auto [from, to] = between(d.head<2>().squaredNorm(), o.head<2>().dot(d.head<2>()),
                                  o.head<2>().squaredNorm() - radius * radius);
  const auto [bottom, top] = slab(o, d, 2, 0.5 * length);
  return firstOf(std::max(from, bottom), std::min(to, top));
}

double hitCapsule(const Vector3d& o, const Vector3d& d, double radius, double length) {
  const Vector3d end(0.0, 0.0, 0.5 * length);
  return std::min({hitCylinder(o, d, radius, length), hitBall(o - end, d, radius),
                   hitBall(o + end, d, radius)});
}

double hitHalfSpace(const Vector3d& o, const Vector3d& d) {
  const double t = -o.z() / d.z();
  return d.z() != 0.0 && t > 0.0 ? t : NOTHING;
}

/// Of a ray from the origin; both sides of the triangle are seen. Möller and Trumbore's products
/// with the ray last, since all pixels share the others.
struct TriangleHit {
  Vector3d of_u, of_v, of_all;
  double of_t;

  TriangleHit(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const Vector3d edge_1 = b - a, edge_2 = c - a;
    of_all = edge_2.cross(edge_1);
    of_u = a.cross(edge_2);
    of_v = edge_1.cross(a);
    of_t = edge_2.dot(of_v);
  }
  double operator()(const Vector3d& d) const {
    const double determinant = d.dot(of_all);
    if (determinant == 0.0) return NOTHING;
    const double u = d.dot(of_u) / determinant, v = d.dot(of_v) / determinant;
    const double t = of_t / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 ? t : NOTHING;
  }
};

}  // namespace

DepthImage::DepthImage(int width, int height, double focal_length)
    : width_(width), height_(height), focal_length_(focal_length) {
  clear();
}

void DepthImage::clear() {
  depths_.assign(static_cast<std::size_t>(width_) * height_, static_cast<float>(NOTHING));
}

DepthImage::Pixels DepthImage::pixelsOf(const Vector3d& center, double radius) const {
  const double nearest = center.z() - radius;
  if (center.z() + radius <= 0.0) return {0, 0, 0, 0};
  const bool all = nearest <= LEAST_DEPTH || !std::isfinite(radius);
  const auto range = [&](double at, int size) -> std::pair<int, int> {
    if (all) return {0, size};
    // Whatever the depth of a point of the sphere: it is `nearest` at least.
    const double low = std::min((at - radius) / nearest, (at - radius) / (center.z() + radius));
    const double high = std::max((at + radius) / nearest, (at + radius) / (center.z() + radius));
    const auto pixel = [&](double x) {
      return std::clamp(x * focal_length_ + 0.5 * (size - 1), -1.0, size + 1.0);
    };
    return {std::max(0, static_cast<int>(std::floor(pixel(low)))),
            std::min(size, static_cast<int>(std::ceil(pixel(high))) + 1)};
  };
  const auto [u_begin, u_end] = range(center.x(), width_);
  const auto [v_begin, v_end] = range(center.y(), height_);
  return {u_begin, u_end, v_begin, v_end};
}

DepthImage::Pixels DepthImage::pixelsOf(const Vector3d& a, const Vector3d& b,
                                        const Vector3d& c) const {
  const Vector3d z(a.z(), b.z(), c.z());
  const auto range = [&](int axis, int size) -> std::pair<int, int> {
    constexpr double ROUNDING = 1e-6;  // pixels
    const double middle = 0.5 * (size - 1);
    const Vector3d at = focal_length_ * Vector3d(a[axis], b[axis], c[axis]);
    const double edge = middle + ROUNDING;
    if ((at - edge * z).minCoeff() > 0.0 || (at + edge * z).maxCoeff() < 0.0) return {0, 0};
    if (z.minCoeff() <= LEAST_DEPTH) return {0, size};
    const Eigen::Array3d pixel = at.array() / z.array() + middle;
    return {static_cast<int>(std::ceil(std::max(pixel.minCoeff() - ROUNDING, 0.0))),
            static_cast<int>(std::floor(std::min(pixel.maxCoeff() + ROUNDING, size - 1.0))) + 1};
  };
  if (z.maxCoeff() <= 0.0) return {0, 0, 0, 0};
  const auto [u_begin, u_end] = range(0, width_);
  const auto [v_begin, v_end] = range(1, height_);
  return {u_begin, u_end, v_begin, v_end};
}

template <class Hit>
void DepthImage::cast(const Pixels& pixels, const Hit& hit) {
  for (int v = pixels.v_begin; v < pixels.v_end; ++v) {
    for (int u = pixels.u_begin; u < pixels.u_end; ++u) {
      float& depth = depths_[static_cast<std::size_t>(v) * width_ + u];
      depth = std::min(depth, static_cast<float>(hit(ray(u, v))));
    }
  }
}

void DepthImage::drawTriangles(const TriangleMesh& mesh, const Eigen::Isometry3d& X_CE) {
  std::vector<Vector3d> p_C;  // of the vertices
  for (const Vector3d& p_E : mesh.vertices) p_C.push_back(X_CE * p_E);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Pixels pixels = pixelsOf(p_C[a], p_C[b], p_C[c]);
    if (pixels.u_begin < pixels.u_end && pixels.v_begin < pixels.v_end) {
      cast(pixels, TriangleHit(p_C[a], p_C[b], p_C[c]));
    }
  }
}

void DepthImage::draw(const Shape& shape, const Eigen::Isometry3d& X_CE) {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return drawTriangles(*mesh->mesh, X_CE);
  if (const auto* convex = std::get_if<Convex>(&shape)) return drawTriangles(*convex->mesh, X_CE);
  const Eigen::Isometry3d X_EC = X_CE.inverse();
  const Vector3d o = X_EC.translation();
  const auto cast_primitive = [&](double radius, const auto& hit) {
    cast(pixelsOf(X_CE.translation(), radius),
         [&](const Vector3d& ray) { return hit(Vector3d(X_EC.linear() * ray)); });
  };
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vector3d half = 0.5 * box->size;
    cast_primitive(half.norm(), [&](const Vector3d& d) { return hitBox(o, d, half); });
  } else if (const auto* ball = std::get_if<Sphere>(&shape)) {
    cast_primitive(ball->radius, [&](const Vector3d& d) { return hitBall(o, d, ball->radius); });
  } else if (const auto* can = std::get_if<Cylinder>(&shape)) {
    cast_primitive(std::hypot(can->radius, 0.5 * can->length),
                   [&](const Vector3d& d) { return hitCylinder(o, d, can->radius, can->length); });
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    cast_primitive(capsule->radius + 0.5 * capsule->length, [&](const Vector3d& d) {
      return hitCapsule(o, d, capsule->radius, capsule->length);
    });
  } else {
    cast_primitive(NOTHING, [&](const Vector3d& d) { return hitHalfSpace(o, d); });
  }
}

}  // namespace collision_pairs
