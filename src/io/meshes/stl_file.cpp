#include <algorithm>
#include <cctype>
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
  const std::size_t end = HEADER + COUNT + TRIANGLE * nb_triangles;
  // Exporters pad at the end. What else follows are triangles, and the count is wrong.
  const bool is_padding =
      bytes.size() < end + TRIANGLE || bytes.find_first_not_of('\0', end) == std::string::npos;
  if (!is_padding) {
    throw InputError("it counts " + std::to_string(nb_triangles) +
                     " triangles, but is long enough for " +
                     std::to_string((bytes.size() - HEADER - COUNT) / TRIANGLE));
  }
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
      if (words_.isInAnyCase("solid"))
        begin();
      else if (words_.isInAnyCase("facet"))
        readFacet();
      else if (words_.isInAnyCase("endsolid"))
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
    if (!words_.next() || !words_.isInAnyCase(word)) fail(std::string("'") + word + "'");
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

/// Without a byte order mark and leading blanks, and with line breaks where there are carriage
/// returns alone.
std::string plainText(const std::string& bytes) {
  std::string text = withoutByteOrderMark(bytes);
  if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
  return text;
}

bool isControl(char c) { return static_cast<unsigned char>(c) < ' ' && (c < '\t' || c > '\r'); }

/// Binary files may begin with anything, "solid" and "facet" included.
bool looksAscii(const std::string& bytes) {
  constexpr std::size_t FAR_ENOUGH = 1024;  // bytes: the solid's name comes before
  std::string beginning = plainText(bytes.substr(0, FAR_ENOUGH));
  std::transform(beginning.begin(), beginning.end(), beginning.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::size_t first = beginning.find_first_not_of(" \t\r\n");
  return first != std::string::npos && beginning.compare(first, 5, "solid") == 0 &&
         (beginning.find("facet") != std::string::npos ||
          beginning.find("endsolid") != std::string::npos);
}

}  // namespace

TriangleMesh readStl(const std::string& bytes) {
  std::uint32_t nb_triangles = 0;
  const bool has_count = bytes.size() >= HEADER + COUNT;
  if (has_count) std::memcpy(&nb_triangles, bytes.data() + HEADER, COUNT);
  const std::size_t wanted = HEADER + COUNT + TRIANGLE * std::size_t{nb_triangles};
  // The number of triangles is no text.
  const bool is_number =
      has_count && std::any_of(bytes.begin() + HEADER, bytes.begin() + HEADER + COUNT, isControl);
  if (has_count && (bytes.size() == wanted || (is_number && bytes.size() > wanted))) {
    return readBinary(bytes, nb_triangles);
  }
  if (looksAscii(bytes)) {
    const std::string text = plainText(bytes);
    return AsciiReader(text).read();
  }
  if (!has_count) throw InputError("it is too short for an STL file");
  if (bytes.size() > wanted) return readBinary(bytes, nb_triangles);
  throw InputError("it should have " + std::to_string(nb_triangles) +
                   " triangles, but ends after " +
                   std::to_string((bytes.size() - HEADER - COUNT) / TRIANGLE) + " (truncated?)");
}

}  // namespace collision_pairs
