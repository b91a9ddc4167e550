// COLLADA, changed at each place in turn: it is refused, or the surface is the same.
#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include "collision_pairs/input_error.h"
#include "mesh_folder.h"

namespace collision_pairs::test_collada_numbers {

using testing::HasSubstr;
using tinyxml2::XMLElement;

/// A tetrahedron whose parts are written in several ways.
const std::string TETRAHEDRON = R"xml(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 0 2 0 0 0 3</float_array>
<technique_common><accessor source="#a" count="4" stride="3" offset="0"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="n"><float_array id="b" count="3">0 0 1</float_array>
<technique_common><accessor source="#b" count="1" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1</p></triangles>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="1"/>
<input semantic="NORMAL" source="#n" offset="0"/><vcount>3 3</vcount><p>0 0 0 1 0 3 0 0 0 3 0 2</p></polylist>
<polygons count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>1 2 3</p></polygons>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n0"><translate>1 2 3</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)xml";

using Corner = std::array<double, 3>;
using Surface = std::set<std::array<Corner, 3>>;

class ColladaNumbers : public MeshFolder {
 protected:
  void SetUp() override {
    MeshFolder::SetUp();
    whole_ = read(TETRAHEDRON).first;
  }

  /// Its triangles, in any order and however often; or, why it is refused.
  std::pair<Surface, std::string> read(const std::string& text) {
    Surface surface;
    try {
      const auto mesh = load_(file(std::to_string(nb_files_++) + ".dae", text), ONE);
      for (const auto& triangle : mesh->triangles) {
        std::array<Corner, 3> corners;
        for (int i = 0; i < 3; ++i) {
          const Eigen::Vector3d& vertex = mesh->vertices.at(triangle[i]);
          corners[i] = {vertex.x(), vertex.y(), vertex.z()};
        }
        std::sort(corners.begin(), corners.end());
        surface.insert(corners);
      }
    } catch (const InputError& error) {
      return {surface, error.what()};
    }
    return {surface, ""};
  }

  void expectRefusedOrTheSame(const std::string& text, const std::string& change) {
    const auto [surface, why] = read(text);
    EXPECT_TRUE(!why.empty() || surface == whole_) << change << '\n' << text;
    nb_refused_ += why.empty() ? 0 : 1;
  }

  int nb_files_ = 0, nb_refused_ = 0;
  Surface whole_;
};

std::string textOf(const tinyxml2::XMLDocument& document) {
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  return printer.CStr();
}

void collect(XMLElement* element, std::vector<XMLElement*>& all) {
  all.push_back(element);
  for (XMLElement* child = element->FirstChildElement(); child;
       child = child->NextSiblingElement()) {
    collect(child, all);
  }
}

/// change(document, element) at each element in turn.
std::vector<std::string> changed(
    const std::function<bool(tinyxml2::XMLDocument&, XMLElement*)>& change) {
  std::vector<std::string> texts;
  for (std::size_t place = 1;; ++place) {
    tinyxml2::XMLDocument document;
    document.Parse(TETRAHEDRON.c_str());
    std::vector<XMLElement*> all;
    collect(document.RootElement(), all);
    if (place >= all.size()) return texts;
    if (change(document, all[place])) texts.push_back(textOf(document));
  }
}

TEST_F(ColladaNumbers, AnElementThatIsMissingMisspeltOrThereTwiceLeavesNoOtherSurface) {
  ASSERT_EQ(whole_.size(), 4u);
  for (const std::string& text : changed([](auto&, XMLElement* element) {
         const std::string name = element->Name();
         // What places and lists whole surfaces may be meant so.
         if (name == "triangles" || name == "polylist" || name == "polygons" ||
             name == "translate") {
           return false;
         }
         element->Parent()->DeleteChild(element);
         return true;
       })) {
    expectRefusedOrTheSame(text, "missing");
  }
  for (const std::string& text : changed([](auto&, XMLElement* element) {
         element->SetName((std::string(element->Name()) + "q").c_str());
         return true;
       })) {
    EXPECT_NE(read(text).second, "") << text;
  }
  for (const std::string& text : changed([](auto&document, XMLElement*element) {
         if (element->Name() == std::string("translate")) return false;
         element->Parent()->InsertAfterChild(element, element->DeepClone(&document));
         return true;
       })) {
    expectRefusedOrTheSame(text, "twice");
  }
}

TEST_F(ColladaNumbers, AnAttributeThatIsMissingMisspeltOrOfAnotherValueLeavesNoOtherSurface) {
  for (const char* value : {"missing", "misspelt", "1", "99", "0x1", "", "#n", "v"}) {
    for (int which = 0; which < 4; ++which) {
      for (const std::string& text : changed([&](auto&, XMLElement* element) {
             const tinyxml2::XMLAttribute* attribute = element->FirstAttribute();
             for (int i = 0; attribute && i < which; ++i) attribute = attribute->Next();
             if (!attribute) return false;
             const std::string name = attribute->Name(), before = attribute->Value();
             const std::string change = value;
             if (change == "missing" || change == "misspelt") {
               element->DeleteAttribute(name.c_str());
               if (change == "misspelt")
                 element->SetAttribute((name + "q").c_str(), before.c_str());
             } else {
               element->SetAttribute(name.c_str(), value);
             }
             return true;
           })) {
        expectRefusedOrTheSame(text, value);
      }
    }
  }
  EXPECT_GT(nb_refused_, 200);
}

TEST_F(ColladaNumbers, AWordThatIsNotWhatItsElementNeedsIsRefused) {
  const auto isOf = [](XMLElement* element, const std::vector<std::string>& names) {
    return std::count(names.begin(), names.end(), element->Name()) > 0;
  };
  for (const std::string word : {"0x1", "1,0", "1.5.2", "abc", "1e", "--1", "nan", "", "."}) {
    for (const std::string& text : changed([&](auto&, XMLElement* element) {
           if (!isOf(element, {"float_array", "p", "vcount", "translate"})) return false;
           const std::string before = element->GetText();
           if (before == "0 0 1") return false;  // normals are not read
           element->SetText((word + before.substr(1)).c_str());
           return true;
         })) {
      EXPECT_NE(read(text).second, "") << text;
    }
  }
  for (const std::string word : {"-1", "99", "4", "1.5", "+1"}) {
    for (const std::string& text : changed([&](auto&, XMLElement* element) {
           if (!isOf(element, {"p", "vcount"})) return false;
           const std::string before = element->GetText();
           element->SetText((before.substr(0, before.size() - 1) + word).c_str());
           return true;
         })) {
      EXPECT_NE(read(text).second, "") << text;
    }
  }
  for (const std::string& text : changed([&](auto&document, XMLElement*element) {
         if (!isOf(element, {"float_array", "p", "vcount", "translate"})) return false;
         if (element->GetText() == std::string("0 0 1")) return false;
         element->InsertEndChild(document.NewComment("a comment"));
         element->InsertEndChild(document.NewText("1 1"));
         return true;
       })) {
    EXPECT_NE(read(text).second, "") << text;
  }
}

TEST_F(ColladaNumbers, WhatIsWrongIsSaidWithItsLine) {
  const auto why = [&](const std::string& from, const std::string& to) {
    std::string text = TETRAHEDRON;
    return read(text.replace(text.find(from), from.size(), to)).second;
  };
  EXPECT_THAT(why("0 0 0 1", "0 0 0x0 1"),
              HasSubstr("COLLADA line 4: <float_array>: '0x0' is no decimal"));
  EXPECT_THAT(why("count=\"12\"", "count=\"9\""), HasSubstr("has 12 numbers, and not its count"));
  EXPECT_THAT(why("name=\"Y\"", "name=\"y\""), HasSubstr("has not one <param> with the name Y"));
  EXPECT_THAT(why("stride=\"3\"", "stride=\"2\""), HasSubstr("stride is less than its <param>s"));
  EXPECT_THAT(why("offset=\"0\"", "offset=\"3\""), HasSubstr("reads beyond its array"));
  EXPECT_THAT(why("0 2 1", "0 2 -1"), HasSubstr("<p>: '-1' is not one of 4 positions"));
  EXPECT_THAT(why("<translate>1 2 3", "<translate>1 2"),
              HasSubstr("<translate> has 2 numbers, and needs 3"));
  EXPECT_THAT(why("<translate>1 2 3</translate>", "<skew>45 1 0 0 0 1 0</skew>"),
              HasSubstr("<skew> is not read here"));
}

TEST_F(ColladaNumbers, TheSameIdsInAnotherMeshAreTheirOwn) {
  const std::size_t begin = TETRAHEDRON.find("<geometry "), end = TETRAHEDRON.find("</library_geo");
  std::string other = TETRAHEDRON.substr(begin, end - begin), text = TETRAHEDRON;
  other.replace(other.find("id=\"g\""), 6, "id=\"h\"");
  other.replace(other.find("0 3<"), 4, "0 9<");
  EXPECT_EQ(read(text.insert(end, other)).first, whole_);
  EXPECT_EQ(read(before("<geometry ", other, TETRAHEDRON)).first, whole_);
}

TEST_F(ColladaNumbers, DecimalsAreReadHoweverTheyAreWritten) {
  std::string text = TETRAHEDRON;
  const std::string numbers = "0 0 0 1 0 0 0 2 0 0 0 3";
  text.replace(text.find(numbers), numbers.size(), "-0 +0 0. 1.0e0 0 .0\n0 20E-1\t0 0 0.0 .3e+1");
  EXPECT_EQ(read(text).second, "");
  EXPECT_EQ(read(text).first, whole_);
}

}  // namespace collision_pairs::test_collada_numbers
