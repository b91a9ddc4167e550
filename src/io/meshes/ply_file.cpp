// PLY (Turk, "The PLY Polygon File Format", 1994): a header that names elements and their
// properties, then their values, as text or binary.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "collision_pairs/input_error.h"
#include "mesh_builder.h"
#include "mesh_files.h"
#include "mesh_text.h"

namespace collision_pairs {
namespace {

struct PlyType {
  std::size_t size;  ///< bytes, at most 8
  double (*value)(const char* bytes);
};

template <class Number>
PlyType plyTypeOf() {
  return {sizeof(Number), [](const char* bytes) {
            Number number;
            std::memcpy(&number, bytes, sizeof number);
            return static_cast<double>(number);
          }};
}

struct PlyProperty {
  std::string name;
  std::optional<PlyType> count;  ///< of a list
  PlyType type;
};

struct PlyElement {
  std::string name;
  std::size_t count;
  std::vector<PlyProperty> properties;
};

class PlyReader {
 public:
  explicit PlyReader(const std::string& bytes) : bytes_(bytes), words_(bytes) {}

  TriangleMesh read() {
    readHeader();
    for (const PlyElement& element : elements_) {
      for (std::size_t i = 0; i < element.count; ++i) {
        place_ = {&element, i};
        readEntry(element);
        if (is_text_ && words_.nextInLine()) fail("has more numbers than properties");
      }
    }
    requireEnd();
    return builder_.finish();
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    std::string place;
    if (is_text_) place = "line " + std::to_string(words_.line()) + ": ";
    if (place_.first) place += place_.first->name + " " + std::to_string(place_.second) + " ";
    throw InputError(place + why);
  }

  void readHeader() {
    if (!words_.next() || !words_.is("ply")) fail("'ply' was expected, not " + words_.quoted());
    words_.skipLine();
    while (words_.next() && !words_.is("end_header")) readLine();
    if (!words_.is("end_header")) fail("its header has no end");
    words_.skipLine();
    at_ = std::min(words_.position() + 1, bytes_.size());
    requireSurface();
    is_text_ = format_ == "ascii";
  }

  void readLine() {
    if (words_.is("format"))
      readFormat();
    else if (words_.is("element"))
      readElement();
    else if (words_.is("property"))
      readProperty();
    else if (!words_.is("comment") && !words_.is("obj_info"))
      fail(words_.quoted() + " is no line of a header");
    words_.skipLine();
  }

  void readFormat() {
    words_.nextInLine();
    format_ = words_.word();
    if (format_ != "ascii" && format_ != "binary_little_endian" && format_ != "binary_big_endian") {
      fail("ascii, binary_little_endian or binary_big_endian was expected, not " + words_.quoted());
    }
  }

  /// All others may be surfaces, like `tristrips`.
  void readElement() {
    words_.nextInLine();
    const std::string name = words_.word();
    if (!contains({"vertex", "face", "edge", "material", "camera"}, name)) {
      fail("element " + words_.quoted() + " is not read, and may be a surface");
    }
    if (find(elements_, name)) fail("element '" + name + "' is there twice");
    double count = 0.0;
    words_.nextInLine();
    if (!parseNumber(words_.word(), count) || !(count >= 0.0 && count <= 1e15) ||
        count != std::floor(count)) {
      fail("a count was expected, not " + words_.quoted());
    }
    elements_.push_back({name, static_cast<std::size_t>(count), {}});
  }

  void readProperty() {
    if (elements_.empty()) fail("a property before the first element");
    std::optional<PlyType> count;
    words_.nextInLine();
    if (words_.is("list")) {
      words_.nextInLine();
      count = readType();
      words_.nextInLine();
    }
    const PlyType type = readType();
    words_.nextInLine();
    const std::string name = words_.word();
    if (find(elements_.back().properties, name)) fail("property '" + name + "' is there twice");
    elements_.back().properties.push_back({name, count, type});
  }

  PlyType readType() const {
    static const std::map<std::string, PlyType> TYPES = {
        {"char", plyTypeOf<std::int8_t>()},     {"int8", plyTypeOf<std::int8_t>()},
        {"uchar", plyTypeOf<std::uint8_t>()},   {"uint8", plyTypeOf<std::uint8_t>()},
        {"short", plyTypeOf<std::int16_t>()},   {"int16", plyTypeOf<std::int16_t>()},
        {"ushort", plyTypeOf<std::uint16_t>()}, {"uint16", plyTypeOf<std::uint16_t>()},
        {"int", plyTypeOf<std::int32_t>()},     {"int32", plyTypeOf<std::int32_t>()},
        {"uint", plyTypeOf<std::uint32_t>()},   {"uint32", plyTypeOf<std::uint32_t>()},
        {"float", plyTypeOf<float>()},          {"float32", plyTypeOf<float>()},
        {"double", plyTypeOf<double>()},        {"float64", plyTypeOf<double>()}};
    const auto found = TYPES.find(words_.word());
    if (found == TYPES.end()) fail("a type was expected, not " + words_.quoted());
    return found->second;
  }

  /// Null: there is none.
  template <class Named>
  static const Named* find(const std::vector<Named>& things, const std::string& name) {
    const auto isIt = [&](const Named& thing) { return thing.name == name; };
    const auto found = std::find_if(things.begin(), things.end(), isIt);
    return found == things.end() ? nullptr : &*found;
  }

  void requireSurface() const {
    if (format_.empty()) throw InputError("its header names no format");
    for (const PlyElement& element : elements_) {  // would take no place, however many there are
      if (element.properties.empty()) fail("element '" + element.name + "' has no properties");
    }
    const PlyElement *vertex = find(elements_, "vertex"), *face = find(elements_, "face");
    if (!vertex || !face) throw InputError("it has no elements 'vertex' and 'face'");
    for (const char* axis : {"x", "y", "z"}) {
      const PlyProperty* coordinate = find(vertex->properties, axis);
      if (!coordinate || coordinate->count) {
        throw InputError("its vertices have no property '" + std::string(axis) + "'");
      }
    }
    const auto& of_face = face->properties;
    const auto nb_polygons = std::count_if(
        of_face.begin(), of_face.end(),
        [](const auto& property) { return isPolygon(property.name) && property.count; });
    if (nb_polygons != 1) throw InputError("its faces need one list 'vertex_indices'");
  }

  static bool isPolygon(const std::string& property) {
    return property == "vertex_indices" || property == "vertex_index";
  }

  void readEntry(const PlyElement& element) {
    is_first_ = true;
    MeshBuilder::Corner corner{};
    std::vector<MeshBuilder::Corner> polygon;
    for (const PlyProperty& property : element.properties) {
      const bool is_polygon = element.name == "face" && isPolygon(property.name);
      if (property.count) {
        for (double left = readCount(property); left > 0.0; --left) {
          const double index = next(property.type);
          if (is_polygon) polygon.push_back(cornerAt(index));
        }
      } else {
        const auto value = static_cast<float>(next(property.type));
        const std::size_t axis = std::string("xyz").find(property.name);
        if (property.name.size() == 1 && axis < corner.size()) corner[axis] = value;
      }
    }
    if (element.name == "vertex") addVertex(corner);
    if (element.name == "face") addFace(polygon);
  }

  double readCount(const PlyProperty& list) {
    const double count = next(*list.count);
    if (!(count >= 0.0) || count != std::floor(count)) fail("has a list without a count");
    return count;
  }

  void addVertex(const MeshBuilder::Corner& corner) {
    for (const float coordinate : corner) {
      if (!std::isfinite(coordinate)) fail("needs three finite coordinates");
    }
    vertices_.push_back(corner);
  }

  const MeshBuilder::Corner& cornerAt(double index) const {
    const auto count = static_cast<double>(vertices_.size());
    if (!(index >= 0.0 && index < count) || index != std::floor(index)) {
      fail("names a vertex that is not before it: there are " + std::to_string(vertices_.size()));
    }
    return vertices_[static_cast<std::size_t>(index)];
  }

  void addFace(const std::vector<MeshBuilder::Corner>& polygon) {
    if (polygon.size() < 3) fail("has " + std::to_string(polygon.size()) + " corners");
    if (!builder_.addPolygon(polygon))
      fail("crosses itself, or has more than 500 corners and is not convex");
  }

  /// NaN for a word that is no number: exporters write what they like where there is no normal.
  double next(const PlyType& type) {
    if (is_text_) {
      if (is_first_ ? !words_.next() : !words_.nextInLine()) fail("is missing, or part of it");
      is_first_ = false;
      double number = 0.0;
      return parseNumber(words_.word(), number) ? number : std::nan("");
    }
    if (bytes_.size() - at_ < type.size) fail("is missing, or part of it (truncated?)");
    std::array<char, sizeof(double)> number;
    std::copy_n(bytes_.begin() + at_, type.size, number.begin());
    if (format_ == "binary_big_endian") std::reverse(number.begin(), number.begin() + type.size);
    at_ += type.size;
    return type.value(number.data());
  }

  /// What follows may be a surface that the header does not count.
  void requireEnd() {
    place_.first = nullptr;
    if (is_text_ ? words_.next() : bytes_.find_first_not_of('\0', at_) != std::string::npos) {
      fail("more follows than the header counts");
    }
  }

  const std::string& bytes_;
  MeshWords words_;
  std::string format_;
  std::vector<PlyElement> elements_;
  bool is_text_ = true;
  std::size_t at_ = 0;                                 ///< in a binary file, of the next number
  bool is_first_ = false;                              ///< of its line, in a text
  std::pair<const PlyElement*, std::size_t> place_{};  ///< what is read now
  std::vector<MeshBuilder::Corner> vertices_;
  MeshBuilder builder_;
};

}  // namespace

TriangleMesh readPly(const std::string& bytes) { return PlyReader(bytes).read(); }

}  // namespace collision_pairs
