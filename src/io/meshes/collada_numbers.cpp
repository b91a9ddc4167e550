#include "collada_numbers.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "collision_pairs/input_error.h"
#include "user_text.h"
#include "xml_file.h"
#include "xml_names.h"

namespace collision_pairs {
namespace {

using tinyxml2::XMLElement;
using Number = std::uint64_t;

const std::vector<std::string> SURFACES = {"triangles", "polylist", "polygons", "tristrips",
                                           "trifans"};
/// Those that assimp knows: of others it does not count the offset.
const std::vector<std::string> SEMANTICS = {"VERTEX",  "NORMAL",   "TEXCOORD",   "COLOR",
                                            "TANGENT", "BINORMAL", "TEXTANGENT", "TEXBINORMAL"};
constexpr Number CORNERS = 3;  // at least, of a surface

/// How many numbers a transform of a node has.
const std::map<std::string, std::size_t> TRANSFORMS = {
    {"translate", 3}, {"rotate", 4}, {"scale", 3}, {"matrix", 16}, {"lookat", 9}};

/// From the schema of COLLADA 1.4 and 1.5.
const XmlGrammar& meshGrammar() {
  static const std::vector<std::string> ARRAYS = {"asset",       "IDREF_array", "Name_array",
                                                  "bool_array",  "int_array",   "SIDREF_array",
                                                  "token_array", "technique"};
  static const XmlNames PRIMITIVE = {
      {"input", "p", "vcount", "ph"}, {"extra"}, {"count"}, {"name", "material"}};
  static const XmlGrammar GRAMMAR = {
      {"mesh",
       {{"source", "vertices", "triangles", "polylist", "polygons", "tristrips", "trifans"},
        {"lines", "linestrips", "extra"},
        {},
        {}}},
      {"source", {{"float_array", "technique_common"}, ARRAYS, {"id"}, {"name"}}},
      {"float_array", {{}, {}, {"id", "count"}, {"name", "digits", "magnitude"}}},
      {"technique_common", {{"accessor"}, {}, {}, {}}},
      {"accessor", {{"param"}, {}, {"source", "count", "stride", "offset"}, {}}},
      {"param", {{}, {}, {"name"}, {"type", "sid", "semantic"}}},
      {"vertices", {{"input"}, {"extra"}, {"id"}, {"name"}}},
      {"input", {{}, {}, {"semantic", "source", "offset"}, {"set"}}},
      {"triangles", PRIMITIVE},
      {"polylist", PRIMITIVE},
      {"polygons", PRIMITIVE},
      {"tristrips", PRIMITIVE},
      {"trifans", PRIMITIVE}};
  return GRAMMAR;
}

[[noreturn]] void fail(const XMLElement& element, const std::string& why) {
  failAt(element, COLLADA, "<" + std::string(element.Name()) + ">" + why);
}

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// assimp takes the first piece of a text that comments divide.
std::string_view textOf(const XMLElement& element) {
  const tinyxml2::XMLNode* text = element.FirstChild();
  if (!text) return {};
  if (!text->ToText() || text->NextSibling()) fail(element, " holds more than numbers");
  return text->Value();
}

/// The number of words; use(word) is called with each.
template <class Use>
std::size_t forEachWord(std::string_view text, const Use& use) {
  std::size_t count = 0;
  for (auto at = text.begin(); at != text.end();) {
    const auto begin = std::find_if_not(at, text.end(), isBlank);
    at = std::find_if(begin, text.end(), isBlank);
    if (begin == at) break;
    use(text.substr(static_cast<std::size_t>(begin - text.begin()),
                    static_cast<std::size_t>(at - begin)));
    ++count;
  }
  return count;
}

/// "-1", ".5", "2.", "1.5e-3"; assimp would take a comma for a point, and the 0 of "0x1".
bool isDecimal(std::string_view word) {
  const auto digits = [&word] {
    const std::size_t count = std::min(
        word.size(), static_cast<std::size_t>(std::find_if_not(word.begin(), word.end(), isDigit) -
                                              word.begin()));
    word.remove_prefix(count);
    return count;
  };
  const auto skip = [&word](const char* any) {
    const bool is_there = !word.empty() && std::strchr(any, word.front());
    if (is_there) word.remove_prefix(1);
    return is_there;
  };
  skip("+-");
  std::size_t nb_digits = digits();
  if (skip(".")) nb_digits += digits();
  if (nb_digits == 0) return false;
  if (!skip("eE")) return word.empty();
  skip("+-");
  return digits() > 0 && word.empty();
}

std::optional<Number> toCount(std::string_view word) {
  constexpr std::size_t MOST_DIGITS = 9;  // products of two are far from overflow
  if (word.empty() || word.size() > MOST_DIGITS) return std::nullopt;
  Number number = 0;
  for (const char c : word) {
    if (!isDigit(c)) return std::nullopt;
    number = 10 * number + static_cast<Number>(c - '0');
  }
  return number;
}

Number countOf(const XMLElement& element, const char* attribute, std::optional<Number> none = {}) {
  if (none && !element.Attribute(attribute)) return *none;
  const std::string text = requiredAttribute(element, attribute, COLLADA);
  const auto number = toCount(text);
  if (!number) fail(element, std::string(": ") + attribute + " '" + text + "' is no count");
  return *number;
}

std::size_t nbDecimals(const XMLElement& element) {
  return forEachWord(textOf(element), [&](std::string_view word) {
    if (!isDecimal(word))
      fail(element, ": '" + std::string(word.substr(0, 20)) + "' is no decimal");
  });
}

const XMLElement& onlyChild(const XMLElement& parent, const char* name) {
  const auto children = childrenOf(parent, name);
  if (children.size() != 1) {
    fail(parent, " has " + std::to_string(children.size()) + " <" + name + ">, and needs one");
  }
  return *children.front();
}

/// assimp knows sources and arrays by their ids alone, and takes the last of several. Exporters
/// give the same ids in each mesh.
class MeshNumbers {
 public:
  explicit MeshNumbers(const XMLElement& mesh) : mesh_(mesh) {
    for (const XMLElement* source : childrenOf(mesh, "source")) {
      sources_.emplace('#' + requiredAttribute(*source, "id", COLLADA), source);
      for (const auto* array = source->FirstChildElement(); array;
           array = array->NextSiblingElement()) {
        if (const char* id = array->Attribute("id")) ++nb_arrays_[std::string("#") + id];
      }
    }
  }

  void require() const {
    const std::vector<std::string> unknown = checkNames(mesh_, meshGrammar(), COLLADA);
    if (!unknown.empty()) throw InputError(unknown.front());
    std::optional<Number> nb_positions;
    std::string vertices_url;
    for (const std::string& kind : SURFACES) {
      if (mesh_.FirstChildElement(kind.c_str())) requireOrder(mesh_, {"source", "vertices", kind});
      for (const XMLElement* surface : childrenOf(mesh_, kind.c_str())) {
        if (!nb_positions) {
          const XMLElement& vertices = onlyChild(mesh_, "vertices");
          nb_positions = nbPositions(vertices);
          vertices_url = '#' + requiredAttribute(vertices, "id", COLLADA);
        }
        requireIndices(*surface, vertices_url, *nb_positions);
      }
    }
  }

 private:
  Number nbPositions(const XMLElement& vertices) const {
    const XMLElement* position = nullptr;
    for (const XMLElement* input : childrenOf(vertices, "input")) {
      if (requiredAttribute(*input, "semantic", COLLADA) != "POSITION") continue;
      if (position) fail(*input, ": a second POSITION");
      position = input;
    }
    if (!position) fail(vertices, " has no <input> with the semantic POSITION");
    const std::string url = requiredAttribute(*position, "source", COLLADA);
    if (sources_.count(url) != 1) {
      fail(*position, " source='" + url + "': there is not one <source> of that id in its <mesh>");
    }
    return nbPositionsOf(*sources_.find(url)->second);
  }

  Number nbPositionsOf(const XMLElement& source) const {
    const XMLElement& array = onlyChild(source, "float_array");
    const XMLElement& accessor = onlyChild(onlyChild(source, "technique_common"), "accessor");
    const std::string url = requiredAttribute(accessor, "source", COLLADA);
    const auto known = nb_arrays_.find(url);
    if (url != '#' + requiredAttribute(array, "id", COLLADA) || known == nb_arrays_.end() ||
        known->second != 1) {
      fail(accessor, " source='" + url + "' is not the id of the array beside it, and of no other");
    }
    const Number size = nbDecimals(array);
    if (countOf(array, "count") != size) {
      fail(array, " has " + std::to_string(size) + " numbers, and not its count");
    }
    const Number stride = countOf(accessor, "stride", 1);
    requireCoordinates(accessor, stride);
    const Number count = countOf(accessor, "count");
    if (countOf(accessor, "offset", 0) + count * stride > size)
      fail(accessor, " reads beyond its array");
    return count;
  }

  /// assimp takes the first number for a coordinate that is not named.
  static void requireCoordinates(const XMLElement& accessor, Number stride) {
    std::vector<std::string> names;
    for (const XMLElement* param : childrenOf(accessor, "param")) {
      const char* name = param->Attribute("name");
      names.emplace_back(name ? name : "");
    }
    for (const char* coordinate : {"X", "Y", "Z"}) {
      if (std::count(names.begin(), names.end(), coordinate) == 1) continue;
      fail(accessor, std::string(" has not one <param> with the name ") + coordinate);
    }
    if (names.size() > stride) fail(accessor, ": its stride is less than its <param>s");
  }

  static void requireIndices(const XMLElement& surface, const std::string& vertices,
                             Number nb_positions) {
    Number per_corner = 0, place = 0;
    std::size_t nb_vertex = 0;
    for (const XMLElement* input : childrenOf(surface, "input")) {
      const std::string semantic = requiredAttribute(*input, "semantic", COLLADA);
      if (!contains(SEMANTICS, semantic))
        fail(*input, ": the semantic '" + semantic + "' is not read here");
      const Number offset = countOf(*input, "offset");
      per_corner = std::max(per_corner, offset + 1);
      if (semantic != "VERTEX") continue;
      ++nb_vertex;
      place = offset;
      const std::string url = requiredAttribute(*input, "source", COLLADA);
      if (url != vertices)
        fail(*input, " source='" + url + "' are not the <vertices> of its <mesh>");
    }
    if (nb_vertex != 1) fail(surface, " has not one <input> with the semantic VERTEX");
    requireOrder(surface, {"input", "vcount", "p"});

    std::size_t nb_corners = 0, nb_pieces = childrenOf(surface, "ph").size();
    for (const XMLElement* indices : childrenOf(surface, "p")) {
      Number at = 0;
      const std::size_t count = forEachWord(textOf(*indices), [&](std::string_view word) {
        const auto index = toCount(word);
        const bool is_of_position = at++ % per_corner == place;
        if (!index || (is_of_position && *index >= nb_positions)) {
          fail(*indices, ": '" + std::string(word.substr(0, 20)) + "' is not one of " +
                             std::to_string(nb_positions) + " positions, or no index");
        }
      });
      if (count % per_corner != 0) fail(*indices, " ends within a corner");
      const bool is_part = count > 0 && count < CORNERS * per_corner;
      if (is_part) fail(*indices, " has fewer than three corners");
      nb_corners += count / per_corner;
      ++nb_pieces;
    }
    requireCount(surface, nb_corners, nb_pieces);
  }

  /// assimp reads in the order of the file.
  static void requireOrder(const XMLElement& parent, const std::vector<std::string>& order) {
    std::size_t last = 0;
    for (const auto* child = parent.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const auto found = std::find(order.begin(), order.end(), child->Name());
      if (found == order.end()) continue;
      const auto place = static_cast<std::size_t>(found - order.begin());
      if (place < last) fail(*child, " must come before <" + order[last] + ">");
      last = place;
    }
  }

  static void requireCount(const XMLElement& surface, std::size_t nb_corners,
                           std::size_t nb_pieces) {
    const std::string name = surface.Name();
    const Number count = countOf(surface, "count");
    bool is_whole = count == nb_pieces;  // one <p> for each polygon, strip or fan
    if (name == "triangles") is_whole = nb_pieces <= 1 && 3 * count == nb_corners;
    if (name == "polylist") {
      Number sum = 0;
      std::size_t nb_polygons = 0;
      for (const XMLElement* sizes : childrenOf(surface, "vcount")) {
        nb_polygons += forEachWord(textOf(*sizes), [&](std::string_view word) {
          const auto size = toCount(word);
          if (!size || *size < CORNERS)
            fail(*sizes, ": '" + std::string(word.substr(0, 20)) + "' corners make no surface");
          sum += *size;
        });
      }
      is_whole = nb_pieces <= 1 && count == nb_polygons && sum == nb_corners;
    }
    if (!is_whole) fail(surface, ": its count is not that of its indices");
  }

  const XMLElement& mesh_;
  std::multimap<std::string, const XMLElement*> sources_;  ///< by URL
  std::map<std::string, int> nb_arrays_;                   ///< by URL
};

void requireTransforms(const XMLElement& node) {
  // assimp would place the parts without it.
  if (const XMLElement* skew = node.FirstChildElement("skew")) fail(*skew, " is not read here");
  for (const auto& [name, wanted] : TRANSFORMS) {
    for (const XMLElement* transform : childrenOf(node, name.c_str())) {
      const std::size_t count = nbDecimals(*transform);
      if (count == wanted) continue;
      fail(*transform,
           " has " + std::to_string(count) + " numbers, and needs " + std::to_string(wanted));
    }
  }
}

/// Where surfaces are described, and where they are placed.
void require(const XMLElement& element) {
  const std::string name = element.Name();
  if (name == "geometry" && childrenOf(element, "mesh").size() > 1) {
    fail(element, " holds one <mesh>, and not several");
  }
  if (name == "mesh") MeshNumbers(element).require();
  if (name == "node") requireTransforms(element);
  for (const auto* child = element.FirstChildElement(); child;
       child = child->NextSiblingElement()) {
    const std::string in = child->Name();
    const bool leads_there = in == "library_geometries" || in == "geometry" || in == "mesh" ||
                             in == "library_nodes" || in == "library_visual_scenes" ||
                             in == "visual_scene" || in == "node";
    if (leads_there) require(*child);
  }
}

}  // namespace

void requireColladaNumbers(const XMLElement& root) { require(root); }

}  // namespace collision_pairs
