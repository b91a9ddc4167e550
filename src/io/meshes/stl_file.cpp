#include <cstring>

#include "collision_pairs/input_error.h"
#include "mesh_builder.h"
#include "mesh_files.h"
#include "mesh_text.h"

namespace collision_pairs {
namespace {

constexpr std::size_t HEADER = 80, COUNT = 4;  // bytes
constexpr std::size_t TRIANGLE = 50;           // bytes: normal, three corners, two of attributes
constexpr std::size_t NORMAL = 12;

TriangleMesh readBinary(const std::string& bytes, std::size_t nb_triangles) {
  MeshBuilder builder;
  const char* at = bytes.data() + HEADER + COUNT;
  for (std::size_t i = 0; i < nb_triangles; ++i, at += TRIANGLE) {
    std::array<MeshBuilder::Corner, 3> corners;
    std::memcpy(&corners, at + NORMAL, sizeof corners);  // little-endian, like all platforms of ROS
    builder.addTriangle(corners[0], corners[1], corners[2]);
  }
  return builder.finish();
}

/// Line breaks between the words of the format are arbitrary; only names extend to the end of their
/// line.
class AsciiReader {
 public:
  explicit AsciiReader(const std::string& text) : words_(text) {}

  TriangleMesh read() {
    while (words_.next()) {
      if (words_.is("solid"))
        begin();
      else if (words_.is("facet"))
        readFacet();
      else if (words_.is("endsolid"))
        end();
      else
        fail("solid, facet or endsolid");
    }
    if (in_solid_) throw InputError("it ends within a solid (truncated?)");
    return builder_.finish();
  }

 private:
  [[noreturn]] void fail(const std::string& wanted) const {
    throw InputError("line " + std::to_string(words_.line()) + ": " + words_.quoted() +
                     " found where " + wanted + " was expected");
  }
  void expect(const char* word) {
    if (!words_.next() || !words_.is(word)) fail(std::string("'") + word + "'");
  }

  void begin() {
    if (in_solid_) fail("facet or endsolid");
    in_solid_ = true;
    words_.skipLine();
  }
  void end() {
    if (!in_solid_) fail("solid");
    in_solid_ = false;
    words_.skipLine();
  }

  void readFacet() {
    if (!in_solid_) fail("solid");
    expect("normal");
    for (int i = 0; i < 3; ++i) words_.next();  // exporters write nan if there is no area
    expect("outer");
    expect("loop");
    std::array<MeshBuilder::Corner, 3> corners;
    for (auto& corner : corners) {
      expect("vertex");
      for (float& coordinate : corner) {
        if (!words_.next() || !words_.number(coordinate)) fail("a finite coordinate");
      }
    }
    expect("endloop");
    expect("endfacet");
    builder_.addTriangle(corners[0], corners[1], corners[2]);
  }

  MeshWords words_;
  MeshBuilder builder_;
  bool in_solid_ = false;
};

// Binary files may begin with anything, "solid" included.
bool looksAscii(const std::string& bytes) {
  constexpr std::size_t FAR_ENOUGH = 1024;  // bytes: the solid's name comes before
  const std::string beginning = bytes.substr(0, FAR_ENOUGH);
  return beginning.compare(0, 5, "solid") == 0 && (beginning.find("facet") != std::string::npos ||
                                                   beginning.find("endsolid") != std::string::npos);
}

}  // namespace

TriangleMesh readStl(const std::string& bytes) {
  std::uint32_t nb_triangles = 0;
  const bool has_count = bytes.size() >= HEADER + COUNT;
  if (has_count) std::memcpy(&nb_triangles, bytes.data() + HEADER, COUNT);
  const std::size_t wanted = HEADER + COUNT + TRIANGLE * std::size_t{nb_triangles};
  if (has_count && bytes.size() == wanted) return readBinary(bytes, nb_triangles);
  if (looksAscii(bytes)) return AsciiReader(bytes).read();
  if (!has_count) throw InputError("it is too short for an STL file");
  if (bytes.size() > wanted) return readBinary(bytes, nb_triangles);  // exporters pad at the end
  throw InputError("it should have " + std::to_string(nb_triangles) +
                   " triangles, but ends after " +
                   std::to_string((bytes.size() - HEADER - COUNT) / TRIANGLE) + " (truncated?)");
}

}  // namespace collision_pairs
