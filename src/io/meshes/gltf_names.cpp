// What assimp does not tell of glTF: names that it does not know, and extensions that it does
// without.
#include "gltf_names.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#define BOOST_BIND_GLOBAL_PLACEHOLDERS  // json_parser.hpp would print a line about them
#include <boost/property_tree/json_parser.hpp>

namespace {

using Json = boost::property_tree::ptree;

[[noreturn]] void refuse(const std::string& why) { throw std::runtime_error(why); }

/// From the schema of glTF 2.0: what places surfaces, and what they consist of. "": the file.
const std::map<std::string, std::set<std::string>> GLTF_NAMES = {
    {"",
     {"accessors", "animations", "asset", "bufferViews", "buffers", "cameras", "extensionsRequired",
      "extensionsUsed", "images", "materials", "meshes", "nodes", "samplers", "scene", "scenes",
      "skins", "textures"}},
    {"scenes", {"nodes"}},
    {"nodes",
     {"camera", "children", "matrix", "mesh", "rotation", "scale", "skin", "translation",
      "weights"}},
    {"meshes", {"primitives", "weights"}},
    {"primitives", {"attributes", "indices", "material", "mode", "targets"}},
    {"accessors",
     {"bufferView", "byteOffset", "componentType", "count", "max", "min", "normalized", "sparse",
      "type"}},
    {"bufferViews", {"buffer", "byteLength", "byteOffset", "byteStride", "target"}},
    {"buffers", {"byteLength", "uri"}}};
const Json NONE;

void requireNames(const Json& object, const std::string& kind, const std::string& place) {
  for (const auto& [name, value] : object) {
    if (name == "name" || name == "extensions" || name == "extras") continue;
    if (GLTF_NAMES.at(kind).count(name) > 0) continue;
    refuse("'" + name + "' in " + place + " is not known, and may be part of a surface");
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

/// Extensions of glTF that change looks only.
bool isOfLooks(const std::string& extension) {
  for (const char* kind : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"}) {
    if (extension.rfind(kind, 0) == 0) return true;
  }
  return false;
}

}  // namespace

void requireKnownGltf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  Json root;
  try {
    std::istringstream text(gltfText(bytes));
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
  for (const auto& [none, mesh] : root.get_child("meshes", NONE)) {
    requireNamesOf(mesh, "primitives");
    for (const auto& [unnamed, primitive] : mesh.get_child("primitives", NONE)) {
      if (!primitive.get_child_optional("attributes.POSITION")) {
        refuse("a primitive of its meshes has no POSITION");
      }
    }
  }
  for (const auto& [none, extension] : root.get_child("extensionsRequired", NONE)) {
    if (isOfLooks(extension.data())) continue;
    refuse("it needs the glTF extension " + extension.data() +
           ", which is not read: export it without compression and quantization");
  }
}
