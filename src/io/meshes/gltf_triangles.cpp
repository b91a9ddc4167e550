// What assimp does not tell of glTF: names that it does not know, extensions that it does without,
// and triangles that it leaves out.
#include "gltf_triangles.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#define BOOST_BIND_GLOBAL_PLACEHOLDERS  // json_parser.hpp would print a line about them
#include <boost/property_tree/json_parser.hpp>

namespace {

using Json = boost::property_tree::ptree;

[[noreturn]] void refuse(const std::string& why) { throw std::runtime_error(why); }

/// From the schema of glTF 2.0: what places surfaces, and what they consist of. "": the file.
/// Skins, weights and sparse accessors, which move a surface and which not every assimp applies,
/// are not among them.
const std::map<std::string, std::set<std::string>> GLTF_NAMES = {
    {"",
     {"accessors", "animations", "asset", "bufferViews", "buffers", "cameras", "extensionsRequired",
      "extensionsUsed", "images", "materials", "meshes", "nodes", "samplers", "scene", "scenes",
      "skins", "textures"}},
    {"scenes", {"nodes"}},
    {"nodes", {"camera", "children", "matrix", "mesh", "rotation", "scale", "translation"}},
    {"meshes", {"primitives"}},
    {"primitives", {"attributes", "indices", "material", "mode"}},
    {"accessors",
     {"bufferView", "byteOffset", "componentType", "count", "max", "min", "normalized", "type"}},
    {"bufferViews", {"buffer", "byteLength", "byteOffset", "byteStride", "target"}},
    {"buffers", {"byteLength", "uri"}}};
const Json NONE;

/// How many numbers a transform of a node has.
const std::map<const char*, std::size_t> TRANSFORMS = {
    {"matrix", 16}, {"rotation", 4}, {"scale", 3}, {"translation", 3}};

void requireNames(const Json& object, const std::string& kind, const std::string& place) {
  for (const auto& [name, value] : object) {
    if (name == "name" || name == "extensions" || name == "extras") continue;
    if (GLTF_NAMES.at(kind).count(name) == 0) {
      refuse("'" + name + "' in " + place + " is not read, and may be part of a surface");
    }
    if (object.count(name) > 1) refuse("'" + name + "' is in " + place + " twice");
  }
}

void requireNamesOf(const Json& parent, const std::string& kind) {
  std::size_t number = 0;
  for (const auto& [none, object] : parent.get_child(kind, NONE)) {
    requireNames(object, kind, kind + "[" + std::to_string(number++) + "]");
  }
}

/// The text of a .gltf, or the first chunk of a .glb (glTF 2.0, 4.4).
std::string gltfText(const std::string& bytes) {
  constexpr std::size_t HEADER = 12, CHUNK = 8;  // bytes
  if (bytes.compare(0, 4, "glTF") != 0 || bytes.size() < HEADER + CHUNK) return bytes;
  std::uint32_t length;
  std::memcpy(&length, bytes.data() + HEADER, sizeof length);
  return bytes.substr(HEADER + CHUNK, length);
}

/// The parser takes "1" for 1, and assimp for nothing: in lists, such a text is made another.
std::string withoutQuotedNumbers(std::string text) {
  for (std::size_t at = text.find('"'); at != std::string::npos;) {
    const std::size_t end = text.find('"', at + 1);
    const std::size_t before = at == 0 ? at : text.find_last_not_of(" \t\r\n", at - 1);
    const bool is_number = text.find_first_not_of("+-.0123456789eE", at + 1) == end;
    if (is_number && before < at && (text[before] == '[' || text[before] == ','))
      text[at + 1] = '?';
    at = end == std::string::npos ? end : text.find('"', end + 1);
  }
  return text;
}

/// Extensions of glTF that change looks only.
bool isOfLooks(const std::string& extension) {
  for (const char* kind : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"}) {
    if (extension.rfind(kind, 0) == 0) return true;
  }
  return false;
}

std::vector<const Json*> itemsOf(const Json& object, const char* list) {
  std::vector<const Json*> items;
  for (const auto& [none, item] : object.get_child(list, NONE)) items.push_back(&item);
  return items;
}

/// Counts the triangles that the nodes of the scene place.
class GltfTriangles {
 public:
  explicit GltfTriangles(const Json& root)
      : root_(root),
        nodes_(itemsOf(root, "nodes")),
        meshes_(itemsOf(root, "meshes")),
        accessors_(itemsOf(root, "accessors")) {}

  std::size_t count() {
    const std::vector<const Json*> scenes = itemsOf(root_, "scenes");
    return countIn(*at(scenes, root_.get_child("scene", Json("0")), "scene"), "nodes");
  }

 private:
  static const Json* at(const std::vector<const Json*>& list, const Json& index,
                        const std::string& what) {
    const auto number = index.get_value_optional<std::size_t>();
    if (number && *number < list.size()) return list[*number];
    refuse("there is no " + what + " '" + index.data() + "'");
  }

  std::size_t countIn(const Json& parent, const char* nodes) {
    std::size_t count = 0;
    for (const Json* index : itemsOf(parent, nodes)) {
      const Json& node = *at(nodes_, *index, "node");
      if (++nb_placed_ > nodes_.size()) refuse("a node is placed twice");
      for (const auto& [name, size] : TRANSFORMS) requireNumbers(node, name, size);
      count += countIn(node, "children");
      const auto mesh = node.get_child_optional("mesh");
      if (!mesh) continue;
      for (const Json* primitive : itemsOf(*at(meshes_, *mesh, "mesh"), "primitives")) {
        count += countOf(*primitive);
      }
    }
    return count;
  }

  static void requireNumbers(const Json& node, const char* name, std::size_t size) {
    const std::vector<const Json*> numbers = itemsOf(node, name);
    bool are_numbers = numbers.empty() || numbers.size() == size;
    for (const Json* number : numbers) {
      are_numbers = are_numbers && number->get_value_optional<double>();
    }
    if (!are_numbers)
      refuse(std::string(name) + " of a node is not " + std::to_string(size) + " numbers");
  }

  std::size_t countOf(const Json& primitive) const {
    const auto positions = primitive.get_child_optional("attributes.POSITION");
    if (!positions) refuse("a primitive of its meshes has no POSITION");
    std::size_t count = countOf(*positions, "VEC3", {"5126"});
    if (const auto indices = primitive.get_child_optional("indices")) {
      count = countOf(*indices, "SCALAR", {"5121", "5123", "5125"});
    }
    const std::string mode = primitive.get("mode", "4");
    if (mode == "4" && count % 3 == 0) return count / 3;
    if ((mode == "5" || mode == "6") && count >= 3) return count - 2;  // strips, fans
    if (mode < "4" && mode.size() == 1) return 0;                      // points, lines
    refuse("a primitive of mode " + mode + " has " + std::to_string(count) + " corners");
  }

  std::size_t countOf(const Json& index, const std::string& type,
                      const std::set<std::string>& components) const {
    const Json& accessor = *at(accessors_, index, "accessor");
    if (accessor.get("type", "") != type ||
        components.count(accessor.get("componentType", "")) == 0) {
      refuse("accessor " + index.data() + " is not of the type of positions, or of indices");
    }
    return accessor.get("count", std::size_t{0});
  }

  const Json& root_;
  const std::vector<const Json*> nodes_, meshes_, accessors_;
  std::size_t nb_placed_ = 0;
};

}  // namespace

std::size_t nbTrianglesOfGltf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  Json root;
  try {
    std::istringstream text(withoutQuotedNumbers(gltfText(bytes)));
    read_json(text, root);
  } catch (const boost::property_tree::json_parser_error& error) {
    refuse("line " + std::to_string(error.line()) + ": " + error.message());
  }
  const std::string version = root.get("asset.version", "");
  if (version.rfind("2.", 0) != 0) {
    refuse("it is of glTF version '" + version + "', and 2.0 is read");
  }
  requireNames(root, "", "the file");
  for (const char* list : {"scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers"}) {
    requireNamesOf(root, list);
  }
  for (const Json* mesh : itemsOf(root, "meshes")) requireNamesOf(*mesh, "primitives");
  for (const auto& [none, extension] : root.get_child("extensionsRequired", NONE)) {
    if (isOfLooks(extension.data())) continue;
    refuse("it needs the glTF extension " + extension.data() +
           ", which is not read: export it without compression and quantization");
  }
  return GltfTriangles(root).count();
}
