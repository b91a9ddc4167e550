#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/aabb.h"
#include "collision_pairs/input_error.h"
#include "mesh_folder.h"
#include "random_inputs.h"

namespace collision_pairs::test_mesh_loader {

class MeshLoaderTest : public MeshFolder {};

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

TEST_F(MeshLoaderTest, ANodeOfGltfThatFlattensItsMeshIsRefused) {
  const std::array<float, 9> corners = {0, 0, 0, 1, 0, 0, 0, 2, 0};
  file("triangle.bin", {reinterpret_cast<const char*>(corners.data()), sizeof corners});
  const auto refusalOf = [&](const std::string& root, const std::string& node) {
    return refusal(file("t.gltf", gltf("[{\"children\": [1]" + root + "}, {\"mesh\": 0" + node +
                                       "}, {\"scale\": [0, 0, 0]}]")));
  };
  EXPECT_THAT(refusalOf("", R"(, "scale": [1, 0, 1])"), testing::HasSubstr("flattens"));
  EXPECT_EQ(refusalOf("", R"(, "scale": [1, 1e-3, -1])"), "accepted");
  EXPECT_EQ(refusalOf(R"(, "scale": [0, 0, 0])", ""), "accepted") << "as rviz: it is not applied";
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
  EXPECT_THAT(refusal("t.stl"), testing::HasSubstr("it has no scheme"));
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

/// assimp would take them by their content: COLLADA in metres, whatever its unit and its gaps.
TEST_F(MeshLoaderTest, AnEndingThatIsNotKnownIsRefusedWhateverTheContent) {
  const std::string text = collada("<unit meter='0.01'/>");
  const std::string known =
      "; convert it to one of .dae .glb .gltf .obj .ply .stl, for example by `assimp export`";
  for (const std::string name :
       {"a.xml", "a.zae", "a.x3d", "a.3ds", "a.off", "a.dae1", "a.DAE.txt", "a.Mesh"}) {
    const std::string uri = file(name, text);
    EXPECT_THAT(refusal(uri), testing::EndsWith("is not read" + known)) << name;
  }
  for (const std::string name : {"a", "dae", ".dae"}) {
    EXPECT_THAT(refusal(file(name, text)), testing::EndsWith("has no ending" + known)) << name;
  }
  EXPECT_EQ(refusal(file("a.Dae", text)), "accepted");
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
       "it has no scheme, and the file that it may be relative to is not known here; write "
       "package://PACKAGE/PATH or "
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

/// assimp skips the names that it does not know.
TEST_F(MeshLoaderTest, NoNameInAGltfCanBeMisspelt) {
  file("triangle.bin", std::string(36, '\0').replace(12, 4, "\0\0\x80?", 4));
  RandomInputs random;
  const std::string text = gltf(R"([{"mesh": 0, "translation": [1, 2, 3]}])");
  int number = 0;
  for (std::size_t end = text.find("\":"); end != std::string::npos;
       end = text.find("\":", end + 1)) {
    const std::size_t begin = text.rfind('"', end - 1) + 1;
    std::string changed = text;
    const int at = random.integer(static_cast<int>(begin), static_cast<int>(end) - 1);
    changed[at] = changed[at] == 'a' ? 'e' : 'a';
    EXPECT_NE(refusal(file("n" + std::to_string(number++) + ".gltf", changed)), "accepted")
        << changed;
  }
  EXPECT_GE(number, 20);
  EXPECT_THAT(
      refusal(file("one.gltf", before("2.0", "1.0", text).replace(text.find("2.0") + 3, 3, ""))),
      testing::HasSubstr("it is of glTF version '1.0', and 2.0 is read"));
  EXPECT_THAT(
      refusal(file("two.GLTF", before("mesh\"", "xyz_", text))),
      testing::HasSubstr("'xyz_mesh' in nodes[0] is not read, and may be part of a surface"));
}

/// assimp leaves out the triangles that it cannot use, and takes what is of another type for
/// absent.
TEST_F(MeshLoaderTest, EachTriangleOfAGltfIsReadOrItIsRefused) {
  std::string numbers;
  const auto append = [&](const auto& number) {
    numbers.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  for (const float coordinate : {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) append(coordinate);
  for (const std::uint16_t index : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) append(index);
  file("solid.bin", numbers);
  const std::string solid = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"children": [1], "scale": [1, 1, 1]}, {"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 1]},
                  {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48},
                    {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
    "buffers": [{"byteLength": 72, "uri": "solid.bin"}]})";
  EXPECT_EQ(load_(file("whole.gltf", solid), ONE)->triangles.size(), 4u);
  const std::vector<std::array<std::string, 3>> cases = {
      {"\"count\": 4", "\"count\": 3", "it places 4 triangles, of which assimp reads 1"},
      {"Offset\": 48", "Offset\": \"48\"", "it places 4 triangles, of which assimp reads 3"},
      {"[1], \"scale\"", "[\"1\"], \"scale\"", ""},
      {"[1], \"scale\"", "[2], \"scale\"", "there is no node '2'"},
      {"[1], \"scale\"", "[0], \"scale\"", "a node is placed twice"},
      {"[1, 1, 1]}, {\"mesh", "[1, 1]}, {\"mesh", "scale of a node is not 3 numbers"},
      {"[1, 1, 1]}, {\"mesh", "[\"1\", \"1\", \"1\"]}, {\"mesh", "is not 3 numbers"},
      {"\"mesh\": 0", "\"mesh\": 0, \"mesh\": 0", "'mesh' is in nodes[1] twice"},
      {"\"mesh\": 0", "\"mesh\": 0, \"skin\": 0", "may be part of a surface"},
      {"\"children\": [1]", "\"children\": [1.0]", "there is no node '1.0'"},
      {"12, \"type\"", "11, \"type\"", "a primitive of mode 4 has 11 corners"},
      {"VEC3", "vec3", "accessor 0 is not of the type of positions, or of indices"},
      {"5123", "5122", "accessor 1 is not of the type of positions, or of indices"}};
  int number = 0;
  for (const auto& [before, after, why] : cases) {
    std::string changed = solid;
    ASSERT_NE(changed.find(before), std::string::npos) << before;
    changed.replace(changed.find(before), before.size(), after);
    const std::string said = refusal(file("s" + std::to_string(number++) + ".gltf", changed));
    EXPECT_THAT(said, testing::EndsWith(why)) << after;
    EXPECT_NE(said, "accepted") << after;
  }
}

}  // namespace collision_pairs::test_mesh_loader
