#include <cmath>
#include <set>
#include <vector>

#include "collision_pairs/input_error.h"
#include "mesh_builder.h"
#include "mesh_files.h"
#include "mesh_text.h"

namespace collision_pairs {
namespace {

using Corner = MeshBuilder::Corner;

/// All others may be surfaces, or say where these are.
bool makesNoSurface(const std::string& word) {
  static const std::set<std::string> NAMES = {
      "vt",       "vn",       "vp",     "o",          "g",        "s", "mg",
      "usemtl",   "mtllib",   "usemap", "maplib",     "l",        "p", "bevel",
      "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj"};
  return word[0] == '#' || NAMES.count(word) > 0;
}

class Reader {
 public:
  explicit Reader(const std::string& text) : words_(text) {}

  /// Empty if the file contains something unsupported.
  std::optional<TriangleMesh> read() {
    while (words_.next()) {
      if (words_.is("v")) {
        if (!readVertex()) return std::nullopt;
      } else if (words_.is("f")) {
        if (!readFace()) return std::nullopt;
      } else if (!makesNoSurface(words_.word())) {
        fail(words_.quoted() + " is not read, and may be a surface");
      }
      while (words_.nextInLine()) {
        if (words_.is("\\")) return std::nullopt;
      }
    }
    return builder_.finish();
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError("line " + std::to_string(words_.line()) + ": " + why);
  }

  bool readVertex() {
    Corner corner;
    for (float& coordinate : corner) {
      if (!words_.nextInLine() || !words_.number(coordinate)) {
        fail("a vertex needs three finite coordinates, not " + words_.quoted());
      }
    }
    vertices_.push_back(corner);
    std::size_t nb_more = 0;  // three of a colour, or one weight
    while (words_.nextInLine() && !words_.is("\\")) ++nb_more;
    return nb_more != 1 && !words_.is("\\");
  }

  bool readFace() {
    std::vector<Corner> polygon;
    while (words_.nextInLine()) {
      if (words_.is("\\")) return false;
      polygon.push_back(vertices_[readIndex()]);
    }
    if (polygon.size() < 3) fail("a face of " + std::to_string(polygon.size()) + " corners");
    return builder_.addPolygon(polygon);
  }

  /// "vertex", "vertex/texture", "vertex//normal": from 1 on, or from -1 backwards.
  std::size_t readIndex() const {
    const std::string word = words_.word();
    double index = 0.0;
    const bool is_number = parseNumber(word.substr(0, word.find('/')), index);
    const auto count = static_cast<double>(vertices_.size());
    const double place = index < 0.0 ? count + index : index - 1.0;
    if (!is_number || place != std::floor(place) || place < 0.0 || place >= count) {
      fail("a face names vertex " + words_.quoted() + ", but there are " +
           std::to_string(vertices_.size()) + " before it");
    }
    return static_cast<std::size_t>(place);
  }

  MeshWords words_;
  std::vector<Corner> vertices_;
  MeshBuilder builder_;
};

}  // namespace

std::optional<TriangleMesh> readObj(const std::string& bytes) {
  const std::string text = withoutByteOrderMark(bytes);
  return Reader(text).read();
}

}  // namespace collision_pairs
