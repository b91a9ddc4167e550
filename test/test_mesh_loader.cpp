#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "collision_pairs/aabb.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"

namespace collision_pairs {
namespace test_mesh_loader {

namespace fs = std::filesystem;

const Eigen::Vector3d ONE = Eigen::Vector3d::Ones();

class MeshLoaderTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return "file://" + (folder_ / name).string();
  }
  std::string refusal(const std::string& uri) {
    try {
      validateShape(Mesh{load_(uri, ONE)});
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path folder_ = fs::temp_directory_path() / ("mesh_loader_" + std::to_string(::getpid()));
  MeshLoader load_ = makeMeshLoader();
};

std::string binaryStl(const std::vector<std::array<float, 9>>& triangles) {
  std::string stl(80, ' ');
  const auto append = [&](const auto& value) {
    stl.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(static_cast<std::uint32_t>(triangles.size()));
  for (const auto& corners : triangles) {
    for (int i = 0; i < 3; ++i) append(0.0f);
    for (const float c : corners) append(c);
    append(static_cast<std::uint16_t>(0));
  }
  return stl;
}

const std::array<float, 9> TRIANGLE = {0, 0, 0, 1, 0, 0, 0, 2, 0};

TEST_F(MeshLoaderTest, ScaleAppliesToEachAxisAndMayMirror) {
  const auto mesh = load_(file("t.stl", binaryStl({TRIANGLE})), {-1.0, 0.5, 1.0});
  const Aabb box = computeAabb(Mesh{mesh}, Eigen::Isometry3d::Identity());
  EXPECT_TRUE(box.min.isApprox(Eigen::Vector3d(-1, 0, 0), 1e-12));
  EXPECT_TRUE((box.max - Eigen::Vector3d(0, 1, 0)).isZero(1e-12));
}

TEST_F(MeshLoaderTest, OneFileAtScalesThatDifferOnOneAxisIsTwoMeshes) {
  const std::string uri = file("t.stl", binaryStl({{0, 0, 0, 1, 0, 1, 0, 2, 1}}));
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d scale = ONE;
    scale[axis] = 3.0;
    const auto plain = load_(uri, ONE), stretched = load_(uri, scale);
    for (std::size_t i = 0; i < plain->vertices.size(); ++i) {
      EXPECT_EQ(stretched->vertices[i], plain->vertices[i].cwiseProduct(scale)) << axis;
    }
  }
}

TEST_F(MeshLoaderTest, ReadsPackageUrisAndObj) {
  const auto arch = load_("package://collision_pairs/config/demo/meshes/arch.obj", ONE);
  const Aabb box = computeAabb(Mesh{arch}, Eigen::Isometry3d::Identity());
  EXPECT_TRUE(box.min.isApprox(Eigen::Vector3d(-0.18, -0.03, 0.0), 1e-6));
  EXPECT_TRUE(box.max.isApprox(Eigen::Vector3d(0.18, 0.03, 0.34), 1e-6));
}

/// A triangle with the corners 0, (1, 0, 0) and (0, 0, 3). `asset`: what <asset> holds.
std::string collada(const std::string& asset) {
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
         "version='1.4.1'><asset>" +
         asset +
         "</asset><library_geometries>"
         "<geometry id='g'><mesh><source id='p'><float_array id='a' count='9'>0 0 0 1 0 0 0 0 3"
         "</float_array><technique_common><accessor source='#a' count='3' stride='3'>"
         "<param name='X' type='float'/><param name='Y' type='float'/><param name='Z' "
         "type='float'/></accessor></technique_common></source><vertices id='v'><input "
         "semantic='POSITION' source='#p'/></vertices><triangles count='1'><input "
         "semantic='VERTEX' source='#v' offset='0'/><p>0 1 2</p></triangles></mesh></geometry>"
         "</library_geometries><library_visual_scenes><visual_scene id='s'><node id='n'>"
         "<instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url='#s'/></scene></COLLADA>";
}

Eigen::Vector3d mostOf(const TriangleMesh& mesh) {
  Eigen::Vector3d most = mesh.vertices.front();
  for (const Eigen::Vector3d& vertex : mesh.vertices) most = most.cwiseMax(vertex);
  return most;
}

TEST_F(MeshLoaderTest, ColladaIsTakenAsItIsWhateverItsUpAxis) {
  for (const std::string up : {"Y_UP", "Z_UP"}) {
    const auto mesh = load_(file(up + ".dae", collada("<up_axis>" + up + "</up_axis>")), ONE);
    EXPECT_TRUE(mostOf(*mesh).isApprox(Eigen::Vector3d(1, 0, 3), 1e-6)) << up;
  }
}

TEST_F(MeshLoaderTest, ColladaIsInItsUnit) {
  const std::vector<std::pair<std::string, double>> units = {
      {"", 1.0},
      {"<unit name='meter' meter='1'/>", 1.0},
      {"<unit name='centimeter' meter='0.01'/>", 0.01},
      {"<unit meter='2.5'/><up_axis>Y_UP</up_axis>", 2.5}};
  int number = 0;
  for (const auto& [asset, metres] : units) {
    const auto mesh = load_(file(std::to_string(number++) + ".dae", collada(asset)), ONE);
    EXPECT_TRUE(mostOf(*mesh).isApprox(metres * Eigen::Vector3d(1, 0, 3), 1e-6)) << asset;
  }
  for (const char* none : {"0", "-1", "nan", "inch"}) {
    EXPECT_THAT(refusal(file("none.dae", collada("<unit meter='" + std::string(none) + "'/>"))),
                testing::HasSubstr("is no length"));
  }
}

TEST_F(MeshLoaderTest, TheFirstMeshWhoseUnitIsNotTheMetreIsSaidAndNoOther) {
  std::vector<std::string> said;
  const MeshLoader load = makeMeshLoader([&](const std::string& what) { said.push_back(what); });
  load(file("metres.dae", collada("<unit meter='1'/>")), ONE);
  EXPECT_TRUE(said.empty());
  for (const std::string name : {"one.dae", "other.dae"}) {
    for (const double scale : {1.0, 2.0}) {
      load(file(name, collada("<unit meter='0.01'/>")), scale * ONE);
    }
  }
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0], testing::HasSubstr("one.dae' is in units of 0.01 m"));
}

/// `text` with `what` before the first `place`.
std::string before(const std::string& place, const std::string& what, std::string text) {
  return text.insert(text.find(place), what);
}

/// One triangle whose corners are in the file triangle.bin beside it.
std::string gltf(const std::string& nodes) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" +
         nodes + R"(,
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 4}]}],
    "buffers": [{"uri": "triangle.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 2, 0]}]})";
}

// rviz places the meshes of the root by the root, all others by the nodes below it.
TEST_F(MeshLoaderTest, ANodeOfGltfPlacesItsMeshAsInRviz) {
  const std::array<float, 9> corners = {0, 0, 0, 1, 0, 0, 0, 2, 0};
  file("triangle.bin", {reinterpret_cast<const char*>(corners.data()), sizeof corners});
  const auto most = [&](const std::string& nodes) {
    return mostOf(*load_(file("t" + std::to_string(nodes.size()) + ".gltf", gltf(nodes)), ONE));
  };
  EXPECT_EQ(most(R"([{"mesh": 0}])"), Eigen::Vector3d(1, 2, 0));
  EXPECT_EQ(most(R"([{"mesh": 0, "translation": [10, 20, 30], "scale": [2, 3, 4]}])"),
            Eigen::Vector3d(12, 26, 30));
  EXPECT_EQ(most(R"([{"children": [1], "translation": [5, 5, 5]},
                     {"mesh": 0, "translation": [10, 20, 30]}])"),
            Eigen::Vector3d(11, 22, 30));
  EXPECT_EQ(most(R"([{"mesh": 0, "translation": [0, 0, 7], "children": [1]},
                     {"mesh": 0, "translation": [10, 20, 3]}])"),
            Eigen::Vector3d(11, 22, 7));
}

TEST_F(MeshLoaderTest, AnyFormatIsReadFromAFolderOfAnyName) {
  for (const std::string name : {"a b", "a#b", "a?b", "a%b", "100%25", "\u00e4", "a&b=c;d+e"}) {
    const fs::path folder = folder_ / name;
    fs::create_directories(folder);
    std::ofstream(folder / "t.dae") << collada("");
    std::ofstream(folder / "t.stl", std::ios::binary) << binaryStl({TRIANGLE});
    std::ofstream(folder / "t.obj") << "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n";
    for (const char* mesh : {"t.dae", "t.stl", "t.obj"}) {
      EXPECT_EQ(refusal("file://" + (folder / mesh).string()), "accepted") << name << ' ' << mesh;
    }
  }
}

TEST_F(MeshLoaderTest, APathIsDecodedWhereThereIsNoFileAsItIsWritten) {
  file("a b.stl", binaryStl({TRIANGLE}));
  file("c%20d.stl", binaryStl({TRIANGLE}));
  file("c d.stl", "not this one");
  const std::string folder = "file://" + folder_.string();
  EXPECT_EQ(refusal(folder + "/a%20b.stl"), "accepted");
  EXPECT_EQ(refusal(folder + "/%61%20b.stl"), "accepted");
  EXPECT_EQ(refusal(folder + "/c%20d.stl"), "accepted");
  EXPECT_THAT(refusal(folder + "/e%2"), testing::HasSubstr("there is no file"));
}

TEST_F(MeshLoaderTest, AUrdfOfAFileHasPathsRelativeToItsFolder) {
  fs::create_directories(folder_ / "meshes");
  file("meshes/t.stl", binaryStl({TRIANGLE}));
  const std::string written = file("u.stl", binaryStl({TRIANGLE}));
  load_ = relativeTo((folder_ / "meshes").string(), makeMeshLoader());
  for (const std::string& uri : {std::string("t.stl"), std::string("./t.stl"), written,
                                 std::string("../u.stl"), (folder_ / "u.stl").string()}) {
    EXPECT_EQ(refusal(uri), "accepted") << uri;
  }
  EXPECT_THAT(refusal("none.stl"), testing::HasSubstr("there is no file"));
  EXPECT_THAT(refusal("http://x/t.stl"), testing::HasSubstr("only package:// and file://"));
  load_ = relativeTo("", makeMeshLoader());
  EXPECT_THAT(refusal("t.stl"), testing::HasSubstr("it is relative to a file"));
}

TEST_F(MeshLoaderTest, AsciiStlIsReadHoweverItIsWritten) {
  const std::string plain =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\n"
      "endloop\nendfacet\nendsolid a\n";
  std::string capitals = plain, returns = plain, both = plain;
  std::transform(plain.begin(), plain.end(), capitals.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::replace(returns.begin(), returns.end(), '\n', '\r');
  for (std::size_t at = 0; (at = both.find('\n', at)) != std::string::npos; at += 2) {
    both.replace(at, 1, "\r\n");
  }
  std::string end = plain;
  end.replace(end.find("endsolid"), 8, "ENDSOLID");
  const std::string bom = "\xEF\xBB\xBF";
  for (const std::string& text : {plain, capitals, returns, both, end, bom + plain,
                                  "  \n\t " + plain, bom + "\r\r" + returns, "\n" + capitals}) {
    const auto mesh = makeMeshLoader()(file("a.stl", text), ONE);
    EXPECT_TRUE(mostOf(*mesh).isApprox(Eigen::Vector3d(1, 2, 0))) << text;
  }
}

TEST_F(MeshLoaderTest, ABinaryStlMayCallItselfSolidAndSpeakOfFacets) {
  std::string named = binaryStl({TRIANGLE, TRIANGLE});
  const std::string name = "solid facet endsolid, exported";
  named.replace(0, name.size(), name);
  for (const std::string& padding : {std::string(), std::string(7, ' '), std::string(300, '\0')}) {
    const auto mesh = makeMeshLoader()(file("b.stl", named + padding), ONE);
    EXPECT_TRUE(mostOf(*mesh).isApprox(Eigen::Vector3d(1, 2, 0)));
  }
}

TEST_F(MeshLoaderTest, AMeshIsReadOnceAtAScaleAndCalledByItsUri) {
  const std::string uri = file("t.stl", binaryStl({TRIANGLE}));
  const auto mesh = load_(uri, ONE);
  EXPECT_EQ(mesh->name, uri);
  EXPECT_EQ(load_(uri, ONE), mesh);
  EXPECT_NE(load_(uri, 2.0 * ONE), mesh);
}

TEST_F(MeshLoaderTest, EndingsMayBeInCapitals) {
  const std::string stl =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n" + std::string(90, ' ');
  for (const char* name : {"a.stl", "a.STL", "a.Stl"}) {
    const std::string uri = file(name, stl);
    EXPECT_EQ(refusal(uri),
              "mesh '" + uri + "': line 4: 'x' found where a finite coordinate was expected");
  }
  for (const char* name : {"a.obj", "a.OBJ"}) {
    const std::string uri = file(name, "v 0 0 0\nf 1 1");
    EXPECT_EQ(refusal(uri), "mesh '" + uri + "': line 2: a face of 2 corners");
  }
}

TEST_F(MeshLoaderTest, WhatIsNoMeshIsRefusedByUriInTheseWords) {
  const std::string demo = std::string(PROJECT_SOURCE_DIR) + "/none.stl";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"file:///nowhere/x.stl", "there is no file /nowhere/x.stl"},
      {"package://no_such_package/x.stl", "package 'no_such_package' is not on ROS_PACKAGE_PATH"},
      {"package://collision_pairs", "it names a package, but no file"},
      {"package://collision_pairs/none.stl", "there is no file " + demo},
      {"http://127.0.0.1/x.stl", "only package:// and file:// are read"},
      {"x.stl",
       "it is relative to a file that is not known here; write package://PACKAGE/PATH or "
       "file:///PATH, or give the URDF as a file"},
      {"xfile://x.stl", "only package:// and file:// are read"},
      {"file:///dev/zero", "/dev/zero is not a file"},
      {"file://" + folder_.string(), folder_.string() + " is not a file"},
      {file("nothing.stl", ""), "the file is empty"},
      {file("text.stl", "this is no mesh at all"), "it is too short for an STL file"},
  };
  testing::internal::CaptureStderr();
  for (const auto& [uri, why] : cases) EXPECT_EQ(refusal(uri), "mesh '" + uri + "': " + why);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "")
      << "rospack would print that a package is missing";
}

TEST_F(MeshLoaderTest, TruncatedOrNanMeshesAreRefused) {
  const std::string whole = binaryStl(std::vector<std::array<float, 9>>(10, TRIANGLE));
  EXPECT_NE(refusal(file("cut.stl", whole.substr(0, whole.size() - 30))), "accepted");
  EXPECT_NE(refusal(file("header.stl", whole.substr(0, 83))), "accepted");
  EXPECT_NE(refusal(file("none.stl", binaryStl({}))), "accepted");
  auto broken = TRIANGLE;
  broken[4] = NAN;
  EXPECT_NE(refusal(file("nan.stl", binaryStl({TRIANGLE, broken}))), "accepted");
  broken[4] = INFINITY;
  EXPECT_NE(refusal(file("inf.stl", binaryStl({TRIANGLE, broken}))), "accepted");
  EXPECT_NE(refusal(file("cut.obj", "v 0 0 0\nv 1 0")), "accepted");
  EXPECT_NE(refusal(file("cut.dae", "<COLLADA><library_geometries>")), "accepted");
}

TEST_F(MeshLoaderTest, GltfThatRequiresAnExtensionIsRefusedUnlessThatIsOfLooks) {
  file("triangle.bin", std::string(36, '\0').replace(12, 4, "\0\0\x80?", 4));
  int number = 0;
  const auto refusalOf = [&](const std::string& extensions) {
    const std::string required = "\"extensionsRequired\": [" + extensions + "], ";
    return refusal(file(std::to_string(number++) + ".gltf",
                        before("\"asset\"", required, gltf(R"([{"mesh": 0}])"))));
  };
  for (const char* none :
       {"", R"("KHR_materials_unlit")", R"("KHR_texture_transform" , "KHR_materials_ior")"}) {
    EXPECT_EQ(refusalOf(none), "accepted") << none;
  }
  for (const char* some : {R"("KHR_mesh_quantization")", R"("EXT_meshopt_compression")",
                           R"("KHR_materials_unlit", "KHR_draco_mesh_compression")"}) {
    EXPECT_THAT(refusalOf(some), testing::HasSubstr("needs the glTF extension")) << some;
  }
}

TEST_F(MeshLoaderTest, ColladaOfWhichAPartWouldBeMissingIsRefused) {
  const std::string whole = collada(""), in_node = "<instance_geometry";
  int number = 0;
  const auto refusalOf = [&](const std::string& text) {
    return refusal(file(std::to_string(number++) + ".dae", text));
  };
  for (const std::string kind : {"geometry", "node", "controller"}) {
    for (const std::string url : {"#h", "#s", "#", "g", ""}) {
      const std::string added = "<instance_" + kind + " url='" + url + "'/>";
      EXPECT_THAT(refusalOf(before(in_node, added, whole)), testing::Not("accepted")) << added;
    }
  }
  EXPECT_THAT(
      refusalOf(before(in_node, "<instance_geometry url='#h'/>", whole)),
      testing::HasSubstr("line 1: <instance_geometry url='#h'>: there is not one <geometry>"));
  const std::string triangles =
      "<triangles count='1'><input semantic='VERTEX' source='#v' "
      "offset='0'/><p>0 1 2</p></triangles>";
  const std::pair<std::string, std::string> others[] = {
      {"<geometry ", "<geometry id='g'><mesh/></geometry>"},
      {"<geometry ", "<geometry id='h'><convex_mesh convex_hull_of='#g'/></geometry>"},
      {"<triangles", "<triangels count='1'/>"},
      {"<triangles",
       "<triangles><input semantic='VERTEX' source='#v' offset='0'/><p>0 1 2</p></triangles>"},
      {in_node, "<translat>5 0 0</translat>"},
      {in_node, "<transform>5 0 0</transform>"},
      {in_node, "<instance_geometri url='#g'/>"},
      {"</visual_scene>", "<nod><instance_geometry url='#g'/></nod>"},
      {"<scene>", "<library_visual_scenez/>"}};
  for (const auto& [place, added] : others) {
    EXPECT_THAT(refusalOf(before(place, added, whole)), testing::Not("accepted")) << added;
  }
  const std::pair<std::string, std::string> harmless[] = {
      {in_node, "<translate>1 0 0</translate>"},
      {in_node, "<instance_geometry url='#g'><bind_material/></instance_geometry>"},
      {"<geometry ", "<geometry id='unused'><mesh/></geometry>"},
      {"<triangles", triangles},
      {"<scene>", "<library_lights><light id='g'/></library_lights>"},
      {"</visual_scene>", "<extra><nod/></extra>"}};
  for (const auto& [place, added] : harmless) {
    EXPECT_EQ(refusalOf(before(place, added, whole)), "accepted") << added;
  }
}

}  // namespace test_mesh_loader
}  // namespace collision_pairs
