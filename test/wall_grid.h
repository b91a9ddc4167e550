// Meshes made of the walls of a grid's cells, for which comparing coordinates tells what is inside.
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs {

/// Space cut into cells by N + 1 planes along each axis of a frame G at a random pose in the mesh's
/// frame M; of any size. A mesh is made of walls of cells, and where a point is, is told by
/// comparing it with the planes.
class Grid {
 public:
  static constexpr int N = 3;
  using Cell = std::array<int, 3>;

  explicit Grid(RandomInputs& random)
      : X_MG_(random.pose(3.0)), scale_(std::pow(10.0, random.uniform(-6.0, 6.0))) {
    for (auto& planes : planes_) {
      planes[0] = random.uniform(-1.0, 0.0);
      for (int i = 1; i <= N; ++i) planes[i] = planes[i - 1] + random.uniform(0.8, 1.0);
    }
    for (int i = 0; i < VERTICES; ++i) {
      const Eigen::Vector3d p_GV(planes_[0][i % SIDE], planes_[1][i / SIDE % SIDE],
                                 planes_[2][i / SIDE / SIDE]);
      mesh.vertices.push_back(scale_ * (X_MG_ * p_GV));
    }
  }

  /// The wall of a cell at its lower (or upper) end along `axis`, facing along the axis (or against
  /// it). The same wall is always cut along the same diagonal.
  void addWall(Cell cell, int axis, bool upper, bool along) {
    cell[axis] += upper;
    const int u = STRIDE[(axis + 1) % 3], v = STRIDE[(axis + 2) % 3];
    const int corner = cell[0] * STRIDE[0] + cell[1] * STRIDE[1] + cell[2] * STRIDE[2];
    if (corner * 7 / 3 % 2 == 0) {
      addTriangle(corner, corner + u, corner + u + v, along);
      addTriangle(corner, corner + u + v, corner + v, along);
    } else {
      addTriangle(corner, corner + u, corner + v, along);
      addTriangle(corner + u, corner + u + v, corner + v, along);
    }
  }

  /// All six walls, facing outwards (or all inwards).
  void addBox(const Cell& cell, bool outwards = true) {
    for (int axis = 0; axis < 3; ++axis) {
      addWall(cell, axis, false, !outwards);
      addWall(cell, axis, true, outwards);
    }
  }

  template <class Visit>
  static void forEachCell(Visit visit) {
    for (int i = 0; i < N * N * N; ++i) visit(Cell{i % N, i / N % N, i / N / N});
  }

  /// A random point among the cells or a little outside of them, and its cell.
  std::pair<Eigen::Vector3d, Cell> randomPoint(RandomInputs& random) const {
    Eigen::Vector3d p_GQ;
    Cell cell{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto& planes = planes_[axis];
      const auto nearPlane = [&](double plane) { return std::abs(p_GQ[axis] - plane) < 1e-6; };
      do {
        p_GQ[axis] = random.uniform(planes[0] - 0.5, planes[N] + 0.5);
      } while (std::any_of(planes.begin(), planes.end(), nearPlane));
      cell[axis] = -1;
      for (int i = 0; i <= N; ++i) cell[axis] += p_GQ[axis] > planes[i];
    }
    return {scale_ * (X_MG_ * p_GQ), cell};
  }

  static bool isCell(const Cell& cell) {
    return std::all_of(cell.begin(), cell.end(), [](int i) { return i >= 0 && i < N; });
  }

  TriangleMesh mesh;

 private:
  static constexpr int SIDE = N + 1, VERTICES = SIDE * SIDE * SIDE;
  static constexpr int STRIDE[3] = {1, SIDE, SIDE* SIDE};

  void addTriangle(int a, int b, int c, bool as_it_is) {
    if (!as_it_is) std::swap(b, c);
    mesh.triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                              static_cast<std::uint32_t>(c)});
  }

  Eigen::Isometry3d X_MG_;
  double scale_;
  std::array<std::array<double, N + 1>, 3> planes_;
};

using Cells = std::set<Grid::Cell>;

inline Cells randomCells(RandomInputs& random, double share) {
  Cells cells;
  Grid::forEachCell([&](const Grid::Cell& cell) {
    if (random.uniform(0.0, 1.0) < share) cells.insert(cell);
  });
  return cells;
}

/// The walls between the cells and what is not of them, facing outwards. Their edges are shared by
/// two or four triangles, the bodies touch at edges and corners, and have hollows.
inline void addSurface(const Cells& cells, Grid& grid) {
  for (const Grid::Cell& cell : cells) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool upper : {false, true}) {
        Grid::Cell next = cell;
        next[axis] += upper ? 1 : -1;
        if (cells.count(next) == 0) grid.addWall(cell, axis, upper, upper);
      }
    }
  }
}

/// Of a cell, the wall at its lower end along an axis.
using Wall = std::pair<Grid::Cell, int>;
using Walls = std::set<Wall>;

inline Walls randomWalls(RandomInputs& random, double share) {
  Walls walls;
  Grid::forEachCell([&](const Grid::Cell& cell) {
    for (int axis = 0; axis < 3; ++axis) {
      Grid::Cell above = cell;
      ++above[axis];
      if (random.uniform(0.0, 1.0) < share) walls.emplace(cell, axis);
      if (random.uniform(0.0, 1.0) < share) walls.emplace(above, axis);
    }
  });
  return walls;
}

/// The four edges of a wall, each by its lower corner and its axis.
inline std::array<std::pair<Grid::Cell, int>, 4> edgesOf(const Wall& wall) {
  const int u = (wall.second + 1) % 3, v = (wall.second + 2) % 3;
  Grid::Cell beyond_u = wall.first, beyond_v = wall.first;
  ++beyond_u[u];
  ++beyond_v[v];
  return {{{wall.first, u}, {wall.first, v}, {beyond_u, v}, {beyond_v, u}}};
}

/// Takes walls away until each edge is one of none or of several.
inline void removeLooseWalls(Walls& walls) {
  for (bool again = true; again;) {
    std::map<std::pair<Grid::Cell, int>, int> uses;
    for (const auto& wall : walls) {
      for (const auto& edge : edgesOf(wall)) ++uses[edge];
    }
    again = false;
    for (auto wall = walls.begin(); wall != walls.end();) {
      const auto edges = edgesOf(*wall);
      const bool loose = std::any_of(edges.begin(), edges.end(),
                                     [&](const auto& edge) { return uses[edge] == 1; });
      wall = loose ? walls.erase(wall) : std::next(wall);
      again = again || loose;
    }
  }
}

/// What cannot be reached from outside without passing through a wall, by flooding the cells.
inline Cells enclosedBy(const Walls& walls) {
  Cells reached;
  std::vector<Grid::Cell> queue{{-1, -1, -1}};
  while (!queue.empty()) {
    const Grid::Cell cell = queue.back();
    queue.pop_back();
    if (!reached.insert(cell).second) continue;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        Grid::Cell next = cell;
        next[axis] += step;
        if (next[axis] < -1 || next[axis] > Grid::N) continue;
        if (walls.count({step > 0 ? next : cell, axis}) == 0) queue.push_back(next);
      }
    }
  }
  Cells enclosed;
  Grid::forEachCell([&](const Grid::Cell& cell) {
    if (reached.count(cell) == 0) enclosed.insert(cell);
  });
  return enclosed;
}

}  // namespace collision_pairs
