#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "collision_pairs/input_error.h"
#include "mesh_files.h"
#include "mesh_process.h"
#include "random_inputs.h"

namespace collision_pairs {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
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

template <class Read>
std::string refusal(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
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

TEST(MeshFiles, ConvexPolygonsAreFansAndAllElseOfObjIsLeftToOthers) {
  const std::string square = "v 0 0 5\nv 1 0 5\nv 1 1 5\nv 0 1 5\n";
  const auto mesh = readObj(square + "f 1 2 3 4");
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->triangles.size(), 2u);
  const std::string dart = "v 0 0 5\nv 1 0 5\nv 0.1 0.1 5\nv 0 1 5\n";
  EXPECT_FALSE(readObj(dart + "f 1 2 3 4")) << "concave";
  EXPECT_FALSE(readObj(dart + "f 3 4 1 2")) << "concave from the first corner on";
  EXPECT_FALSE(readObj(square + "f 1 3 2 4")) << "crosses itself";
  EXPECT_FALSE(readObj(square + "f 1 2 3 4 1 2 3 4")) << "goes round twice";
  EXPECT_FALSE(readObj(square + "f 1 2 \\\n3")) << "continued line";
  EXPECT_FALSE(readObj("v 0 0 0 2\nv 1 0 0\nv 0 1 0\nf 1 2 3")) << "a weight";
}

TEST(MeshFiles, WhatIsWrongIsSaidWithItsPlace) {
  EXPECT_THAT(objRefusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4"), HasSubstr("line 4"));
  EXPECT_THAT(objRefusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0"), HasSubstr("'0'"));
  EXPECT_THAT(objRefusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4"), HasSubstr("'-4'"));
  EXPECT_THAT(objRefusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1.5"), HasSubstr("'1.5'"));
  EXPECT_THAT(objRefusal("v 0 0 0\nf 1 1"), HasSubstr("2 corners"));
  EXPECT_THAT(objRefusal("v 0 0\nv 1 0 0"), HasSubstr("line 1"));
  EXPECT_THAT(objRefusal("v 0 0 nan"), HasSubstr("nan"));
  EXPECT_THAT(objRefusal("v 0 0 1e39"), HasSubstr("1e39")) << "beyond single precision";
  EXPECT_THAT(stlRefusal("short"), HasSubstr("too short"));
  EXPECT_THAT(stlRefusal(binaryStl().substr(0, 150)), HasSubstr("4 triangles, but ends after 1"));
  EXPECT_TRUE(readStl("solid of no triangle\nendsolid\n").triangles.empty());
  EXPECT_THAT(stlRefusal("solid without an end"), HasSubstr("too short"));
  std::string ascii = asciiStl();
  EXPECT_THAT(stlRefusal(ascii.substr(0, ascii.find("endsolid"))), HasSubstr("within a solid"));
  EXPECT_THAT(stlRefusal(ascii.substr(0, ascii.find("endloop"))), HasSubstr("end of the file"));
  ascii.replace(ascii.find("vertex 0 0 0"), 12, "vertex 0 0 x");
  EXPECT_THAT(stlRefusal(ascii), HasSubstr("line 4: 'x'"));
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

class MeshProcess : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  std::string refusalOf(const std::string& name, const std::string& content) const {
    return refusal([&] { readMeshInProcess(file(name, content), std::chrono::seconds(1)); });
  }
  fs::path folder_ = fs::temp_directory_path() / ("mesh_files_" + std::to_string(::getpid()));
};

std::string ply(const std::string& vertices_and_faces) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices_and_faces;
}
const std::string THREE = "0 0 0\n1 0 0\n0 1 0\n";

TEST_F(MeshProcess, ReadsWhatIsSound) {
  const TriangleMesh mesh = readMeshInProcess(file("a.ply", ply(THREE + "3 0 1 2\n")));
  EXPECT_EQ(sortedTriangles(mesh), sortedTriangles(*readObj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")));
}

// Each ended or blocked the process that read it, by assimp 5.2.
TEST_F(MeshProcess, WhatBreaksAssimpIsRefused) {
  const std::string whole = ply(THREE + "3 0 1 2\n");
  for (const std::string& broken :
       {ply(THREE), whole.substr(0, 60), whole.substr(0, 30), ply(THREE + "3 0 1 -1\n"),
        ply(THREE + "0\n"), ply(THREE + "3 0 1 999999\n")}) {
    const std::string message = refusalOf("x.ply", broken);
    EXPECT_NE(message, "accepted") << broken;
    if (message.find("crashed") == std::string::npos) continue;
    EXPECT_THAT(message, AnyOf(HasSubstr("(Aborted)"), HasSubstr("(Segmentation fault)")));
  }
  const auto collada = [](const std::string& count, const std::string& indices) {
    return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
           "version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='p'>"
           "<float_array id='a' count='" +
           count +
           "'>0 0 0 1 0 0 0 0 3</float_array><technique_common><accessor source='#a' count='3' "
           "stride='3'><param name='X' type='float'/><param name='Y' type='float'/><param name='Z' "
           "type='float'/></accessor></technique_common></source><vertices id='v'><input "
           "semantic='POSITION' source='#p'/></vertices><triangles count='1'><input "
           "semantic='VERTEX' source='#v' offset='0'/><p>" +
           indices +
           "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
           "<visual_scene id='s'><node id='n'><instance_geometry url='#g'/></node></visual_scene>"
           "</library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";
  };
  EXPECT_NO_THROW(readMeshInProcess(file("sound.dae", collada("9", "0 1 2"))));
  EXPECT_NE(refusalOf("x.dae", collada("s", "0 1 2")), "accepted");
  EXPECT_NE(refusalOf("x.dae", collada("9", "0 1 2.0")), "accepted");
  EXPECT_NE(refusalOf("x.dae", collada("9", "0 1 7")), "accepted");
}

/// The process that this one has started, or "".
std::string child() {
  std::ifstream children("/proc/self/task/" + std::to_string(::getpid()) + "/children");
  EXPECT_TRUE(children);
  std::string pid;
  children >> pid;
  return pid;
}

TEST_F(MeshProcess, LeavesNoProcessBehind) {
  EXPECT_THAT(refusalOf("x.ply", ply(THREE).substr(0, 60)), HasSubstr("did not finish within"));
  EXPECT_EQ(child(), "");
}

TEST_F(MeshProcess, AnAnswerLongerThanItsLimitIsRefusedAndTheProcessEnded) {
  const std::string whole = file("a.ply", ply(THREE + "3 0 1 2\n"));
  const std::size_t bytes = 1 + 2 * 8 + 3 * 3 * 4 + 3 * 4;
  EXPECT_NO_THROW(readMeshInProcess(whole, std::chrono::seconds(30), bytes));
  EXPECT_THAT(refusal([&] { readMeshInProcess(whole, std::chrono::seconds(30), bytes - 1); }),
              HasSubstr("more than 64 bytes"));
  EXPECT_EQ(child(), "");
}

/// `of` its lines in /proc/PID: "Max open files 64 64 files" with one blank for several.
std::string limit(const std::string& lines, const std::string& of) {
  const std::size_t at = lines.find(of);
  std::istringstream words(lines.substr(std::min(at, lines.size())));
  std::string line, text;
  std::getline(words, line);
  std::istringstream split(line);
  for (std::string word; split >> word;) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string contentOf(const std::string& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_F(MeshProcess, MayGainNoRightsStartNoProcessAndWriteNoFile) {
  const std::string pipe = folder_ / "pipe.ply";  // whose reader waits for a writer
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string status, limits;
  std::thread look([&] {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (limit(limits, "Max file size") != "Max file size 0 0 bytes" &&
           std::chrono::steady_clock::now() < end) {
      const std::string process = "/proc/" + child();
      limits = contentOf(process + "/limits");
      status = contentOf(process + "/status");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  EXPECT_NE(refusal([&] { readMeshInProcess(pipe, std::chrono::seconds(5)); }), "accepted");
  look.join();
  EXPECT_EQ(limit(status, "NoNewPrivs"), "NoNewPrivs: 1");
  EXPECT_EQ(limit(limits, "Max processes"), "Max processes 0 0 processes");
  EXPECT_EQ(limit(limits, "Max open files"), "Max open files 64 64 files");
  EXPECT_EQ(limit(limits, "Max file size"), "Max file size 0 0 bytes");
  EXPECT_EQ(limit(limits, "Max core file size"), "Max core file size 0 0 bytes");
  EXPECT_EQ(limit(limits, "Max cpu time"), "Max cpu time 60 60 seconds");
  EXPECT_EQ(limit(limits, "Max address space"), "Max address space 4294967296 4294967296 bytes");
}

}  // namespace
}  // namespace collision_pairs
