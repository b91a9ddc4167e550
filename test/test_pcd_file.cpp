// PCD files, as they are found and as they should not be.
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "pcd_file.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_pcd_file {

using Eigen::Vector3d;

const std::string XYZ =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\n"
    "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n";

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::string refusal(const std::string& file) {
  return collision_pairs::refusal([&] { readPcd(file); });
}

void expectRefused(const std::string& file, const std::string& why) {
  EXPECT_THAT(refusal(file), testing::HasSubstr(why));
}

TEST(PcdFile, TextIsRead) {
  const auto points = readPcd(XYZ + "DATA ascii\n1 2 3\n-0.5 1e-3 nan\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0], Vector3d(1, 2, 3));
  EXPECT_EQ(points[1].head<2>(), Eigen::Vector2d(-0.5, 1e-3));
  EXPECT_TRUE(std::isnan(points[1][2]));
}

TEST(PcdFile, TextMayHaveEmptyLinesAndSayInAnyWayThatAPointIsMissing) {
  const auto points = readPcd(
      "#.PCD v0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 2\nDATA ascii\n"
      "1 2 3\n\n-nan NAN inf\n-inf -Inf 5\n4 5 6\n");
  ASSERT_EQ(points.size(), 4u);
  EXPECT_TRUE(points[1].array().isNaN().all());
  EXPECT_TRUE(points[2].head<2>().array().isNaN().all());
  EXPECT_EQ(points[3], Vector3d(4, 5, 6));
}

TEST(PcdFile, BinaryIsReadInSingleAndDoublePrecision) {
  const auto points =
      readPcd(XYZ + "DATA binary\n" + bytesOf<float>({1.5f, 2, 3, -4, NAN, INFINITY}));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0], Vector3d(1.5, 2, 3));
  EXPECT_EQ(points[1][0], -4);
  EXPECT_TRUE(std::isnan(points[1][1]));
  EXPECT_TRUE(std::isinf(points[1][2]));
  const std::string doubles =
      "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA binary\n";
  EXPECT_EQ(readPcd(doubles + bytesOf<double>({0.1, -0.2, 1e9}))[0], Vector3d(0.1, -0.2, 1e9));
}

TEST(PcdFile, CoordinatesMayStandAnywhereAmongOtherFields) {
  const std::string header =
      "FIELDS rgb z normal x y label\nSIZE 4 8 4 4 4 1\nTYPE U F F F F I\nCOUNT 1 1 3 1 1 2\n"
      "POINTS 1\n";
  std::string point =
      bytesOf<std::uint32_t>({7}) + bytesOf<double>({3.0}) + bytesOf<float>({9, 9, 9, 1, 2}) + "ab";
  EXPECT_EQ(readPcd(header + "DATA binary\n" + point)[0], Vector3d(1, 2, 3));
  EXPECT_EQ(readPcd(header + "DATA ascii\n7 3 9 9 9 1 2 0 0")[0], Vector3d(1, 2, 3));
}

/// LZF of the bytes, by the format's description: what is not a repetition at random offsets is
/// copied in runs of random lengths.
std::string compressed(const std::string& bytes, std::mt19937& random) {
  std::string lzf;
  const auto uniform = [&](std::size_t most) {
    return std::uniform_int_distribution<std::size_t>(1, most)(random);
  };
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t offset = at == 0 ? 0 : uniform(std::min<std::size_t>(at, 8192));
    const std::size_t most = std::min<std::size_t>(bytes.size() - at, 264);
    std::size_t same = 0;
    while (offset > 0 && same < most && bytes[at + same] == bytes[at + same - offset]) ++same;
    if (same >= 3) {
      const std::size_t length = same - 2, top = std::min<std::size_t>(length, 7);
      lzf.push_back(static_cast<char>(top << 5 | (offset - 1) >> 8));
      if (top == 7) lzf.push_back(static_cast<char>(length - 7));
      lzf.push_back(static_cast<char>((offset - 1) & 255));
      at += same;
    } else {
      const std::size_t count = std::min<std::size_t>(uniform(32), bytes.size() - at);
      lzf.push_back(static_cast<char>(count - 1));
      lzf += bytes.substr(at, count);
      at += count;
    }
  }
  return lzf;
}

TEST(PcdFile, WhatIsCompressedIsReadAsWhatIsNot) {
  std::mt19937 random(givenSeed());
  for (int round = 0; round < 100; ++round) {
    const std::size_t count = random() % 3000;
    std::vector<std::uint16_t> labels(count);
    std::vector<float> x(count), z(count);
    std::vector<double> y(count);
    std::string rows;
    for (std::size_t i = 0; i < count; ++i) {
      labels[i] = static_cast<std::uint16_t>(random() % 3);
      x[i] = round % 2 == 0 ? 1.0f : static_cast<float>(random()) * 1e-9f;
      y[i] = static_cast<double>(i % 7) * 0.1;
      z[i] = static_cast<float>(random() % 4);
      rows += bytesOf<float>({x[i]}) + bytesOf<std::uint16_t>({labels[i]}) +
              bytesOf<double>({y[i]}) + bytesOf<float>({z[i]});
    }
    const std::string header = "FIELDS x label y z\nSIZE 4 2 8 4\nTYPE F U F F\nPOINTS " +
                               std::to_string(count) + "\nDATA binary";
    const std::string fields = bytesOf(x) + bytesOf(labels) + bytesOf(y) + bytesOf(z);
    const std::string lzf = compressed(fields, random);
    const auto sizes = bytesOf<std::uint32_t>(
        {static_cast<std::uint32_t>(lzf.size()), static_cast<std::uint32_t>(fields.size())});
    ASSERT_EQ(readPcd(header + "_compressed\n" + sizes + lzf), readPcd(header + "\n" + rows));
  }
}

/// Made by liblzf 3.6, the author's.
TEST(PcdFile, ACompressedFileOfTheAuthorsLibraryIsRead) {
  std::ifstream file(std::string(PROJECT_SOURCE_DIR) + "/test/fuzz/corpus_pcd/binary_compressed",
                     std::ios::binary);
  const auto points = readPcd({std::istreambuf_iterator<char>(file), {}});
  ASSERT_EQ(points.size(), 40u);
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(points[i],
              Vector3d(0.5 * static_cast<double>(i % 4), 0.25 * static_cast<double>(i), 1));
  }
}

std::string twoCompressed(std::uint32_t size, const std::string& lzf) {
  return XYZ + "DATA binary_compressed\n" +
         bytesOf<std::uint32_t>({static_cast<std::uint32_t>(lzf.size()), size}) + lzf;
}

TEST(PcdFile, DamagedCompressedDataAreRefused) {
  const std::string whole =
      std::string(1, 0) + "0" + std::string("\xe0\x0e\x00", 3);  // 24 times '0'
  EXPECT_EQ(readPcd(twoCompressed(24, whole)).size(), 2u);
  expectRefused(XYZ + "DATA binary_compressed\nabc", "ends after 0");
  expectRefused(twoCompressed(24, whole).substr(0, XYZ.size() + 34), "ends after 0");
  expectRefused(twoCompressed(25, whole), "its data claim 25 bytes");
  expectRefused(twoCompressed(4294967295u, whole), "its data claim 4294967295 bytes");
  expectRefused(twoCompressed(24, whole.substr(0, 4)), "end within a run");
  expectRefused(twoCompressed(24, whole.substr(0, 2)), "end too early");
  expectRefused(twoCompressed(24, ""), "end too early");
  expectRefused(twoCompressed(24, whole + std::string(2, 0)), "more than they claim");
  expectRefused(twoCompressed(24, std::string(1, 5) + "012"), "end within a run");
  expectRefused(twoCompressed(24, std::string(1, 0) + "0" + std::string("\xe0\x0e\x01", 3)),
                "before their beginning");
  const std::string many = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 300000000\n";
  expectRefused(many + twoCompressed(3600000000u, whole).substr(XYZ.size()), "too short");
  const std::string wrapping = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 357913942\n";
  expectRefused(wrapping + twoCompressed(8, whole).substr(XYZ.size()), "its data claim 8 bytes");
}

TEST(PcdFile, MorePointsThanTheHeaderSaysAreRefusedButNotAPageFilledWithZeros) {
  RandomInputs random;
  for (int i = 0; i < 300; ++i) {
    const int nb = random.integer(0, 3), nb_more = random.integer(1, 3);
    std::string points;
    for (int p = 0; p < nb + nb_more; ++p) {
      points += bytesOf<float>({static_cast<float>(random.uniform(0.1, 2.0)), 0.0f, 0.0f});
    }
    const auto size = static_cast<std::size_t>(12 * nb);
    const std::string header = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS " + std::to_string(nb);
    const std::string binary = header + "\nDATA binary\n";
    const std::string why = "go on after the " + std::to_string(nb) + " points";
    expectRefused(binary + points, why);
    const std::string zeros(static_cast<std::size_t>(random.integer(0, 4096)), '\0');
    EXPECT_EQ(readPcd(binary + points.substr(0, size) + zeros).size(),
              static_cast<std::size_t>(nb));
    const std::string in_fields = header + "\nDATA binary_compressed\n";
    if (nb == 0) expectRefused(in_fields + points, why);
    if (nb == 0 || size > 32) continue;  // a run has 1 to 32 bytes
    const std::string run = char(size - 1) + points.substr(0, size);
    const std::string compressed =
        in_fields + bytesOf<std::uint32_t>(
                        {static_cast<std::uint32_t>(run.size()), static_cast<std::uint32_t>(size)});
    EXPECT_EQ(readPcd(compressed + run + zeros).size(), static_cast<std::size_t>(nb));
    expectRefused(compressed + run + points.substr(size), why);
  }
}

TEST(PcdFile, NoPointsAreNone) {
  const std::string none = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 0\n";
  EXPECT_TRUE(readPcd(none + "DATA binary\n").empty());
  EXPECT_TRUE(readPcd(none + "DATA ascii\n").empty());
  EXPECT_TRUE(readPcd(none + "DATA binary_compressed\n").empty());
}

TEST(PcdFile, WhatIsWrongIsSaidInTheseWords) {
  const std::string x20(20, 'x'), fields = "FIELDS x y z\n", sizes = "SIZE 4 4 4\n";
  const std::string xyz = fields + sizes + "TYPE F F F\n";
  const std::string field_z = ": field z must be one number of TYPE F and SIZE 4 or 8";
  const std::string lengths = ": FIELDS, SIZE, TYPE and COUNT differ in length";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "it has no DATA line: it is not a PCD file, or is truncated"},
      {xyz + "POINTS 0\n", "it has no DATA line: it is not a PCD file, or is truncated"},
      {"hello world\n", "line 1: 'hello' is not a keyword of a PCD header"},
      {"#\n\n" + x20 + "x\n", "line 3: '" + x20 + "' is not a keyword of a PCD header"},
      {XYZ + "DATA gzip\n",
       "line 11: DATA is 'gzip', but must be ascii, binary or binary_compressed"},
      {XYZ + "DATA " + x20 + "x\n",
       "line 11: DATA is '" + x20 + "', but must be ascii, binary or binary_compressed"},
      {XYZ + "DATA\n", "line 11: DATA must be one word"},
      {XYZ + "DATA ascii binary\n", "line 11: DATA must be one word"},
      {"POINTS\n", "line 1: POINTS must have one number"},
      {"WIDTH 1 2\n", "line 1: WIDTH must have one number"},
      {"HEIGHT -1\n", "line 1: HEIGHT: '-1' is not a whole number"},
      {"POINTS 4000000000\n", "line 1: POINTS: '4000000000' is not a whole number"},
      {"POINTS " + x20 + "x\n", "line 1: POINTS: '" + x20 + "' is not a whole number"},
      {"SIZE 4 4.5 4\n", "line 1: SIZE: '4.5' is not a whole number"},
      {"COUNT 1 1 x\n", "line 1: COUNT: 'x' is not a whole number"},
      {sizes + "TYPE F F F\nPOINTS 1\nDATA ascii\n", "line 4: there is no FIELDS line"},
      {fields + "TYPE F F F\nPOINTS 1\nDATA ascii\n", "line 4" + lengths},
      {fields + sizes + "POINTS 1\nDATA ascii\n", "line 4" + lengths},
      {xyz + "COUNT 1 1\nPOINTS 1\nDATA ascii\n", "line 6" + lengths},
      {"FIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2\n",
       "line 5: there is no field z"},
      {"FIELDS y z\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2\n",
       "line 5: there is no field x"},
      {fields + "SIZE 4 4 2\nTYPE F F F\nPOINTS 1\nDATA ascii\n", "line 5" + field_z},
      {fields + "SIZE 4 4 16\nTYPE F F F\nPOINTS 1\nDATA ascii\n", "line 5" + field_z},
      {fields + sizes + "TYPE F F I\nPOINTS 1\nDATA ascii\n", "line 5" + field_z},
      {xyz + "COUNT 1 1 3\nPOINTS 1\nDATA ascii\n", "line 6" + field_z},
      {"FIELDS x y z x\nSIZE 4 4 4 4\nTYPE F F F F\nPOINTS 1\nDATA ascii\n",
       "line 5: field x occurs twice"},
      {xyz + "DATA ascii\n", "line 4: there is neither POINTS nor WIDTH and HEIGHT"},
      {xyz + "WIDTH 2\nDATA ascii\n", "line 5: there is neither POINTS nor WIDTH and HEIGHT"},
      {xyz + "HEIGHT 2\nDATA ascii\n", "line 5: there is neither POINTS nor WIDTH and HEIGHT"},
      {xyz + "WIDTH 3\nHEIGHT 2\nPOINTS 5\nDATA ascii\n",
       "line 7: POINTS is 5, but WIDTH times HEIGHT is 6"},
      {XYZ + "DATA binary\n" + bytesOf<float>({1, 2, 3, 4, 5}),
       "it should have 2 points, but ends after 1 (truncated?)"},
      {xyz + "POINTS 3999999999\nDATA binary\n1234",
       "it should have 3999999999 points, but ends after 0 (truncated?)"},
      {XYZ + "DATA ascii\n1 2 3\n", "it should have 2 points, but ends after 1 (truncated?)"},
      {XYZ + "DATA ascii\n1 2\n4 5 6\n", "line 12: 2 values, but the fields have 3"},
      {XYZ + "DATA ascii\n1 2 3 4\n4 5 6\n", "line 12: 4 values, but the fields have 3"},
      {XYZ + "DATA ascii\n1 2 3\n4 5 6\n\n7 8 9\n",
       "line 15: there are more points than POINTS says"},
      {XYZ + "DATA ascii\n1 2 3x\n4 5 6\n", "line 12: '3x' is not a number"},
      {XYZ + "DATA ascii\n1 2 3\n4 " + x20 + "x 6\n", "line 13: '" + x20 + "' is not a number"},
  };
  for (const auto& [file, words] : cases) EXPECT_EQ(refusal(file), words) << file;
}

TEST(PcdFile, OfWidthHeightAndPointsTwoAreEnough) {
  const std::string xyz = "COLUMNS x y z\nSIZE 4 4 4\nTYPE F F F\n",
                    data = "DATA ascii\n1 2 3\n4 5 6\n";
  for (const char* size : {"POINTS 2\n", "WIDTH 1\nHEIGHT 2\n", "WIDTH 2\nPOINTS 2\n",
                           "HEIGHT 7\nPOINTS 2\n", "WIDTH 2\nHEIGHT 1\nPOINTS 2\n"}) {
    EXPECT_EQ(readPcd(xyz + size + data).size(), 2u) << size;
  }
}

TEST(PcdFile, AFieldIsAMegabyteOrAMillionValuesAtMost) {
  const auto withField = [](const std::string& size, const std::string& count) {
    return "FIELDS x y z a\nSIZE 4 4 4 " + size + "\nTYPE F F F I\nCOUNT 1 1 1 " + count +
           "\nPOINTS 0\nDATA binary\n";
  };
  EXPECT_TRUE(readPcd(withField("1048576", "1048576")).empty());
  EXPECT_EQ(refusal(withField("1048577", "1")), "line 6: field 'a' is too large");
  EXPECT_EQ(refusal(withField("1", "1048577")), "line 6: field 'a' is too large");
}

/// A byte and copies of it: three bytes for each 264.
TEST(PcdFile, NoByteOfCompressedDataBecomesMoreThan88) {
  constexpr std::size_t NB_COPIES = 1000, NB_POINTS = 22 * NB_COPIES;
  std::string most = std::string("\x17") + std::string(24, '\0');  // 24 bytes: two points
  for (std::size_t i = 0; i < NB_COPIES; ++i) most += std::string("\xe0\xff\x00", 3);
  const auto file = [&](std::size_t nb_points) {
    const auto sizes = bytesOf<std::uint32_t>(
        {static_cast<std::uint32_t>(most.size()), static_cast<std::uint32_t>(12 * nb_points)});
    return "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS " + std::to_string(nb_points) +
           "\nDATA binary_compressed\n" + sizes + most;
  };
  EXPECT_EQ(readPcd(file(NB_POINTS + 2)).size(), NB_POINTS + 2);
  const std::size_t first_refused = (most.size() + 1) * 88 / 12;
  EXPECT_THAT(refusal(file(first_refused - 1)), testing::HasSubstr("end too early"));
  EXPECT_THAT(refusal(file(first_refused + 1)),
              testing::HasSubstr("too short for what they claim"));
}

}  // namespace collision_pairs::test_pcd_file
