// What assimp does not tell of COLLADA: its unit, and parts that it leaves out or misreads.
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <tinyxml2.h>

#include "collada_numbers.h"
#include "collision_pairs/input_error.h"
#include "mesh_files.h"
#include "user_text.h"
#include "xml_file.h"
#include "xml_names.h"

namespace collision_pairs {
namespace {

using tinyxml2::XMLElement;

/// What an element with a URL places.
const std::map<std::string, std::string> PLACED = {{"instance_visual_scene", "visual_scene"},
                                                   {"instance_node", "node"},
                                                   {"instance_geometry", "geometry"}};

/// From the schema of COLLADA 1.4 and 1.5: what places surfaces, and what they consist of. The
/// attributes that are read are required there.
const XmlGrammar& colladaGrammar() {
  static const XmlNames PRIMITIVE = {
      {}, {"input", "p", "vcount", "ph", "extra"}, {"count"}, {"name", "material"}};
  static const XmlNames INSTANCE = {
      {}, {"bind_material", "skeleton", "extra"}, {"url"}, {"sid", "name", "proxy"}};
  static const std::vector<std::string> NAMES = {"id", "sid", "name", "type", "layer"};
  static const XmlGrammar GRAMMAR = {
      {COLLADA,
       {{"library_geometries", "library_controllers", "library_nodes", "library_visual_scenes",
         "scene"},
        {"asset", "extra", "library_animations", "library_animation_clips",
         "library_articulated_systems", "library_cameras", "library_effects",
         "library_force_fields", "library_formulas", "library_images", "library_joints",
         "library_kinematics_models", "library_kinematics_scenes", "library_lights",
         "library_materials", "library_physics_materials", "library_physics_models",
         "library_physics_scenes"},
        {},
        {"version", "base"}}},
      {"library_geometries", {{"geometry"}, {"asset", "extra"}, {}, NAMES}},
      {"geometry", {{"mesh"}, {"asset", "spline", "extra"}, {}, NAMES}},
      {"mesh",
       {{"triangles", "polylist", "polygons", "tristrips", "trifans"},
        {"source", "vertices", "lines", "linestrips", "extra"},
        {},
        NAMES}},
      {"triangles", PRIMITIVE},
      {"polylist", PRIMITIVE},
      {"polygons", PRIMITIVE},
      {"tristrips", PRIMITIVE},
      {"trifans", PRIMITIVE},
      {"library_nodes", {{"node"}, {"asset", "extra"}, {}, NAMES}},
      {"library_visual_scenes", {{"visual_scene"}, {"asset", "extra"}, {}, NAMES}},
      {"visual_scene", {{"node"}, {"asset", "evaluate_scene", "extra"}, {}, NAMES}},
      {"node",
       {{"node", "matrix", "translate", "rotate", "scale", "lookat", "skew", "instance_node",
         "instance_geometry", "instance_controller"},
        {"asset", "instance_camera", "instance_light", "extra"},
        {},
        NAMES}},
      {"instance_node", INSTANCE},
      {"instance_geometry", INSTANCE},
      {"instance_controller", INSTANCE},
      {"scene",
       {{"instance_visual_scene"},
        {"instance_physics_scene", "instance_kinematics_scene", "extra"},
        {},
        NAMES}},
      {"instance_visual_scene", INSTANCE}};
  return GRAMMAR;
}

bool hasText(const XMLElement& element) { return element.GetText() != nullptr; }

/// Exporters write objects without a vertex, and edges alone. All else that assimp leaves out may
/// have been a surface.
void requireSurface(const XMLElement& geometry) {
  bool has_positions = false, has_indices = false;
  for (const XMLElement* mesh : childrenOf(geometry, "mesh")) {
    for (const XMLElement* source : childrenOf(*mesh, "source")) {
      for (const XMLElement* array : childrenOf(*source, "float_array")) {
        has_positions = has_positions || hasText(*array);
      }
    }
    for (const char* primitive :
         {"triangles", "polylist", "polygons", "tristrips", "trifans", "lines", "linestrips"}) {
      for (const XMLElement* found : childrenOf(*mesh, primitive)) {
        const XMLElement* indices = found->FirstChildElement("p");
        has_indices = has_indices || (indices && hasText(*indices));
      }
    }
  }
  if (!has_positions || has_indices) return;
  const char* id = geometry.Attribute("id");
  failAt(geometry, COLLADA,
         "<geometry id='" + std::string(id ? id : "") + "'> has positions, but no surface");
}

/// assimp skips what a URL does not find.
class Parts {
 public:
  explicit Parts(const XMLElement& root) {
    for (const auto* library = root.FirstChildElement(); library;
         library = library->NextSiblingElement()) {
      gather(*library);
    }
  }

  void require(const XMLElement& element) const {
    const std::string name = element.Name();
    for (const std::string& attribute : colladaGrammar().at(name).read_attributes) {
      requiredAttribute(element, attribute.c_str(), COLLADA);
    }
    if (const auto placed = PLACED.find(name); placed != PLACED.end()) {
      const std::string url = element.Attribute("url");
      if (url[0] != '#' || ids_.count({placed->second, url.substr(1)}) != 1) {
        failAt(element, COLLADA,
               "<" + name + " url='" + url + "'>: there is not one <" + placed->second +
                   "> of that id in the file, and that part would be missing");
      }
    }
    if (name == "geometry") requireSurface(element);
    if (name == "instance_controller") {
      failAt(element, COLLADA, "<instance_controller>: what it does to a surface is not read");
    }
    for (const auto* child = element.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      if (colladaGrammar().count(child->Name()) > 0) require(*child);
    }
  }

 private:
  void gather(const XMLElement& element) {
    if (const char* id = element.Attribute("id")) ids_.emplace(element.Name(), id);
    for (const auto* child = element.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      gather(*child);
    }
  }

  std::multiset<std::pair<std::string, std::string>> ids_;  ///< by the names of their elements
};

}  // namespace

double readColladaUnit(const std::string& text) {
  tinyxml2::XMLDocument document;
  const XMLElement& root = *parseXml(document, text, COLLADA, COLLADA);
  const std::vector<std::string> unknown = checkNames(root, colladaGrammar(), COLLADA);
  if (!unknown.empty()) throw InputError(unknown.front());
  Parts(root).require(root);
  requireColladaNumbers(root);
  const XMLElement* asset = root.FirstChildElement("asset");
  const XMLElement* unit = asset ? asset->FirstChildElement("unit") : nullptr;
  const char* meter = unit ? unit->Attribute("meter") : nullptr;
  double metres = 1.0;
  if (meter && (!parseNumber(meter, metres) || !(metres > 0.0))) {
    throw InputError("its <unit meter=\"" + std::string(meter) + "\"> is no length");
  }
  return metres;
}

}  // namespace collision_pairs
