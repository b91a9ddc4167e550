// COLLADA: its units, and that no part of it is left out or elsewhere without a word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh_folder.h"

namespace collision_pairs::test_collada {

class Collada : public MeshFolder {};

TEST_F(Collada, ColladaIsTakenAsItIsWhateverItsUpAxis) {
  for (const std::string up : {"Y_UP", "Z_UP"}) {
    const auto mesh = load_(file(up + ".dae", collada("<up_axis>" + up + "</up_axis>")), ONE);
    EXPECT_TRUE(mostOf(*mesh).isApprox(Eigen::Vector3d(1, 0, 3), 1e-6)) << up;
  }
}

TEST_F(Collada, ColladaIsInItsUnit) {
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

TEST_F(Collada, TheFirstMeshWhoseUnitIsNotTheMetreIsSaidAndNoOther) {
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

TEST_F(Collada, ColladaOfWhichAPartWouldBeMissingIsRefused) {
  const std::string whole = collada(""), in_node = "<instance_geometry";
  int number = 0;
  const auto refusalOf = [&](const std::string& text) {
    return refusal(file(std::to_string(number++) + ".dae", text));
  };
  EXPECT_THAT(refusalOf(before(in_node, "<instance_controller url='#g'/>", whole)),
              testing::HasSubstr("<instance_controller>: what it does to a surface is not read"));
  for (const std::string kind : {"geometry", "node"}) {
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

/// `text` with `to` in place of what begins and ends so.
std::string with(const std::string& begin, const std::string& end, const std::string& to,
                 std::string text) {
  const std::size_t at = text.find(begin), last = text.find(end, at);
  return text.replace(at, last + end.size() - at, to);
}

TEST_F(Collada, WithoutASurfaceIsRefused) {
  const std::string whole = collada("");
  const std::string lines =
      "<lines count='2'><input semantic='VERTEX' source='#v' offset='0'/><p>0 1 1 2</p></lines>";
  const std::string without[] = {with("<triangles", "</triangles>", "", whole),
                                 with("<triangles", "</triangles>", lines, whole),
                                 with("<mesh>", "</mesh>", "<spline/>", whole),
                                 with("<instance_geometry", "/>", "", whole),
                                 with("<node", "</node>", "", whole),
                                 with("<library_visual", "</library_visual_scenes>", "", whole),
                                 with("<scene>", "</scene>", "", whole)};
  for (const std::string& text : without) {
    EXPECT_THAT(refusal(file("without.dae", text)), testing::Not("accepted")) << text;
  }
}

/// A second geometry in another place, of which `mesh` is all.
std::string beside(const std::string& mesh) {
  const std::string node = "<node><translate>5 0 0</translate><instance_geometry url='#h'/></node>";
  return before("<geometry ", "<geometry id='h'><mesh>" + mesh + "</mesh></geometry>",
                before("<node ", node, collada("")));
}

TEST_F(Collada, APartWithoutASurfaceIsRefusedUnlessItIsEmptyOrOfLines) {
  const std::string numbers =
      "<source id='q'><float_array id='b' count='9'>0 0 0 1 0 0 0 0 3</float_array>"
      "<technique_common><accessor source='#b' count='3' stride='3'><param name='X' type='float'/>"
      "<param name='Y' type='float'/><param name='Z' type='float'/></accessor></technique_common>"
      "</source><vertices id='w'><input semantic='POSITION' source='#q'/></vertices>";
  const auto primitive = [](const std::string& name, const std::string& count,
                            const std::string& indices) {
    return '<' + name + " count='" + count +
           "'><input semantic='VERTEX' source='#w' offset='0'/><p>" + indices + "</p></" + name +
           '>';
  };
  const auto refusalOf = [&](const std::string& mesh) {
    return refusal(file("beside.dae", beside(mesh)));
  };
  for (const std::string& none : {std::string(), primitive("triangles", "0", "")}) {
    EXPECT_THAT(refusalOf(numbers + none),
                testing::HasSubstr("line 1: <geometry id='h'> has positions, but no surface"));
  }
  EXPECT_EQ(refusalOf(numbers + primitive("triangles", "1", "0 1 2")), "accepted");
  EXPECT_EQ(refusalOf(numbers + primitive("lines", "1", "0 1")), "accepted");
  EXPECT_EQ(refusalOf(with("<float_array", "</float_array>", "<float_array id='b' count='0'/>",
                           with("count='3'", "", "count='0'", numbers))),
            "accepted")
      << "Blender writes it of an object without a vertex";
}

TEST_F(Collada, ANodeThatFlattensWhatItPlacesIsRefused) {
  const auto refusalOf = [&](const std::string& transform) {
    return refusal(file("node.dae", before("<instance_geometry", transform, collada(""))));
  };
  for (const char* flat : {"<scale>0 0 0</scale>", "<scale>1 0 1</scale>",
                           "<matrix>1 0 0 0 0 1 0 0 1 1 0 0 0 0 0 1</matrix>",
                           "<translate>1 2 3</translate><scale>1 1 0</scale>"}) {
    EXPECT_THAT(refusalOf(flat), testing::HasSubstr("flattens")) << flat;
  }
  for (const char* sound : {"<scale>-1 1e-3 1000</scale>", "<rotate>1 2 3 40</rotate>",
                            "<matrix>0 0 1e-4 5 1e-4 0 0 6 0 1e-4 0 7 0 0 0 1</matrix>"}) {
    EXPECT_EQ(refusalOf(sound), "accepted") << sound;
  }
}

}  // namespace collision_pairs::test_collada
