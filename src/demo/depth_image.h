// What a depth camera would see of shapes: a ray through each pixel.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// A pinhole camera at the origin of its optical frame C: x to the right of the image, y down, z
/// forward. Closed forms for primitives, Möller and Trumbore (1997) for triangles; written apart
/// from the collision check, so that the one can test the other. Shapes are cast only at the pixels
/// that their bounding sphere covers.
class DepthImage {
 public:
  /// `focal_length` in pixels; the optical axis goes through the middle of the image.
  DepthImage(int width, int height, double focal_length);

  /// Nothing is seen.
  void clear();

  /// X_CE: the pose of the shape's frame in the camera's. A convex is drawn as its triangles.
  void draw(const Shape& shape, const Eigen::Isometry3d& X_CE);

  int width() const { return width_; }
  int height() const { return height_; }

  /// z of what the pixel sees, metres; infinite where it sees nothing.
  float depth(int u, int v) const { return depths_[v * width_ + u]; }

  /// The direction of the pixel's ray, with z = 1: times the depth, it is the point that is seen.
  Eigen::Vector3d ray(int u, int v) const {
    return {(u - 0.5 * (width_ - 1)) / focal_length_, (v - 0.5 * (height_ - 1)) / focal_length_,
            1.0};
  }

 private:
  struct Pixels {
    int u_begin, u_end, v_begin, v_end;
  };
  /// Those that a sphere in C may cover.
  Pixels pixelsOf(const Eigen::Vector3d& center, double radius) const;
  /// Those that a triangle in C may cover.
  Pixels pixelsOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                  const Eigen::Vector3d& c) const;
  /// `hit` gives the depth at which a ray from the origin of C first meets the shape.
  template <class Hit>
  void cast(const Pixels& pixels, const Hit& hit);
  void drawTriangles(const TriangleMesh& mesh, const Eigen::Isometry3d& X_CE);

  int width_, height_;
  double focal_length_;
  std::vector<float> depths_;
};

}  // namespace collision_pairs
