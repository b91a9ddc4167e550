// PLY files: written at random, as text and in both byte orders, then damaged.
#include <algorithm>
#include <cstring>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh_files.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_ply_file {

using testing::HasSubstr;

using Corners = std::array<std::array<float, 3>, 3>;

/// Writes numbers as one of the three formats has them.
class PlyWriter {
 public:
  explicit PlyWriter(std::string format) : format_(std::move(format)) {}

  void number(const std::string& type, double value) {
    if (format_ == "ascii") {
      std::ostringstream text;
      text.precision(9);
      text << value << ' ';
      body_ += text.str();
    } else if (type == "float" || type == "float32") {
      append(static_cast<float>(value));
    } else if (type == "double") {
      append(value);
    } else if (type == "uchar" || type == "uint8") {
      append(static_cast<std::uint8_t>(value));
    } else if (type == "short") {
      append(static_cast<std::int16_t>(value));
    } else {
      ASSERT_EQ(type, "int");
      append(static_cast<std::int32_t>(value));
    }
  }
  void endLine() {
    if (format_ == "ascii") body_ += '\n';
  }
  std::string file(const std::string& elements) const {
    return "ply\nformat " + format_ + " 1.0\ncomment element face 7\n" + elements + "end_header\n" +
           body_;
  }

 private:
  template <class Number>
  void append(Number value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(&bytes[0], &value, sizeof value);
    if (format_ == "binary_big_endian") std::reverse(bytes.begin(), bytes.end());
    body_ += bytes;
  }

  std::string format_, body_;
};

std::vector<Corners> trianglesOf(const TriangleMesh& mesh) {
  std::vector<Corners> triangles;
  for (const auto& triangle : mesh.triangles) {
    Corners corners;
    for (int i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        corners[i][axis] = static_cast<float>(mesh.vertices.at(triangle[i])[axis]);
      }
    }
    triangles.push_back(corners);
  }
  return triangles;
}

/// Triangles with corners on a grid, and a file of them whose properties, types and order of
/// coordinates are drawn.
struct RandomPly {
  RandomPly(RandomInputs& random, const std::string& format) {
    PlyWriter writer(format);
    const auto oneOf = [&](std::initializer_list<const char*> names) -> std::string {
      return names.begin()[random.integer(0, static_cast<int>(names.size()) - 1)];
    };
    const int nb_vertices = random.integer(3, 9), nb_faces = random.integer(1, 6);
    std::array<std::string, 3> axes = {"x", "y", "z"};
    std::shuffle(axes.begin(), axes.end(), random.engine());
    const std::string real = oneOf({"float", "float32", "double"}),
                      unused = oneOf({"uchar", "short", "double"});
    std::string elements = "element vertex " + std::to_string(nb_vertices) + "\n";
    for (const std::string& axis : axes) elements += "property " + real + " " + axis + "\n";
    elements += "property " + unused + " quality\n";
    std::vector<std::array<float, 3>> vertices(nb_vertices);
    for (auto& vertex : vertices) {
      for (const std::string& axis : axes) {
        float& coordinate = vertex[axis[0] - 'x'];
        coordinate = 0.125f * static_cast<float>(random.integer(-99, 99));
        writer.number(real, coordinate);
      }
      writer.number(unused, 7);
      writer.endLine();
    }
    const std::string count = oneOf({"uchar", "uint8", "int"}),
                      index = oneOf({"int", "short", "uchar"});
    const std::string texture = oneOf({"float", "double"});
    elements += "element face " + std::to_string(nb_faces) + "\nproperty list " + count + " " +
                texture + " texcoord\nproperty list " + count + " " + index +
                oneOf({" vertex_index\n", " vertex_indices\n"});
    for (int i = 0; i < nb_faces; ++i) {
      const int nb_textures = random.integer(0, 3);
      writer.number(count, nb_textures);
      for (int k = 0; k < nb_textures; ++k) writer.number(texture, 0.5);
      writer.number(count, 3);
      Corners corners;
      for (auto& corner : corners) {
        const int at = random.integer(0, nb_vertices - 1);
        corner = vertices[at];
        writer.number(index, at);
      }
      triangles.push_back(corners);
      writer.endLine();
    }
    elements += "element edge 1\nproperty int vertex1\n";
    writer.number("int", 2);
    writer.endLine();
    bytes = writer.file(elements);
  }

  std::string bytes;
  std::vector<Corners> triangles;
};

const char* const FORMATS[] = {"ascii", "binary_little_endian", "binary_big_endian"};

TEST(PlyFile, TrianglesAreThoseWrittenInEachFormatWhateverElseIsThere) {
  RandomInputs random;
  for (int i = 0; i < 3000; ++i) {
    const RandomPly ply(random, FORMATS[i % 3]);
    ASSERT_EQ(trianglesOf(readPly(ply.bytes)), ply.triangles) << ply.bytes;
  }
}

TEST(PlyFile, NoneThatIsTruncatedIsRead) {
  RandomInputs random;
  for (int i = 0; i < 60; ++i) {
    const RandomPly ply(random, FORMATS[i % 3]);
    // A text may lack its last line break and blank, and its last number digits.
    const std::size_t whole = ply.bytes.size() - (i % 3 == 0 ? 3 : 0);
    for (std::size_t length = 0; length < whole; ++length) {
      ASSERT_NE(refusal([&] { readPly(ply.bytes.substr(0, length)); }), "accepted")
          << length << ply.bytes;
    }
    const std::string more = i % 3 == 0 ? "3 0 1 2\n" : "\1";
    ASSERT_NE(refusal([&] { readPly(ply.bytes + more); }), "accepted");
  }
}

/// A letter may change what is not read: comments, or names of what is not used.
TEST(PlyFile, NoLetterOfTheHeaderChangesOrLeavesOutTriangles) {
  RandomInputs random;
  int nb_refused = 0, nb_read = 0;
  for (int i = 0; i < 300; ++i) {
    const RandomPly ply(random, FORMATS[i % 3]);
    const std::size_t header = ply.bytes.find("end_header") + 10;
    for (std::size_t at = 0; at < header; ++at) {
      std::string changed = ply.bytes;
      changed[at] = "xyz_aeiou0123 \nfdt"[random.integer(0, 17)];
      std::optional<TriangleMesh> mesh;
      nb_refused += refusal([&] { mesh = readPly(changed); }) != "accepted";
      if (!mesh) continue;
      ++nb_read;
      ASSERT_EQ(trianglesOf(*mesh), ply.triangles) << changed << "\n\nwas\n\n" << ply.bytes;
    }
  }
  EXPECT_GT(nb_refused, 300 * 100);
  EXPECT_GT(nb_read, 300 * 30);
}

TEST(PlyFile, NoBytesDoMoreThanBeRefused) {
  RandomInputs random;
  int nb_read = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string bytes = RandomPly(random, FORMATS[i % 3]).bytes;
    const int size = static_cast<int>(bytes.size());
    for (int k = random.integer(0, 2); k >= 0; --k) {
      bytes[random.integer(0, size - 1)] = static_cast<char>(random.integer(0, 255));
    }
    std::optional<TriangleMesh> mesh;
    refusal([&] { mesh = readPly(bytes); });
    if (!mesh) continue;
    ++nb_read;
    ASSERT_LE(mesh->triangles.size(), bytes.size()) << "file " << i;
    for (const auto& triangle : mesh->triangles) {
      for (const auto index : triangle) ASSERT_LT(index, mesh->vertices.size()) << "file " << i;
    }
  }
  EXPECT_GT(nb_read, 2000) << "the files are too broken to try anything";
}

std::string ply(const std::string& body, const std::string& before = "",
                const std::string& after = "") {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::size_t at = header.find(before);
  return header.substr(0, at) + after + header.substr(at + before.size()) + body;
}
const std::string SQUARE = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TEST(PlyFile, PolygonsAreSplitAndThoseThatCrossThemselvesRefused) {
  EXPECT_EQ(readPly(ply(SQUARE + "4 0 1 2 3\n")).triangles.size(), 2u);
  EXPECT_EQ(readPly(ply("0 0 0\n1 0 0\n0.1 0.1 0\n0 1 0\n4 0 1 2 3\n")).triangles.size(), 2u);
  EXPECT_THAT(refusal([] { readPly(ply(SQUARE + "4 0 2 1 3\n")); }),
              HasSubstr("line 14: face 0 crosses itself"));
  EXPECT_THAT(refusal([] { readPly(ply(SQUARE + "2 0 1\n")); }),
              HasSubstr("line 14: face 0 has 2 corners"));
}

TEST(PlyFile, WhatIsWrongIsSaidInTheseWords) {
  const std::string face = "3 0 1 2\n";
  const std::vector<std::array<std::string, 4>> cases = {
      {SQUARE + face, "ply", "plx", "line 1: 'ply' was expected, not 'plx'"},
      {SQUARE + face, "ascii", "asci",
       "line 2: ascii, binary_little_endian or binary_big_endian was expected, not 'asci'"},
      {SQUARE + face, "format ascii 1.0\n", "", "its header names no format"},
      {SQUARE + face, "element face", "element tristrips",
       "line 7: element 'tristrips' is not read, and may be a surface"},
      {SQUARE + face, "element face", "element vertex", "line 7: element 'vertex' is there twice"},
      {SQUARE + face, "vertex 4", "vertex four", "line 3: a count was expected, not 'four'"},
      {SQUARE + face, "float y", "float x", "line 5: property 'x' is there twice"},
      {SQUARE + face, "float z", "float zz", "its vertices have no property 'z'"},
      {SQUARE + face, "float z", "flaot z", "line 6: a type was expected, not 'flaot'"},
      {SQUARE + face, "vertex_indices", "vertices", "its faces need one list 'vertex_indices'"},
      {SQUARE + face, "property list", "proprety list",
       "line 8: 'proprety' is no line of a header"},
      {SQUARE + face, "element face 1\nproperty list uchar int vertex_indices\n", "",
       "it has no elements 'vertex' and 'face'"},
      {SQUARE + face, "end_header\n", "", "line 9: '0' is no line of a header"},
      {SQUARE, "", "", "line 14: face 0 is missing, or part of it"},
      {SQUARE + face + face, "", "", "line 15: more follows than the header counts"},
      {SQUARE + "3 0 1 4\n", "", "",
       "line 14: face 0 names a vertex that is not before it: there are 4"},
      {SQUARE + "3 0 1 -1\n", "", "",
       "line 14: face 0 names a vertex that is not before it: there are 4"},
      {SQUARE + "3 0 1 2 3\n", "", "", "line 14: face 0 has more numbers than properties"},
      {SQUARE + "x 0 1 2 3\n", "", "", "line 14: face 0 has a list without a count"},
      {"0 0 0\n1 0 inf\n" + SQUARE + face, "", "",
       "line 11: vertex 1 needs three finite coordinates"}};
  for (const auto& [body, before, after, why] : cases) {
    EXPECT_EQ(refusal([&, &body = body, &before = before, &after = after] {
                readPly(ply(body, before, after));
              }),
              why);
  }
}

TEST(PlyFile, CountsThatNoFileCanHoldTakeNeitherTimeNorMemory) {
  const std::string endless = ply(SQUARE, "vertex 4", "vertex 999999999999999");
  EXPECT_THAT(refusal([&] { readPly(endless); }), HasSubstr("vertex 4 is missing"));
  const std::string empty =
      ply("", "element face 1\n", "element edge 999999999999999\nelement face 1\n");
  EXPECT_THAT(refusal([&] { readPly(empty); }), HasSubstr("element 'edge' has no properties"));
}

}  // namespace collision_pairs::test_ply_file
