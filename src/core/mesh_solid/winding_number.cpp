#include "winding_number.h"

#include <algorithm>
#include <cmath>

#include "solid_angle.h"

namespace collision_pairs {
namespace {

constexpr double FOUR_PI = 12.566370614359172;
constexpr std::uint32_t LEAF_SIZE = 8;
constexpr double FAR = 2.5;          // in radii of the cluster
constexpr double UNCERTAIN = 0.125;  // around 1/2; the error of the dipoles is a few hundredths

double component(const std::array<Eigen::Vector3d, 3>& t, int axis) {
  return t[0][axis] + t[1][axis] + t[2][axis];
}

}  // namespace

WindingNumber::WindingNumber(const std::vector<Eigen::Vector3d>& vertices,
                             std::vector<std::array<std::uint32_t, 3>> outward) {
  if (outward.empty()) return;
  low_ = high_ = vertices[outward[0][0]];
  corners_.reserve(outward.size());
  for (const auto& t : outward) {
    corners_.push_back({vertices[t[0]], vertices[t[1]], vertices[t[2]]});
    for (const Eigen::Vector3d& corner : corners_.back()) {
      low_ = low_.cwiseMin(corner);
      high_ = high_.cwiseMax(corner);
    }
  }
  build(0, static_cast<std::uint32_t>(corners_.size()));
}

void WindingNumber::build(std::uint32_t begin, std::uint32_t end) {
  Node node{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0.0, begin, end, 0};
  Eigen::Vector3d low = corners_[begin][0], high = low;
  double total = 0.0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const auto& t = corners_[i];
    const Eigen::Vector3d dipole = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]);
    const double area = dipole.norm();
    node.dipole += dipole;
    node.center += area * (t[0] + t[1] + t[2]) / 3.0;
    total += area;
    for (const Eigen::Vector3d& corner : t) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  node.center = total > 0.0 ? Eigen::Vector3d(node.center / total) : corners_[begin][0];
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const Eigen::Vector3d& corner : corners_[i]) {
      node.radius = std::max(node.radius, (corner - node.center).norm());
    }
  }
  const std::size_t index = nodes_.size();
  nodes_.push_back(node);
  if (end - begin > LEAF_SIZE) {
    int axis;
    (high - low).maxCoeff(&axis);
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(
        corners_.begin() + begin, corners_.begin() + middle, corners_.begin() + end,
        [axis](const auto& s, const auto& t) { return component(s, axis) < component(t, axis); });
    build(begin, middle);
    build(middle, end);
  }
  nodes_[index].skip = static_cast<std::uint32_t>(nodes_.size());
}

double WindingNumber::exact(const Eigen::Vector3d& p_MQ, std::uint32_t begin,
                            std::uint32_t end) const {
  SolidAngleSum sum(p_MQ);
  for (std::uint32_t i = begin; i < end; ++i) {
    sum.add(corners_[i][0], corners_[i][1], corners_[i][2]);
  }
  return sum.total();
}

bool WindingNumber::holds(const Eigen::Vector3d& p_MQ) const {
  if (corners_.empty()) return false;
  if ((p_MQ.array() < low_.array()).any() || (p_MQ.array() > high_.array()).any()) return false;
  double winding = 0.0;
  for (std::uint32_t i = 0; i < nodes_.size();) {
    const Node& node = nodes_[i];
    const Eigen::Vector3d p_QC = node.center - p_MQ;
    const double squared = p_QC.squaredNorm();
    if (squared > FAR * FAR * node.radius * node.radius) {
      winding += p_QC.dot(node.dipole) / (squared * std::sqrt(squared) * FOUR_PI);
      i = node.skip;
      continue;
    }
    if (node.skip == i + 1) winding += exact(p_MQ, node.begin, node.end);
    ++i;
  }
  if (std::abs(std::abs(winding) - 0.5) < UNCERTAIN) {
    winding = exact(p_MQ, 0, static_cast<std::uint32_t>(corners_.size()));
  }
  return std::abs(winding) > 0.5;
}

}  // namespace collision_pairs
