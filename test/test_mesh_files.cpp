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
#include "mesh_process.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs {
namespace test_mesh_files {

namespace fs = std::filesystem;
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
  std::string stl = header;
  stl.resize(80, ' ');
  const auto append = [&](const auto& value) {
    stl.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(std::uint32_t{4});
  for (const char* facet : FACETS) {
    std::istringstream numbers(facet);
    for (int i = 0; i < 3; ++i) append(0.0f);
    for (float number; numbers >> number;) append(number);
    append(std::uint16_t{0});
  }
  return stl;
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
  const auto obj = readObj(OBJ);
  ASSERT_TRUE(obj);
  EXPECT_EQ(ascii, sortedTriangles(*obj));
}

TEST(MeshFiles, EqualVerticesAreOneAndUnusedOnesAreLeftOut) {
  EXPECT_EQ(readStl(asciiStl()).vertices.size(), 4u);
  EXPECT_EQ(readObj(OBJ)->vertices.size(), 4u) << "the fifth has no triangle";
  const auto mesh = readObj("v 0 0 0\nv -0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 4\nf 2 4 3");
  EXPECT_EQ(mesh->vertices.size(), 3u) << "-0 is 0";
}

TEST(MeshFiles, CoordinatesAreThoseOfSinglePrecision) {
  const auto mesh = readObj("v 0.1 0 0\nv 1 0 0\nv 0 1 1e-50\nf 1 2 3");
  EXPECT_EQ(mesh->vertices[0].x(), static_cast<double>(0.1f));
  EXPECT_EQ(mesh->vertices[2].z(), 0.0);
}

/// In the plane z = 5: the face of these corners, the first of which is number `first`.
std::string polygon(const std::vector<std::array<double, 2>>& corners, std::size_t first = 0) {
  std::ostringstream obj;
  for (const auto& [x, y] : corners) obj << "v " << x << ' ' << y << " 5\n";
  obj << 'f';
  for (std::size_t i = 0; i < corners.size(); ++i) obj << ' ' << (first + i) % corners.size() + 1;
  return obj.str();
}

TEST(MeshFiles, ConvexPolygonsAreFansOfAnySizeFromAnyCorner) {
  for (const double size : {1e-3, 1.0, 1e3}) {
    const std::vector<std::array<double, 2>> with_straight_corner = {
        {0, 0}, {size, 0}, {2 * size, 0}, {2 * size, size}, {0, size}};
    const auto fan = readObj(polygon(with_straight_corner));
    ASSERT_TRUE(fan);
    EXPECT_EQ(fan->triangles,
              (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
    for (std::size_t first = 0; first < 5; ++first) {
      EXPECT_TRUE(readObj(polygon(with_straight_corner, first))) << first;
      if (first == 4) continue;
      const auto dart = polygon({{0, 0}, {size, 0}, {0.1 * size, 0.1 * size}, {0, size}}, first);
      EXPECT_FALSE(readObj(dart)) << "concave at corner " << first;
    }
    std::vector<std::array<double, 2>> star;
    for (int i = 0; i < 5; ++i)
      star.push_back({size * std::cos(0.8 * M_PI * i), size * std::sin(0.8 * M_PI * i)});
    EXPECT_FALSE(readObj(polygon(star))) << "goes round twice, and turns left all the way";
  }
  EXPECT_EQ(readObj("v 0 0 0\nv 1 0 0\nf 1 1 2")->triangles.size(), 1u)
      << "a triangle without area";
}

TEST(MeshFiles, AllElseOfObjIsLeftToOthers) {
  const std::string square = "v 0 0 5\nv 1 0 5\nv 1 1 5\nv 0 1 5\n";
  ASSERT_TRUE(readObj(square + "f 1 2 3 4"));
  for (const char* other :
       {"f 1 3 2 4", "f 1 2 3 4 1 2 3 4", "f 1 2 1 2", "f 1 2 \\\n3", "f 1 2 3 \\\n4",
        "usemtl a \\\nb", "v 0 0 0 2", "v 0 0 0 1 0 0 \\\n0"}) {
    EXPECT_FALSE(readObj(square + other)) << other;
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
    EXPECT_EQ(sortedTriangles(readObj(obj).value()), expected) << '"' << blank << '"';
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
  for (const char* header : {"solid by an exporter", "facet"}) {
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
  EXPECT_EQ(sortedTriangles(readObj("\xEF\xBB\xBF" + three).value()),
            sortedTriangles(readObj(three).value()));
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
        const TriangleMesh mesh = as_stl ? readStl(bytes) : readObj(bytes).value_or(TriangleMesh());
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
    const TriangleMesh ours = is_stl ? readStl(bytes) : readObj(bytes).value();
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

}  // namespace test_mesh_files
}  // namespace collision_pairs
