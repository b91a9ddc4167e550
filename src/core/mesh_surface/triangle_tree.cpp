#include "triangle_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>

namespace collision_pairs {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

}  // namespace

struct TriangleTree::Builder {
  explicit Builder(const TriangleMesh& the_mesh) : mesh(the_mesh), order(mesh.triangles.size()) {
    std::iota(order.begin(), order.end(), 0);
    centroid.reserve(order.size());
    for (const auto& t : mesh.triangles) {
      centroid.push_back((corner(t[0]) + corner(t[1]) + corner(t[2])) / 3.0);
    }
  }

  const Vector3d& corner(std::uint32_t vertex) const { return mesh.vertices[vertex]; }

  // Second moments of area about the mean, by the exact formula for a triangle; of the corners if
  // there is no area.
  Matrix3d axes(std::uint32_t begin, std::uint32_t end) const {
    double total = 0.0;
    Vector3d mean = Vector3d::Zero();
    Matrix3d second = Matrix3d::Zero();
    const Vector3d origin = centroid[order[begin]];
    for (const bool by_area : {true, false}) {
      for (std::uint32_t i = begin; i < end; ++i) {
        const auto& t = mesh.triangles[order[i]];
        const Vector3d a = corner(t[0]) - origin, b = corner(t[1]) - origin,
                       c = corner(t[2]) - origin, g = centroid[order[i]] - origin;
        const double weight = by_area ? (b - a).cross(c - a).norm() : 1.0;
        total += weight;
        mean += weight * g;
        second +=
            weight / 12.0 *
            (9.0 * g * g.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
      }
      if (total > 0.0) break;
    }
    mean /= total;
    const Matrix3d covariance = second / total - mean * mean.transpose();
    const double scale = covariance.cwiseAbs().maxCoeff();
    if (!(scale > 0.0)) return Matrix3d::Identity();
    Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
    solver.computeDirect(Matrix3d(covariance / scale));
    Matrix3d R = solver.eigenvectors();
    // computeDirect is fast but sometimes loses orthogonality, which is restored here.
    R.col(2).normalize();
    R.col(1) = (R.col(1) - R.col(2).dot(R.col(1)) * R.col(2));
    const double length = R.col(1).norm();
    R.col(1) = length > 0.5 ? Vector3d(R.col(1) / length) : R.col(2).unitOrthogonal();
    R.col(0) = R.col(1).cross(R.col(2));
    return R.allFinite() ? R : Matrix3d(Matrix3d::Identity());
  }

  OrientedBox box(std::uint32_t begin, std::uint32_t end) const {
    OrientedBox result;
    result.R = axes(begin, end);
    const Vector3d origin = centroid[order[begin]];
    Vector3d low = Vector3d::Zero(), high = low;
    double largest = origin.cwiseAbs().maxCoeff();
    for (std::uint32_t i = begin; i < end; ++i) {
      for (const std::uint32_t vertex : mesh.triangles[order[i]]) {
        const Vector3d p = result.R.transpose() * (corner(vertex) - origin);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
    }
    largest = std::max(largest, (high - low).maxCoeff());
    result.center = origin + result.R * (0.5 * (low + high));
    result.half = (0.5 * (high - low)).array() + 4e-15 * largest;
    return result;
  }

  std::uint32_t split(const OrientedBox& whole, std::uint32_t begin, std::uint32_t end) {
    int axis;
    whole.half.maxCoeff(&axis);
    const Vector3d direction = whole.R.col(axis);
    double mean = 0.0;
    for (std::uint32_t i = begin; i < end; ++i) mean += direction.dot(centroid[order[i]]);
    mean /= end - begin;
    const auto below = [&](std::uint32_t t) { return direction.dot(centroid[t]) < mean; };
    const auto middle = std::partition(order.begin() + begin, order.begin() + end, below);
    const auto cut = static_cast<std::uint32_t>(middle - order.begin());
    // An unbalanced split would make the tree deep; with equal centroids there is no split at all.
    const std::uint32_t least = std::max(1U, (end - begin) / 8);
    if (cut >= begin + least && cut + least <= end) return cut;
    const std::uint32_t half = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + half, order.begin() + end,
                     [&](std::uint32_t s, std::uint32_t t) {
                       return direction.dot(centroid[s]) < direction.dot(centroid[t]);
                     });
    return half;
  }

  struct Part {
    Part(const Builder& builder, std::uint32_t the_begin, std::uint32_t the_end)
        : box(builder.box(the_begin, the_end)), begin(the_begin), end(the_end) {}
    std::uint32_t size() const { return end - begin; }
    OrientedBox box;
    std::uint32_t begin, end;
  };

  std::vector<Part> halves(const Part& part) {
    const std::uint32_t cut = split(part.box, part.begin, part.end);
    return {Part(*this, part.begin, cut), Part(*this, cut, part.end)};
  }

  std::vector<Part> quarters(const Part& part, std::uint32_t enough) {
    std::vector<Part> parts;
    for (const Part& half : halves(part)) {
      const std::vector<Part> pieces = half.size() <= enough ? std::vector{half} : halves(half);
      parts.insert(parts.end(), pieces.begin(), pieces.end());
    }
    return parts;
  }

  struct Root {
    std::uint32_t index;
    Part part;
  };

  // Splits into parts of at most `enough` triangles, which are appended to `ends` if given.
  void grow(const Root& root, std::uint32_t enough, std::vector<Root>* ends) {
    const auto& [index, whole] = root;
    setLane(whole.box, static_cast<int>(index % BOX_LANES), blocks[index / BOX_LANES]);
    nodes[index].size = whole.box.size();
    nodes[index].children = order[whole.begin];
    if (whole.size() <= enough) {
      if (ends != nullptr) ends->push_back(root);
      return;
    }
    const std::vector<Part> parts = quarters(whole, enough);
    const std::uint32_t first = addBlock();
    nodes[index].children = first;
    nodes[index].nb_children = static_cast<std::uint8_t>(parts.size());
    for (std::uint32_t i = 0; i < parts.size(); ++i) grow({first + i, parts[i]}, enough, ends);
  }

  // The nodes above the patches come first, to be contiguous in memory.
  void build() {
    const auto nb_triangles = static_cast<std::uint32_t>(mesh.triangles.size());
    std::vector<Root> patch_roots;
    reserve(nb_triangles);
    grow({addBlock(), Part(*this, 0, nb_triangles)}, PATCH_TRIANGLES, &patch_roots);
    nb_upper = nodes.size();
    for (Node& node : nodes) node.above_patches = !node.isLeaf();
    for (const Root& root : patch_roots) {
      nodes[root.index].patch = addPatch(root.part.begin, root.part.end);
      grow(root, 1, nullptr);
    }
  }

  // About what is needed: half a block and one point per triangle. Unused reserve costs no physical
  // memory.
  void reserve(std::size_t nb_triangles) {
    blocks.reserve(nb_triangles * 3 / 5 + 1);
    nodes.reserve(BOX_LANES * blocks.capacity());
    patch_points.reserve(nb_triangles);
    patch_blocks.reserve(nb_triangles / 6 + 1);
  }

  std::uint32_t addBlock() {
    const auto first = static_cast<std::uint32_t>(nodes.size());
    nodes.resize(nodes.size() + BOX_LANES);
    blocks.emplace_back();
    return first;
  }

  std::uint32_t addPatch(std::uint32_t begin, std::uint32_t end) {
    std::vector<std::uint32_t> corners;
    for (std::uint32_t i = begin; i < end; ++i) {
      const auto& t = mesh.triangles[order[i]];
      corners.insert(corners.end(), t.begin(), t.end());
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    Patch patch{static_cast<std::uint32_t>(patch_points.size()),
                static_cast<std::uint32_t>(corners.size()),
                static_cast<std::uint32_t>(patch_blocks.size()),
                0,
                Vector3d::Zero(),
                0.0};
    const auto count = static_cast<double>(corners.size());
    for (const std::uint32_t vertex : corners) patch.center += corner(vertex) / count;
    std::vector<Vector3d> points;
    for (const std::uint32_t vertex : corners) {
      points.push_back(corner(vertex));
      patch.extent = std::max(patch.extent, (corner(vertex) - patch.center).norm());
    }
    patch_points.insert(patch_points.end(), points.begin(), points.end());
    appendBlocks(points, patch_blocks);
    patch.nb_blocks = static_cast<std::uint32_t>(patch_blocks.size()) - patch.first_block;
    patches.push_back(patch);
    return static_cast<std::uint32_t>(patches.size()) - 1;
  }

  const TriangleMesh& mesh;
  std::vector<std::uint32_t> order;
  std::vector<Vector3d> centroid;
  std::vector<Node> nodes;
  std::vector<BoxBlock> blocks;
  std::vector<Patch> patches;
  std::vector<Vector3d> patch_points;
  std::vector<PointBlock> patch_blocks;
  std::size_t nb_upper = 0;
};

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  Builder builder(mesh);
  builder.build();
  nodes_ = std::move(builder.nodes);
  blocks_ = std::move(builder.blocks);
  patches_ = std::move(builder.patches);
  patch_points_ = std::move(builder.patch_points);
  patch_blocks_ = std::move(builder.patch_blocks);
  nb_upper_ = builder.nb_upper;
}

ConvexCore TriangleTree::patchCore(std::uint32_t index) const {
  const Patch& patch = patches_[index];
  ConvexCore core;
  core.kind = ConvexCore::Kind::POINTS;
  core.points = &patch_points_[patch.first_point];
  core.nb_points = static_cast<int>(patch.nb_points);
  core.blocks = &patch_blocks_[patch.first_block];
  core.center = patch.center;
  core.extent = patch.extent;
  return core;
}

void TriangleTree::reaches(const Vector3d& direction, std::vector<double>& reach) const {
  reach.assign(nb_upper_, -std::numeric_limits<double>::infinity());
  for (std::size_t i = nb_upper_; i-- > 0;) {  // children have larger indices than their parents
    const Node& node = nodes_[i];
    if (node.isPatch()) {
      const Patch& patch = patches_[node.patch];
      reach[i] =
          furthestInBlocks(&patch_blocks_[patch.first_block], patch.nb_blocks, direction).height;
    } else {
      for (std::uint32_t k = 0; k < node.nb_children; ++k) {
        reach[i] = std::max(reach[i], reach[node.children + k]);
      }
    }
  }
}

}  // namespace collision_pairs
