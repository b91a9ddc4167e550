#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh_files.h"
#include "mesh_folder.h"
#include "mesh_process.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_mesh_files {

using testing::HasSubstr;

using Corners = std::array<std::array<double, 3>, 3>;

std::vector<Corners> sortedTriangles(const TriangleMesh& mesh) {
  std::vector<Corners> triangles;
  for (const auto& triangle : mesh.triangles) {
    Corners corners;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d& vertex = mesh.vertices.at(triangle[i]);
      corners[i] = {vertex.x(), vertex.y(), vertex.z()};
    }
    // From the least corner on: the orientation counts, the first corner does not.
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    triangles.push_back(corners);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::string stlRefusal(const std::string& bytes) {
  return refusal([&] { readStl(bytes); });
}
std::string objRefusal(const std::string& bytes) {
  return refusal([&] { readObj(bytes); });
}

/// A tetrahedron, with names that look like the format's words.
const char* const FACETS[] = {"0 0 0 0 1 0 1 0 0", "0 0 0 1 0 0 0 0 1", "0 0 0 0 0 1 0 1 0",
                              "1 0 0 0 1 0 0 0 1"};

std::string asciiStl() {
  std::string stl = "solid facet normal vertex\n";
  for (const char* facet : FACETS) {
    std::istringstream numbers(facet);
    stl += "  facet normal nan nan nan\n    outer loop\n";
    for (std::string x, y, z; numbers >> x >> y >> z;) {
      stl += "      vertex " + x + " " + y + " " + z + "\n";
    }
    stl += "    endloop\n  endfacet\n";
  }
  return stl + "endsolid facet normal vertex\n";
}

std::string binaryStl(const std::string& header = "") {
  std::vector<std::array<float, 9>> triangles;
  for (const char* facet : FACETS) {
    std::istringstream numbers(facet);
    triangles.emplace_back();
    for (float& number : triangles.back()) numbers >> number;
  }
  return collision_pairs::binaryStl(triangles, header);
}

const std::string OBJ =
    "# comment\no body\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nvn 0 0 1\nvt 0 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\n"
    "usemtl f\ng f\nf 1 3 2\nf 1/1/1 2/1/1 4/1/1\ns off\nl 1 5\nf -5//1 -2//1 -3//1\nf 2 3 4";

TEST(MeshFiles, AsciiAndBinaryStlAndObjGiveTheSameSolid) {
  const auto ascii = sortedTriangles(readStl(asciiStl()));
  ASSERT_EQ(ascii.size(), 4u);
  EXPECT_EQ(ascii, sortedTriangles(readStl(binaryStl())));
  EXPECT_EQ(ascii, sortedTriangles(readStl(binaryStl("solid by an exporter, facet"))));
  EXPECT_EQ(ascii, sortedTriangles(readStl(binaryStl() + "padding")));
  EXPECT_EQ(ascii, sortedTriangles(readObj(OBJ)));
}

TEST(MeshFiles, EqualVerticesAreOneAndUnusedOnesAreLeftOut) {
  EXPECT_EQ(readStl(asciiStl()).vertices.size(), 4u);
  EXPECT_EQ(readObj(OBJ).vertices.size(), 4u) << "the fifth has no triangle";
  const TriangleMesh mesh = readObj("v 0 0 0\nv -0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 4\nf 2 4 3");
  EXPECT_EQ(mesh.vertices.size(), 3u) << "-0 is 0";
}

TEST(MeshFiles, CoordinatesAreThoseOfSinglePrecision) {
  const TriangleMesh mesh = readObj("v 0.1 0 0\nv 1 0 0\nv 0 1 1e-50\nf 1 2 3");
  EXPECT_EQ(mesh.vertices[0].x(), static_cast<double>(0.1f));
  EXPECT_EQ(mesh.vertices[2].z(), 0.0);
}

/// In the plane z = 5: the face of these corners, the first of which is number `first`.
std::string polygon(const std::vector<std::array<double, 2>>& corners, std::size_t first = 0) {
  std::ostringstream obj;
  for (const auto& [x, y] : corners) obj << "v " << x << ' ' << y << " 5\n";
  obj << 'f';
  for (std::size_t i = 0; i < corners.size(); ++i) obj << ' ' << (first + i) % corners.size() + 1;
  return obj.str();
}

double areaOf(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d ab = mesh.vertices[b] - mesh.vertices[a];
    area += 0.5 * ab.cross(mesh.vertices[c] - mesh.vertices[a]).z();
  }
  return area;
}

bool contains(const TriangleMesh& mesh, double x, double y) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto side = [&](std::uint32_t from, std::uint32_t to) {
      const Eigen::Vector3d &p = mesh.vertices[from], &q = mesh.vertices[to];
      return (q.x() - p.x()) * (y - p.y()) - (q.y() - p.y()) * (x - p.x()) >= 0.0;
    };
    if (side(a, b) && side(b, c) && side(c, a)) return true;
  }
  return false;
}

TEST(MeshFiles, ConvexPolygonsAreFansOfAnySizeFromAnyCorner) {
  for (const double size : {1e-3, 1.0, 1e3}) {
    const std::vector<std::array<double, 2>> with_straight_corner = {
        {0, 0}, {size, 0}, {2 * size, 0}, {2 * size, size}, {0, size}};
    EXPECT_EQ(readObj(polygon(with_straight_corner)).triangles,
              (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
    for (std::size_t first = 0; first < 5; ++first) {
      EXPECT_EQ(readObj(polygon(with_straight_corner, first)).triangles.size(), 3u) << first;
    }
    std::vector<std::array<double, 2>> star;
    for (int i = 0; i < 5; ++i)
      star.push_back({size * std::cos(0.8 * M_PI * i), size * std::sin(0.8 * M_PI * i)});
    EXPECT_THAT(objRefusal(polygon(star)), HasSubstr("line 6: a face that crosses itself")) << size;
  }
  EXPECT_EQ(readObj("v 0 0 0\nv 1 0 0\nf 1 1 2").triangles.size(), 1u) << "a triangle without area";
}

/// Stars about the origin with random radii, and a hole with a bridge to it.
TEST(MeshFiles, OtherPolygonsAreSplitIntoTrianglesThatCoverThemOnce) {
  RandomInputs random;
  for (int round = 0; round < 300; ++round) {
    const int count = random.integer(4, 40);
    std::vector<std::array<double, 2>> corners;
    std::vector<double> radii;
    double area = 0.0;
    for (int i = 0; i < count; ++i) radii.push_back(random.uniform(0.05, 1.0));
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * M_PI * i / count;
      corners.push_back({radii[i] * std::cos(angle), radii[i] * std::sin(angle)});
      area += 0.5 * radii[i] * radii[(i + 1) % count] * std::sin(2.0 * M_PI / count);
    }
    const std::size_t first = static_cast<std::size_t>(random.integer(0, count - 1));
    const TriangleMesh mesh = readObj(polygon(corners, first));
    ASSERT_EQ(mesh.triangles.size(), corners.size() - 2) << "round " << round;
    ASSERT_NEAR(areaOf(mesh), area, 1e-5) << "round " << round;
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * M_PI * i / count;
      const double in = 0.98 * radii[i], out = 1.02 * radii[i];
      ASSERT_TRUE(contains(mesh, in * std::cos(angle), in * std::sin(angle))) << round;
      const double before = radii[(i + count - 1) % count], after = radii[(i + 1) % count];
      if (radii[i] < std::max(before, after)) continue;
      ASSERT_FALSE(contains(mesh, out * std::cos(angle), out * std::sin(angle))) << round;
    }
  }
  const TriangleMesh ring = readObj(
      polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}));
  EXPECT_NEAR(areaOf(ring), 12.0, 1e-9);
  EXPECT_FALSE(contains(ring, 2.0, 2.0));
  EXPECT_TRUE(contains(ring, 0.5, 2.0));
}

TEST(MeshFiles, WhatAnObjSaysInOtherWaysIsReadOrRefused) {
  const std::string square = "v 0 0 5\nv 1 0 5\nv 1 1 5\nv 0 1 5\n";
  for (const char* same : {"f 1 2 3 4", " f 1 2 3 4", "f 1 2 3 4 # 5", "f 1 2 3 4 #5",
                           "f 1 2 \\\n3 4", "f \\\r\n1 2 3 4", "v .0 0 0 1 # weight\nf 1 2 3 4",
                           "v 0 0 0 1 0 0 \\\n0\nf 1 2 3 4", "# C:\\\nf 1 2 3 4"}) {
    EXPECT_NEAR(areaOf(readObj(square + same)), 1.0, 1e-9) << same;
  }
  for (const char* refused : {"F 1 2 3 4", "f 1 3 2 4", "v 0 0 0 2", "surf 0 1"}) {
    EXPECT_NE(objRefusal(square + refused), "accepted") << refused;
  }
}

TEST(MeshFiles, WordsMayBeSeparatedByAnyBlank) {
  const auto expected = sortedTriangles(readStl(asciiStl()));
  for (const std::string blank : {"\t", "\r", "\v", "\f", "  "}) {
    std::string stl = asciiStl(), obj = OBJ;
    for (std::string* text : {&stl, &obj}) {
      for (std::size_t at = 0; (at = text->find(' ', at)) != text->npos; at += blank.size()) {
        text->replace(at, 1, blank);
      }
    }
    EXPECT_EQ(sortedTriangles(readStl(stl)), expected) << '"' << blank << '"';
    EXPECT_EQ(sortedTriangles(readObj(obj)), expected) << '"' << blank << '"';
  }
  std::string zeros = asciiStl();
  std::replace(zeros.begin(), zeros.end(), ' ', '\0');
  EXPECT_EQ(sortedTriangles(readStl(zeros)), expected);
}

TEST(MeshFiles, WhatIsWrongWithAnObjIsSaidInTheseWords) {
  const std::string three = "v 0 0 0\nv 1 0 0\n\nv 0 1 0\n";
  const std::string needs = ": a vertex needs three finite coordinates, not ";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"v 0 0\nv 1 0 0", "line 1" + needs + "the end of the line"},
      {"v 0 0 0\nv 0 0", "line 2" + needs + "the end of the file"},
      {"#\n\nv 0 0 nan", "line 3" + needs + "'nan'"},
      {"v 0 1e39 0", "line 1" + needs + "'1e39'"},
      {"v 0 0 a1234567890123456789", "line 1" + needs + "'a1234567890123456789'"},
      {"v 0 0 a12345678901234567890", "line 1" + needs + "'a1234567890123456789…'"},
      {"v 0 0 0\nf 1 1\n", "line 2: a face of 2 corners"},
      {three + "f 1 2 4", "line 5: a face names vertex '4', but there are 3 before it"},
      {three + "f 1 2 0", "line 5: a face names vertex '0', but there are 3 before it"},
      {three + "f 1 2 -4", "line 5: a face names vertex '-4', but there are 3 before it"},
      {three + "f 1 2 1.5", "line 5: a face names vertex '1.5', but there are 3 before it"},
      {three + "f 1 2 x/1", "line 5: a face names vertex 'x/1', but there are 3 before it"},
  };
  for (const auto& [obj, words] : cases) EXPECT_EQ(objRefusal(obj), words);
}

/// Each word of the format, misspelt where it stands for the first time.
TEST(MeshFiles, WhatIsWrongWithAnAsciiStlIsSaidInTheseWords) {
  const std::string whole =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 7.5 0\n"
      "endloop\nendfacet\nendsolid s\n";
  ASSERT_EQ(readStl(whole).triangles.size(), 1u);
  const std::vector<std::array<std::string, 3>> words = {
      {"facet", "2", "solid, facet or endsolid"},
      {"normal", "2", "'normal'"},
      {"outer", "3", "'outer'"},
      {"loop", "3", "'loop'"},
      {"vertex", "4", "'vertex'"},
      {"7.5", "6", "a finite coordinate"},
      {"endloop", "7", "'endloop'"},
      {"endfacet", "8", "'endfacet'"},
      {"endsolid", "9", "solid, facet or endsolid"}};
  for (const auto& [word, line, wanted] : words) {
    std::string misspelt = whole;
    const std::size_t at = misspelt.find(word);
    misspelt.replace(at, word.size(), "wrong");
    const std::string found = " found where " + wanted + " was expected";
    EXPECT_EQ(stlRefusal(misspelt), "line " + line + ": 'wrong'" + found);
    if (word == "facet") continue;  // what ends there is no ASCII file yet
    EXPECT_EQ(stlRefusal(whole.substr(0, at)),
              word == "endsolid" ? "it ends within a solid (truncated?)"
                                 : "line " + line + ": the end of the file" + found);
  }
  const std::vector<std::array<std::string, 3>> orders = {
      {"solid a\nsolid facet\n", "solid", "facet or endsolid"},
      {"solid facet\nendsolid\nendsolid", "endsolid", "solid"},
      {"solid a\nendsolid\nfacet", "facet", "solid"}};
  for (const auto& [stl, word, wanted] : orders) {
    const std::string line =
        std::to_string(std::count(stl.begin(), stl.end(), '\n') + (stl.back() != '\n'));
    EXPECT_EQ(stlRefusal(stl),
              "line " + line + ": '" + word + "' found where " + wanted + " was expected");
  }
}

TEST(MeshFiles, ABinaryStlIsToldByItsLengthAndElseByItsFirstWords) {
  const auto expected = sortedTriangles(readStl(binaryStl()));
  for (const char* header : {"solid by an exporter", "facet", "solid facet endsolid, exported"}) {
    EXPECT_EQ(sortedTriangles(readStl(binaryStl(header))), expected) << header;
    EXPECT_EQ(sortedTriangles(readStl(binaryStl(header) + "padding")), expected) << header;
  }
  EXPECT_TRUE(readStl(std::string(84, '\0')).triangles.empty());
  EXPECT_TRUE(readStl("solid of no triangle\nendsolid\n").triangles.empty());
  EXPECT_EQ(stlRefusal(std::string(83, '\0')), "it is too short for an STL file");
  EXPECT_EQ(stlRefusal("solid without an end"), "it is too short for an STL file");
  for (const auto& [bytes, nb_whole] :
       {std::pair{84, "0"}, {133, "0"}, {134, "1"}, {183, "1"}, {184, "2"}, {283, "3"}}) {
    EXPECT_EQ(
        stlRefusal(binaryStl().substr(0, static_cast<std::size_t>(bytes))),
        std::string("it should have 4 triangles, but ends after ") + nb_whole + " (truncated?)");
  }
  // The name may be long, but not endless.
  const std::string solid = "solid ", rest = "\n" + asciiStl().substr(asciiStl().find("  facet"));
  const auto named = [&](std::size_t end_of_first_facet) {
    return solid + std::string(end_of_first_facet - solid.size() - 8, 'n') + rest;
  };
  EXPECT_EQ(sortedTriangles(readStl(named(1024))), expected);
  EXPECT_THAT(stlRefusal(named(1025)), HasSubstr("truncated?"));
}

TEST(MeshFiles, WhatFollowsTheTrianglesThatABinaryStlCountsIsPadding) {
  const auto expected = sortedTriangles(readStl(binaryStl()));
  const std::string cut = "it counts 4 triangles, but is long enough for ";
  for (const char* header : {"", "solid by an exporter"}) {
    const std::string stl = binaryStl(header);
    EXPECT_EQ(sortedTriangles(readStl(stl + std::string(49, 'x'))), expected);
    EXPECT_EQ(sortedTriangles(readStl(stl + std::string(500, '\0'))), expected);
    EXPECT_EQ(stlRefusal(stl + std::string(50, 'x')), cut + "5");
    EXPECT_EQ(stlRefusal(stl + std::string(99, '\0') + 'x'), cut + "6");
  }
  std::string none = binaryStl();
  none[80] = 0;
  EXPECT_EQ(stlRefusal(none), "it counts 0 triangles, but is long enough for 4");
}

TEST(MeshFiles, OfAnObjOnlyWhatMakesNoSurfaceIsSkipped) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const char* harmless :
       {"vt 0 0", "vn 0 0 1",         "vp 0 0",          "o a",      "g a b",       "s 1",
        "mg 0",   "usemtl a",         "mtllib a.mtl",    "usemap a", "maplib a",    "l 1 2",
        "p 1",    "# f 1 2",          "#f 1 2",          "bevel on", "c_interp on", "d_interp on",
        "lod 1",  "shadow_obj a.obj", "trace_obj a.obj", ""}) {
    EXPECT_EQ(objRefusal(three + harmless + '\n'), "accepted") << harmless;
  }
  for (const std::string other : {"fo", "F", "V", "curv", "surf", "call", "face", "cstype"}) {
    EXPECT_EQ(objRefusal(three + other + " 1 2 3\n"),
              "line 5: '" + other + "' is not read, and may be a surface");
  }
  EXPECT_EQ(sortedTriangles(readObj("\xEF\xBB\xBF" + three)), sortedTriangles(readObj(three)));
}

TEST(MeshFiles, NoBytesDoMoreThanBeRefused) {
  constexpr int NB_MUTANTS = 20000;
  std::mt19937 random(givenSeed());
  const std::string whole[] = {asciiStl(), binaryStl(), OBJ};
  int nb_read = 0;
  for (int i = 0; i < NB_MUTANTS; ++i) {
    std::string bytes = whole[i % 3];
    for (unsigned k = 0; k <= random() % 3; ++k) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    for (const bool as_stl : {true, false}) {
      try {
        const TriangleMesh mesh = as_stl ? readStl(bytes) : readObj(bytes);
        ++nb_read;
        ASSERT_LE(mesh.triangles.size(), bytes.size()) << "mutant " << i;
        for (const auto& triangle : mesh.triangles) {
          for (const auto index : triangle) ASSERT_LT(index, mesh.vertices.size());
        }
      } catch (const InputError&) {
      }
    }
  }
  EXPECT_GT(nb_read, NB_MUTANTS / 10) << "the mutants are too broken to try anything";
}

/// geometric_shapes, as everything in ROS reads meshes, is the oracle.
TEST(MeshFiles, MeshesOfRealRobotsAreWhatRosReads) {
  const char* shared = std::getenv("COLLISION_PAIRS_SHARED");
  if (!shared || !*shared) GTEST_SKIP() << "COLLISION_PAIRS_SHARED is not set";
  int nb_files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(std::string(shared) + "/robots")) {
    const std::string ending = entry.path().extension().string();
    const bool is_stl = ending == ".stl" || ending == ".STL";
    if (!is_stl && ending != ".obj") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const TriangleMesh ours = is_stl ? readStl(bytes) : readObj(bytes);
    const TriangleMesh theirs = readMeshInProcess(entry.path());
    ASSERT_EQ(ours.triangles, theirs.triangles) << entry.path();
    ASSERT_EQ(ours.vertices.size(), theirs.vertices.size()) << entry.path();
    double size = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < ours.vertices.size(); ++i) {
      size = std::max(size, theirs.vertices[i].cwiseAbs().maxCoeff());
      difference = std::max(difference, (ours.vertices[i] - theirs.vertices[i]).norm());
    }
    // assimp computes decimals in single precision too.
    EXPECT_LE(difference, is_stl ? 0.0 : 3e-7 * size) << entry.path();
    ++nb_files;
  }
  EXPECT_GT(nb_files, 50);
}

}  // namespace collision_pairs::test_mesh_files
