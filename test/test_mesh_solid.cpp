#include <gtest/gtest.h>

#include "mesh_solid.h"
#include "mesh_variants.h"
#include "test_shapes.h"
#include "wall_grid.h"
#include "winding_number.h"

namespace collision_pairs::test_mesh_solid {

using Eigen::Isometry3d;
using Eigen::Vector3d;

WindingNumber solidOf(const TriangleMesh& mesh) {
  return WindingNumber(mesh.vertices, findSolid(mesh).outward);
}

bool holds(const TriangleMesh& mesh, const Vector3d& p) { return solidOf(mesh).holds(p); }

TriangleMesh turnedAtRandom(TriangleMesh mesh, RandomInputs& random) {
  for (auto& t : mesh.triangles) {
    if (random.integer(0, 1)) std::swap(t[0], t[1]);
  }
  return mesh;
}

/// Triangles over an edge of the mesh and any of its vertices, each with its opposite.
void addOppositePairs(TriangleMesh& mesh, int count, RandomInputs& random) {
  const auto last = static_cast<int>(mesh.vertices.size()) - 1;
  for (int i = 0; i < count; ++i) {
    const auto& t = mesh.triangles[random.integer(0, static_cast<int>(mesh.triangles.size()) - 1)];
    const auto a = t[0], b = t[1], c = static_cast<std::uint32_t>(random.integer(0, last));
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({c, b, a});
  }
}

/// The mesh holds a point if and only if it is in one of the cells.
void expectHolds(const TriangleMesh& mesh, const Grid& grid, const Cells& cells,
                 RandomInputs& random, const char* what, int round) {
  const WindingNumber solid = solidOf(mesh);
  for (int i = 0; i < 60; ++i) {
    const auto [p, cell] = grid.randomPoint(random);
    ASSERT_EQ(solid.holds(p), cells.count(cell) == 1) << what << ", round " << round;
  }
}

/// The same in any of the ways to write a consistent surface down.
template <class Inside>
void expectHolds(const TriangleMesh& mesh, double reach, RandomInputs& random,
                 const Inside& inside) {
  for (const TriangleMesh& variant : {mesh, insideOut(mesh), asSoup(mesh, random)}) {
    const WindingNumber solid = solidOf(variant);
    for (int i = 0; i < 60; ++i) {
      const Vector3d p = random.vector(-reach, reach);
      ASSERT_EQ(solid.holds(p), inside(p)) << p.transpose();
    }
  }
}

TEST(MeshSolid, AConsistentSurfaceIsTakenAsItIs) {
  RandomInputs random;
  for (int round = 0; round < 500; ++round) {
    Grid grid(random);
    const Cells cells = randomCells(random, random.uniform(0.02, 0.98));
    addSurface(cells, grid);
    if (cells.empty()) continue;
    expectHolds(grid.mesh, grid, cells, random, "as made", round);
    expectHolds(insideOut(grid.mesh), grid, cells, random, "inside out", round);
    expectHolds(asSoup(grid.mesh, random), grid, cells, random, "no vertex shared", round);
    expectHolds(joined(grid.mesh, grid.mesh), grid, cells, random, "written twice", round);
    addOppositePairs(grid.mesh, random.integer(1, 20), random);
    expectHolds(grid.mesh, grid, cells, random, "with opposite pairs", round);
    expectHolds(asSoup(grid.mesh, random), grid, cells, random, "pairs, not shared", round);
  }
}

TEST(MeshSolid, BoxesThatShareWallsAreAllInsideWhicheverWayEachFaces) {
  RandomInputs random;
  for (int round = 0; round < 300; ++round) {
    Grid grid(random);
    const Cells cells = randomCells(random, random.uniform(0.02, 1.0));
    if (cells.empty()) continue;
    const bool alike = round % 2 == 0;
    for (const Grid::Cell& cell : cells) grid.addBox(cell, alike || random.integer(0, 1));
    expectHolds(grid.mesh, grid, cells, random, alike ? "all outwards" : "each as it likes", round);
  }
}

TEST(MeshSolid, WhatTrianglesEncloseIsInsideWhicheverWayTheyFace) {
  RandomInputs random;
  int enclosed_cells = 0;
  for (int round = 0; round < 500; ++round) {
    Grid grid(random);
    Walls walls = randomWalls(random, random.uniform(0.2, 0.9));
    removeLooseWalls(walls);  // with them, what is nearly enclosed may count as closed
    if (walls.empty()) continue;
    for (const auto& [cell, axis] : walls) grid.addWall(cell, axis, false, true);
    const Cells enclosed = enclosedBy(walls);
    enclosed_cells += static_cast<int>(enclosed.size());
    expectHolds(turnedAtRandom(grid.mesh, random), grid, enclosed, random, "walls", round);
  }
  EXPECT_GT(enclosed_cells, 1000);
}

TEST(MeshSolid, NoLooseTriangleOpensWhatTheOthersEnclose) {
  RandomInputs random;
  int enclosed_cells = 0;
  for (int round = 0; round < 500; ++round) {
    Grid grid(random);
    const Walls walls = randomWalls(random, random.uniform(0.2, 0.9));
    for (const auto& [cell, axis] : walls) grid.addWall(cell, axis, false, true);
    const WindingNumber solid = solidOf(turnedAtRandom(grid.mesh, random));
    const Cells enclosed = enclosedBy(walls);
    enclosed_cells += static_cast<int>(enclosed.size());
    for (int i = 0; i < 100; ++i) {
      const auto [p, cell] = grid.randomPoint(random);
      if (enclosed.count(cell) == 0) continue;
      ASSERT_TRUE(solid.holds(p)) << "round " << round;
    }
  }
  EXPECT_GT(enclosed_cells, 1000);
}

/// A tetrahedron, and whether a point is inside: on the same side of each face as the fourth
/// corner.
struct Tetrahedron {
  std::array<Vector3d, 4> corners;

  TriangleMesh mesh() const {
    TriangleMesh mesh;
    mesh.vertices.assign(corners.begin(), corners.end());
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    return mesh;
  }
  bool holds(const Vector3d& p) const {
    for (int i = 0; i < 4; ++i) {
      const Vector3d &a = corners[i], &b = corners[(i + 1) % 4], &c = corners[(i + 2) % 4];
      const Vector3d normal = (b - a).cross(c - a);
      if (normal.dot(p - a) * normal.dot(corners[(i + 3) % 4] - a) < 0.0) return false;
    }
    return true;
  }
};

TEST(MeshSolid, FansAroundAnEdgeAreInsideWhicheverWayTheirTrianglesFace) {
  RandomInputs random;
  for (int round = 0; round < 300; ++round) {
    const Vector3d low = random.vector(-0.2, 0.2), high = low + Vector3d(0.1, 0.2, 1.0);
    const int leaves = random.integer(2, 9);
    std::vector<Tetrahedron> fan;
    TriangleMesh mesh;
    for (int i = 0; i < leaves; ++i) {
      const auto arm = [&](double at) -> Vector3d {
        const double angle = 2.0 * M_PI * (i + at) / leaves;
        return low + Vector3d(std::cos(angle), std::sin(angle), random.uniform(0.2, 0.8));
      };
      fan.push_back({{low, high, arm(random.uniform(0.1, 0.4)), arm(random.uniform(0.5, 0.9))}});
      const TriangleMesh leaf = fan.back().mesh();
      mesh = joined(mesh, random.integer(0, 1) ? leaf : insideOut(leaf));
    }
    const auto inside = [&](const Vector3d& p) {
      return std::any_of(fan.begin(), fan.end(), [&](const auto& leaf) { return leaf.holds(p); });
    };
    expectHolds(mesh, 1.3, random, inside);
    expectHolds(turnedAtRandom(mesh, random), 1.3, random, inside);
  }
}

TEST(MeshSolid, AShellThatFacesInwardsWithinABodyBoundsAHollow) {
  RandomInputs random;
  for (int round = 0; round < 200; ++round) {
    Vector3d center = Vector3d::Zero(), half(1.0, 1.0, 1.0);
    std::vector<std::pair<Vector3d, Vector3d>> boxes;
    TriangleMesh alternating, alike;
    for (int i = random.integer(2, 5); i > 0; --i) {
      boxes.emplace_back(center, half);
      const TriangleMesh shell = movedBy(boxMesh(half), center);
      alternating = joined(alternating, boxes.size() % 2 ? shell : insideOut(shell));
      alike = joined(alike, shell);
      half *= random.uniform(0.5, 0.9);
      center += random.vector(-0.04, 0.04).cwiseProduct(half);
    }
    const auto around = [&](const Vector3d& p) {
      return std::count_if(boxes.begin(), boxes.end(), [&](const auto& box) {
        return ((p - box.first).cwiseAbs() - box.second).maxCoeff() < 0.0;
      });
    };
    expectHolds(alternating, 1.2, random, [&](const Vector3d& p) { return around(p) % 2 == 1; });
    expectHolds(alike, 1.2, random, [&](const Vector3d& p) { return around(p) > 0; });
  }
}

TEST(MeshSolid, BodiesThatOverlapInOneMeshDoNotCancel) {
  const TriangleMesh mesh =
      joined(boxMesh({1, 1, 1}), insideOut(movedBy(boxMesh({1, 1, 1}), {0.5, 0, 0})));
  EXPECT_TRUE(holds(mesh, {0.2, 0.0, 0.0}));
}

TEST(MeshSolid, ADentThatComesOutOnTheOtherSideEnclosesWhatIsThere) {
  RandomInputs random;
  TriangleMesh mesh = boxMesh({1, 1, 1});
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);  // the top
  mesh.vertices.emplace_back(0.0, 0.0, -2.0);
  for (const auto& [a, b] : {std::pair(4u, 5u), {5u, 7u}, {7u, 6u}, {6u, 4u}}) {
    mesh.triangles.push_back({a, b, 8u});
  }
  expectHolds(mesh, 2.2, random, [](const Vector3d& p) {
    const bool in_box = p.cwiseAbs().maxCoeff() < 1.0;
    const bool in_dent = p.head<2>().cwiseAbs().maxCoeff() < (p[2] + 2.0) / 3.0 && p[2] < 1.0;
    return in_box != in_dent;
  });
}

TEST(MeshSolid, AHalfTurnedInsideOutMeshStillHoldsItsInside) {
  TriangleMesh mesh = boxMesh({1, 1, 1});
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 2) {
    std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  }
  EXPECT_TRUE(holds(mesh, {0.5, 0.2, -0.3}));
  EXPECT_TRUE(holds(insideOut(mesh), {0.5, 0.2, -0.3}));
  EXPECT_FALSE(holds(mesh, {1.5, 0.2, -0.3}));
}

TEST(MeshSolid, OneTurnedTriangleIsTurnedBack) {
  for (std::size_t i = 0; i < bumpyBall(12, 1.0).triangles.size(); ++i) {
    TriangleMesh mesh = bumpyBall(12, 1.0);
    auto& [a, b, c] = mesh.triangles[i];
    const Vector3d on = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0;
    std::swap(a, b);
    const WindingNumber solid = solidOf(mesh);
    EXPECT_TRUE(solid.holds(0.99 * on)) << i;
    EXPECT_FALSE(solid.holds(1.01 * on)) << i;
  }
}

TEST(MeshSolid, RepeatedTrianglesAndUnsharedVerticesChangeNothing) {
  TriangleMesh soup;
  const TriangleMesh box = boxMesh({1, 1, 1});
  for (const auto& t : box.triangles) {
    for (const bool turned : {false, true}) {
      const auto n = static_cast<std::uint32_t>(soup.vertices.size());
      for (const std::uint32_t i : t) soup.vertices.push_back(box.vertices[i]);
      soup.triangles.push_back({n, n + 1 + turned, n + 2 - turned});
    }
  }
  EXPECT_TRUE(holds(soup, {0.0, 0.0, 0.9}));
  EXPECT_FALSE(holds(soup, {0.0, 0.0, 1.1}));
}

/// The box from -1 to 1, each face cut into cells of its own, `fewest` or more along each side:
/// vertices lie on edges of neighbours.
TriangleMesh boxWhoseFacesDoNotMatch(int fewest, RandomInputs& random) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const int nu = random.integer(fewest, fewest + 6), nv = random.integer(fewest, fewest + 6);
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (int v = 0; v <= nv; ++v) {
        for (int u = 0; u <= nu; ++u) {
          Vector3d p;
          p[axis] = side;
          p[(axis + 1) % 3] = 2.0 * u / nu - 1.0;
          p[(axis + 2) % 3] = 2.0 * v / nv - 1.0;
          mesh.vertices.push_back(p);
        }
      }
      const auto at = [&](int u, int v) {
        return first + static_cast<std::uint32_t>(v * (nu + 1) + u);
      };
      for (int v = 0; v < nv; ++v) {
        for (int u = 0; u < nu; ++u) {
          std::array<std::uint32_t, 3> s{at(u, v), at(u + 1, v), at(u + 1, v + 1)},
              t{at(u, v), at(u + 1, v + 1), at(u, v + 1)};
          if (side < 0.0) std::swap(s[0], s[1]), std::swap(t[0], t[1]);
          mesh.triangles.push_back(s);
          mesh.triangles.push_back(t);
        }
      }
    }
  }
  return mesh;
}

TEST(MeshSolid, EdgesThatMatchInPartsOnlyLeaveNoGap) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    expectHolds(boxWhoseFacesDoNotMatch(1, random), 1.2, random,
                [](const Vector3d& p) { return p.cwiseAbs().maxCoeff() < 1.0; });
  }
}

TEST(MeshSolid, ASmallBodyThatStandsOnAFaceDoesNotOpenIt) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    TriangleMesh mesh = boxWhoseFacesDoNotMatch(5, random);
    const auto [a, b, c] = mesh.triangles.back();  // on top
    const auto tip = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0 +
                            Vector3d(0.0, 0.0, 0.05));
    for (const auto& [i, j] : {std::pair(a, b), {b, c}, {c, a}}) {
      mesh.triangles.push_back({i, j, tip});
    }
    const WindingNumber solid = solidOf(mesh);
    for (int i = 0; i < 60; ++i) {
      const Vector3d p = random.vector(-0.9, 0.9);
      ASSERT_TRUE(solid.holds(p)) << p.transpose() << ", round " << round;
    }
  }
}

TEST(MeshSolid, VerticesThatNearlyMeetLeaveNoGap) {
  RandomInputs random;
  TriangleMesh soup = asSoup(bumpyBall(16, 1.0), random);
  for (Vector3d& v : soup.vertices) v += random.vector(-1e-6, 1e-6);
  TriangleMesh sheet = boxMesh({1, 1, 1});
  sheet.triangles.resize(2);
  for (const TriangleMesh& mesh :
       {soup, insideOut(soup), joined(soup, movedBy(sheet, {3, 0, 0}))}) {
    EXPECT_TRUE(holds(mesh, {0.1, 0.2, 0.8}));
    EXPECT_FALSE(holds(mesh, {0.1, 0.2, 1.2}));
  }
}

TEST(MeshSolid, MinusZeroIsZero) {
  RandomInputs random;
  TriangleMesh soup = asSoup(movedBy(boxMesh({1, 1, 1}), {1, 1, 1}), random);
  for (Vector3d& v : soup.vertices) {
    v = v.unaryExpr([&](double x) { return random.integer(0, 1) && x == 0.0 ? -0.0 : x; }).eval();
  }
  soup = turnedAtRandom(soup, random);  // so that it takes the edges to put it right
  EXPECT_TRUE(holds(soup, {0.1, 0.2, 0.1}));
  EXPECT_FALSE(holds(soup, {-0.1, 0.2, 0.1}));
}

TEST(MeshSolid, AnOpenSheetEnclosesNothing) {
  TriangleMesh bowl = boxMesh({1, 1, 1});
  bowl.triangles.resize(10);
  EXPECT_FALSE(holds(bowl, {-0.5, 0.0, 0.0}));
  RandomInputs random;
  EXPECT_FALSE(holds(turnedAtRandom(bowl, random), {-0.5, 0.0, 0.0}));
}

TEST(MeshSolid, AFlapNeitherOpensABoxNorEnclosesAnything) {
  for (const double reach : {0.1, 5.0}) {
    TriangleMesh mesh = boxMesh({1, 1, 1});
    mesh.vertices.emplace_back(1.0 + reach, 0.0, 0.0);
    mesh.triangles.push_back({1, 3, 8});
    EXPECT_TRUE(holds(mesh, {0.9, 0.0, 0.0}));
    EXPECT_FALSE(holds(mesh, {1.05, 0.0, -0.95}));
    EXPECT_FALSE(holds(mesh, {1.05, 0.0, -0.9}));
  }
}

TEST(MeshSolid, ATornSeamStillCountsAsClosedAndAMissingTenthDoesNot) {
  TriangleMesh torn = bumpyBall(40, 1.0);
  torn.triangles.erase(torn.triangles.begin() + 700);
  EXPECT_TRUE(holds(torn, {0.0, 0.1, 0.2}));
  EXPECT_TRUE(holds(ballWithoutItsTop(37), {0.0, 0.1, 0.2}));   // 1.4 % of the area missing
  EXPECT_FALSE(holds(ballWithoutItsTop(32), {0.0, 0.1, 0.2}));  // 10 %
}

}  // namespace collision_pairs::test_mesh_solid
