// What a URDF or SRDF says and nobody reads is named: at every place of a file.
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include "demo_scene.h"
#include "random_inputs.h"
#include "xml_names.h"

namespace collision_pairs::test_xml_names {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using tinyxml2::XMLElement;

const std::string URDF = R"xml(<robot name="cell">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base">
    <inertial><mass value="1"/></inertial>
    <visual><geometry><box size="1 1 1"/></geometry></visual>
    <collision><origin xyz="0 0 1" rpy="0 0 0"/><geometry><box size="1 1 1"/></geometry></collision>
    <collision name="second"><geometry><sphere radius="0.5"/></geometry></collision>
  </link>
  <link name="arm">
    <collision><geometry><cylinder radius="0.1" length="0.5"/></geometry></collision>
    <collision><geometry><capsule radius="0.1" length="0.5"/></geometry></collision>
    <collision><geometry><mesh filename="package://p/m.stl" scale="1 1 1"/></geometry></collision>
  </link>
  <link name="finger"/>
  <joint name="turn" type="revolute">
    <origin xyz="0 0 1" rpy="0 0 0"/><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/><dynamics damping="1"/>
  </joint>
  <joint name="grip" type="prismatic">
    <parent link="arm"/><child link="finger"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/>
    <mimic joint="turn" multiplier="0.1" offset="0"/>
  </joint>
  <gazebo reference="arm"><colision>of another reader</colision></gazebo>
  <transmission name="t"><actuator name="$(arg motor)"/></transmission>
</robot>)xml";

const std::string SRDF = R"xml(<robot name="cell">
  <group name="all"><link name="arm"/><joint name="turn"/><chain base_link="base" tip_link="arm"/>
    <group name="hand"/></group>
  <group name="hand"><link name="finger"/></group>
  <group_state name="home" group="all"><joint name="turn" value="0"/></group_state>
  <end_effector name="e" parent_link="arm" group="hand"/>
  <virtual_joint name="v" type="fixed" parent_frame="world" child_link="base"/>
  <passive_joint name="grip"/>
  <disable_default_collisions link="finger"/>
  <enable_collisions link1="finger" link2="base"/>
  <disable_collisions link1="arm" link2="base" reason="Adjacent"/>
</robot>)xml";

/// What is said of a file: its warnings, or why it is refused.
std::string saidOf(const std::string& xml, bool is_srdf) {
  std::vector<std::string> warnings;
  try {
    if (is_srdf) {
      warnings = Srdf::fromXml(xml).warnings;
    } else {
      warnings = RobotModel::fromUrdf(xml, [](const std::string&, const Eigen::Vector3d&) {
                   auto mesh = std::make_shared<TriangleMesh>();
                   mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
                   mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
                   return mesh;
                 })->warnings();
    }
  } catch (const InputError& error) {
    return std::string("refused: ") + error.what();
  }
  std::string said;
  for (const std::string& warning : warnings) said += warning + "\n";
  return said;
}

std::string text(const tinyxml2::XMLDocument& document) {
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

/// The elements that the reader looks into, in the order of the file.
void collect(XMLElement* element, std::vector<XMLElement*>& all) {
  all.push_back(element);
  for (XMLElement* child = element->FirstChildElement(); child;
       child = child->NextSiblingElement()) {
    const std::string name = child->Name();
    const bool is_read = name != "gazebo" && name != "transmission" && name != "material" &&
                         name != "inertial" && name != "visual" && name != "group_state" &&
                         name != "end_effector" && name != "dynamics";
    if (is_read) collect(child, all);
  }
}

/// One letter more, one less, or another one.
std::string misspelt(const std::string& word, RandomInputs& random) {
  std::string wrong = word;
  const auto at = static_cast<std::size_t>(random.integer(0, static_cast<int>(word.size()) - 1));
  const char letter = static_cast<char>('a' + random.integer(0, 25));
  switch (random.integer(0, 2)) {
    case 0:
      wrong.insert(at, 1, letter);
      break;
    case 1:
      wrong[at] = letter == word[at] ? 'q' : letter;
      break;
    default:
      word.size() > 3 ? wrong.erase(at, 1) : wrong.insert(at, 1, letter);
  }
  return wrong == word ? word + "q" : wrong;
}

/// At each place in turn, some times: change(document, element) returns the name that must be said.
void atEveryPlace(const std::function<std::string(tinyxml2::XMLDocument&, XMLElement*)>& change) {
  for (const bool is_srdf : {false, true}) {
    const std::string& xml = is_srdf ? SRDF : URDF;
    for (std::size_t place = 0;; ++place) {
      tinyxml2::XMLDocument document;
      document.Parse(xml.c_str());
      std::vector<XMLElement*> all;
      collect(document.RootElement(), all);
      if (place == all.size()) break;
      const std::string name = change(document, all[place]);
      if (name.empty()) continue;
      EXPECT_THAT(saidOf(text(document), is_srdf), HasSubstr(name)) << text(document);
    }
  }
}

/// Said otherwise, a pose or a shape would be another one.
TEST(XmlNames, AnAttributeOfAPoseOrAShapeThatNobodyReadsIsRefused) {
  for (const char* element : {"origin", "box", "sphere", "cylinder", "capsule", "mesh", "mimic"}) {
    const std::string begin = std::string("<") + element + ' ';
    const std::size_t at = URDF.find(begin, URDF.find("<collision>"));
    ASSERT_NE(at, std::string::npos);
    std::string changed = URDF;
    changed.insert(at + begin.size(), "quat_xyzw='0 0 0.7 0.7' ");
    const std::string said = saidOf(changed, false);
    EXPECT_EQ(said.rfind("refused: ", 0), 0u) << element << ": " << said;
    EXPECT_NE(said.find(std::string("attribute 'quat_xyzw' of <") + element + "> is unknown"),
              std::string::npos)
        << said;
  }
}

TEST(XmlNames, WhatIsKnownIsQuiet) {
  EXPECT_THAT(saidOf(URDF, false), IsEmpty());
  EXPECT_THAT(saidOf(SRDF, true), IsEmpty());
}

TEST(XmlNames, AnUnknownElementIsNamedAtEveryPlace) {
  atEveryPlace([](tinyxml2::XMLDocument& document, XMLElement* element) {
    element->InsertEndChild(document.NewElement("frobnicate"));
    return "frobnicate";
  });
}

TEST(XmlNames, AMisspeltElementIsNamedAtEveryPlace) {
  RandomInputs random;
  for (int round = 0; round < 20; ++round) {
    atEveryPlace([&](tinyxml2::XMLDocument& document, XMLElement* element) {
      if (element == document.RootElement()) return std::string();
      const std::string wrong = misspelt(element->Name(), random);
      element->SetName(wrong.c_str());
      return wrong;
    });
  }
}

TEST(XmlNames, AMisspeltAttributeIsNamedAtEveryPlace) {
  RandomInputs random;
  for (int round = 0; round < 20; ++round) {
    atEveryPlace([&](tinyxml2::XMLDocument&, XMLElement* element) {
      std::vector<std::string> names;
      for (const auto* a = element->FirstAttribute(); a; a = a->Next()) names.push_back(a->Name());
      if (names.empty()) return std::string();
      const std::string& name =
          names[static_cast<std::size_t>(random.integer(0, static_cast<int>(names.size()) - 1))];
      const std::string wrong = misspelt(name, random), value = element->Attribute(name.c_str());
      element->DeleteAttribute(name.c_str());
      element->SetAttribute(wrong.c_str(), value.c_str());
      return wrong;
    });
  }
}

TEST(XmlNames, AnElementOfAnotherNamespaceIsQuietAtEveryPlaceUnlessItIsOfXacro) {
  for (const bool is_xacro : {false, true}) {
    atEveryPlace([&](tinyxml2::XMLDocument& document, XMLElement* element) -> std::string {
      if (is_xacro) {
        element->InsertEndChild(document.NewElement("xacro:gripper"));
        return "is not expanded: run xacro";
      }
      element->InsertEndChild(document.NewElement("drake:declare_convex"));
      const bool is_srdf = document.RootElement()->FirstChildElement("link") == nullptr;
      EXPECT_THAT(saidOf(text(document), is_srdf), IsEmpty()) << text(document);
      return "";
    });
  }
}

TEST(XmlNames, WhatXacroWasToExpandIsRefusedAtEveryPlace) {
  for (const char* value : {"${width}", "1 ${h/2} 0", "$(find arm)/mesh.stl"}) {
    atEveryPlace([&](tinyxml2::XMLDocument&, XMLElement* element) -> std::string {
      const auto* attribute = element->FirstAttribute();
      if (attribute == nullptr) return "";
      element->SetAttribute(attribute->Name(), value);
      return "is not expanded: run xacro";
    });
  }
}

TEST(XmlNames, NearANameThatIsReadAFileIsRefusedWithItsLine) {
  const std::string xml = "<robot name='r'>\n<link name='a'><colision/></link></robot>";
  EXPECT_EQ(saidOf(xml, false),
            "refused: URDF line 2: <colision> in <link> is unknown; did you mean <collision>?");
  EXPECT_EQ(saidOf("<robot name='r'>\n\n<enable_collision link1='a' link2='b'/></robot>", true),
            "refused: SRDF line 3: <enable_collision> in <robot> is unknown; did you mean "
            "<enable_collisions>?");
  EXPECT_EQ(saidOf("<robot name='r'><link name='a'>\n<sensors/></link></robot>", false),
            "URDF line 2: <sensors> in <link> is unknown and not used; the nearest known name is "
            "<sensor>\n");
}

TEST(XmlNames, GeometryInAWrongPlaceIsRefused) {
  const auto inLink = [](const std::string& inside) {
    return "<robot name='r'><link name='a'>" + inside + "</link></robot>";
  };
  const std::string box = "<geometry><box size='1 1 1'/></geometry>";
  EXPECT_THAT(saidOf(inLink("<visual><collision>" + box + "</collision></visual>"), false),
              HasSubstr("<collision> in <visual> is not read; it belongs in <link>"));
  EXPECT_THAT(saidOf(inLink(box), false), HasSubstr("belongs in <collision>"));
  EXPECT_THAT(saidOf(inLink("<collision><box size='1 1 1'/></collision>"), false),
              HasSubstr("belongs in <geometry>"));
  EXPECT_THAT(saidOf(inLink("<collision>" + box + box + "</collision>"), false),
              HasSubstr("a second <geometry>"));
}

/// In each element that is known and not read, where it may stand: what would be read elsewhere.
TEST(XmlNames, WhatStandsInAnElementThatIsNotReadIsRefused) {
  const std::vector<std::string> urdf = {
      "<link name='hidden'><collision><geometry><sphere radius='1'/></geometry></collision></link>",
      "<collision><geometry><sphere radius='1'/></geometry></collision>",
      "<geometry><sphere radius='1'/></geometry>",
      "<joint name='hidden' type='fixed'><parent link='base'/><child link='arm'/></joint>"};
  const std::vector<std::string> srdf = {"<group name='hidden'><link name='arm'/></group>",
                                         "<disable_collisions link1='arm' link2='base'/>",
                                         "<enable_collisions link1='arm' link2='base'/>",
                                         "<disable_default_collisions link='arm'/>"};
  for (const bool is_srdf : {false, true}) {
    const XmlGrammar& grammar = is_srdf ? srdfGrammar() : urdfGrammar();
    int nb_places = 0;
    for (const std::string& hidden : is_srdf ? srdf : urdf) {
      const std::string name = hidden.substr(1, hidden.find_first_of(" >") - 1);
      for (const bool is_deeper : {false, true}) {
        for (std::size_t place = 0;; ++place) {
          tinyxml2::XMLDocument document, inside;
          document.Parse((is_srdf ? SRDF : URDF).c_str());
          inside.Parse(hidden.c_str());
          std::vector<XMLElement*> all;
          collect(document.RootElement(), all);
          if (place == all.size()) break;
          const XmlNames& names = grammar.at(all[place]->Name());
          std::vector<std::string> unread = names.unread;
          unread.push_back("frobnicate");
          for (const std::string& other : unread) {
            const bool is_of_others = other == "gazebo" || other == "transmission" ||
                                      other == "self_filter" || other == "self_collision_checking";
            const bool is_drawn = other == "visual" && name == "geometry";
            if (is_of_others || (is_drawn && !is_deeper)) continue;
            XMLElement* added = document.NewElement(other.c_str());
            all[place]->InsertEndChild(added);
            XMLElement* holder = added;
            if (is_deeper) {
              holder = document.NewElement("deeper");
              added->InsertEndChild(holder);
            }
            holder->InsertEndChild(inside.RootElement()->DeepClone(&document));
            EXPECT_THAT(saidOf(text(document), is_srdf),
                        AllOf(StartsWith("refused: "), HasSubstr("<" + name + "> in <"),
                              HasSubstr("is not read; it belongs in <")))
                << text(document);
            all[place]->DeleteChild(added);
            ++nb_places;
          }
        }
      }
    }
    EXPECT_GT(nb_places, 50);
  }
}

TEST(XmlNames, WhatOthersReadAndWhatIsNamedOnlyStaysQuiet) {
  const auto inLink = [](const std::string& inside) {
    return saidOf("<robot name='r'><link name='a'>" + inside + "</link></robot>", false);
  };
  const std::string body = "<origin xyz='1 0 0'/><geometry><box size='1 1 1'/></geometry>";
  for (const char* other :
       {"gazebo", "self_filter", "self_collision_checking", "drake:proximity"}) {
    EXPECT_EQ(inLink("<" + std::string(other) + "><collision>" + body + "</collision>" + body +
                     "</" + other + ">"),
              "")
        << other;
  }
  EXPECT_EQ(inLink("<inertial><origin xyz='0 0 1'/><mass value='1'/></inertial>"), "");
  EXPECT_EQ(inLink("<sensor><parent link='a'/><origin xyz='0 0 1'/><contact><collision>a_0"
                   "</collision></contact></sensor>"),
            "");
}

TEST(XmlNames, APoseOrALimitThatWouldBeLostIsRefused) {
  const auto inCollision = [](const std::string& inside) {
    return saidOf(
        "<robot name='r'><link name='a'><collision><geometry><box size='1 1 1'/>"
        "</geometry>" +
            inside + "</collision></link></robot>",
        false);
  };
  EXPECT_THAT(inCollision("<surface><origin xyz='5 0 0'/></surface>"),
              HasSubstr("<origin> in <surface> is not read; it belongs in <collision>"));
  EXPECT_THAT(saidOf("<robot name='r'><link name='a'><origin xyz='5 0 0'/></link></robot>", false),
              HasSubstr("<origin> in <link> is not read; it belongs in <collision>"));
  EXPECT_THAT(saidOf("<robot name='r'><link name='a'/><link name='b'/><joint name='j' "
                     "type='fixed'><parent link='a'/><child link='b'/><dynamics><origin "
                     "xyz='5 0 0'/></dynamics></joint></robot>",
                     false),
              HasSubstr("<origin> in <dynamics> is not read"));
}

TEST(XmlNames, LinksThatAreDrawnButNotCheckedAreSaidInOneLine) {
  std::string links;
  for (const char* name : {"a", "b", "c"}) {
    links += "<link name='" + std::string(name) +
             "'><visual><geometry><box size='1 1 1'/></geometry></visual></link>";
  }
  links += joint("j", "fixed", "a", "b") + joint("k", "fixed", "a", "c") +
           joint("l", "fixed", "a", "frame") + emptyLink("frame");
  EXPECT_EQ(saidOf("<robot name='r'>" + links + "</robot>", false),
            "3 of 3 links with a visual have no collision geometry, so nothing checks them: a, b, "
            "c\n");
}

}  // namespace collision_pairs::test_xml_names
