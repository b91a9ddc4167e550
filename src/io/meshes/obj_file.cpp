#include <algorithm>
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

/// A line that ends with a backslash goes on, unless it is a comment.
void joinContinuedLines(std::string& text) {
  bool is_new = true, is_comment = false;
  for (std::size_t begin = 0, end; (end = text.find('\n', begin)) != std::string::npos;) {
    const std::size_t first = text.find_first_not_of(" \t\r", begin);
    if (is_new) is_comment = text[first] == '#';
    const std::size_t last = text.find_last_not_of('\r', end - (end > 0 ? 1 : 0));
    const bool goes_on =
        last != std::string::npos && last >= begin && text[last] == '\\' && !is_comment;
    if (goes_on)
      std::fill(text.begin() + static_cast<std::ptrdiff_t>(last),
                text.begin() + static_cast<std::ptrdiff_t>(end) + 1, ' ');
    is_new = !goes_on;
    begin = end + 1;
  }
}

class Reader {
 public:
  explicit Reader(const std::string& text) : words_(text) {}

  TriangleMesh read() {
    while (words_.next()) {
      if (words_.is("v")) {
        readVertex();
      } else if (words_.is("f")) {
        readFace();
      } else if (!makesNoSurface(words_.word())) {
        fail(words_.quoted() + " is not read, and may be a surface");
      }
      words_.skipLine();
    }
    return builder_.finish();
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError("line " + std::to_string(words_.line()) + ": " + why);
  }

  bool nextOfStatement() { return words_.nextInLine() && words_.word()[0] != '#'; }

  void readVertex() {
    Corner corner;
    for (float& coordinate : corner) {
      if (!words_.nextInLine() || !words_.number(coordinate)) {
        fail("a vertex needs three finite coordinates, not " + words_.quoted());
      }
    }
    vertices_.push_back(corner);
    float weight = 1.0f;  // or the first of three or four numbers of a colour
    std::size_t nb_more = 0;
    while (nextOfStatement()) {
      if (nb_more++ == 0 && !words_.number(weight)) fail("a vertex has " + words_.quoted());
    }
    if (nb_more == 1 && weight != 1.0f) fail("weights of vertices are not read");
  }

  void readFace() {
    std::vector<Corner> polygon;
    while (nextOfStatement()) polygon.push_back(vertices_[readIndex()]);
    if (polygon.size() < 3) fail("a face of " + std::to_string(polygon.size()) + " corners");
    if (!builder_.addPolygon(polygon))
      fail("a face that crosses itself, or of more than 500 corners and not convex");
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

TriangleMesh readObj(const std::string& bytes) {
  std::string text = withoutByteOrderMark(bytes);
  joinContinuedLines(text);
  return Reader(text).read();
}

}  // namespace collision_pairs
