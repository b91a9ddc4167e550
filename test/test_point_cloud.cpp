// Points out of every layout that a sensor_msgs/PointCloud2 can have, and an error for every other.
// The oracle writes the messages byte by byte.
#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "point_cloud.h"
#include "printed.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_point_cloud {

using Eigen::Vector3d;
using Eigen::Vector3f;
using sensor_msgs::PointCloud2;
using sensor_msgs::PointField;

PointField field(const std::string& name, std::uint32_t offset, std::uint8_t datatype) {
  PointField made;
  made.name = name;
  made.offset = offset;
  made.datatype = datatype;
  made.count = 1;
  return made;
}

void put(std::uint8_t* at, const void* number, std::size_t size, bool big_endian) {
  const auto* bytes = static_cast<const std::uint8_t*>(number);  // this machine's: little-endian
  for (std::size_t i = 0; i < size; ++i) at[i] = bytes[big_endian ? size - 1 - i : i];
}

struct Layout {
  std::uint32_t width, height, point_step, row_padding;
  std::vector<PointField> fields;
  bool big_endian = false;
};

/// What no point covers is filled with a byte that makes odd numbers.
PointCloud2 cloudOf(const std::vector<Vector3d>& points, const Layout& layout) {
  PointCloud2 cloud;
  cloud.width = layout.width;
  cloud.height = layout.height;
  cloud.point_step = layout.point_step;
  cloud.row_step = layout.width * layout.point_step + layout.row_padding;
  cloud.is_bigendian = layout.big_endian;
  cloud.fields = layout.fields;
  cloud.data.assign(std::size_t{cloud.row_step} * cloud.height, 0xA5);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t at = i / layout.width * cloud.row_step + i % layout.width * layout.point_step;
    for (const PointField& f : layout.fields) {
      const int axis = f.name == "x" ? 0 : f.name == "y" ? 1 : f.name == "z" ? 2 : -1;
      if (axis < 0) continue;
      const double as_double = points[i][axis];
      const auto as_float = static_cast<float>(as_double);
      const bool is_double = f.datatype == PointField::FLOAT64;
      put(&cloud.data[at + f.offset], is_double ? static_cast<const void*>(&as_double) : &as_float,
          is_double ? 8 : 4, layout.big_endian);
    }
  }
  return cloud;
}

Layout packed(std::uint32_t width, std::uint32_t height = 1) {
  return {width,
          height,
          16,
          0,
          {field("x", 0, PointField::FLOAT32), field("y", 4, PointField::FLOAT32),
           field("z", 8, PointField::FLOAT32), field("rgb", 12, PointField::FLOAT32)}};
}

std::vector<Vector3d> read(const PointCloud2& cloud) {
  std::vector<Vector3d> points = {Vector3d::Ones()};  // of the cloud before
  readPoints(cloud, points);
  return points;
}

void expectRefused(const PointCloud2& cloud, const std::string& words) {
  EXPECT_THAT(refusal([&] { read(cloud); }), testing::HasSubstr(words));
}

const std::vector<Vector3d> SIX = {{1, 2, 3}, {-4, 5, 6},           {7, -8, 9},
                                   {0, 0, 1}, {1.0 / 1024, 2e5, 3}, {4, 5, -6}};

TEST(PointCloud, OfRandomLayoutsGivesItsPoints) {
  std::mt19937 random(givenSeed());
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  for (int i = 0; i < 2000; ++i) {
    Layout layout{1 + below(7), 1 + below(5), 0, below(2) * below(30), {}};
    layout.big_endian = below(2) == 1;
    std::vector<std::string> names = {"x", "y", "z", "intensity"};
    std::shuffle(names.begin(), names.end(), random);
    std::uint32_t offset = below(4);
    for (const std::string& name : names) {
      const bool is_double = below(3) == 0;
      layout.fields.push_back(
          field(name, offset, is_double ? PointField::FLOAT64 : PointField::FLOAT32));
      offset += (is_double ? 8 : 4) + below(2) * below(9);
    }
    layout.point_step = offset + 8;
    if (layout.height == 1) layout.row_padding %= layout.point_step;
    std::vector<Vector3d> points(layout.width * layout.height);
    for (Vector3d& p : points) p = Vector3f::Random().cast<double>();
    ASSERT_EQ(read(cloudOf(points, layout)), points) << "case " << i;
  }
}

TEST(PointCloud, OfAnySizesIsReadWithinItsDataOrRefused) {
  std::mt19937 random(givenSeed());
  const std::uint32_t sizes[] = {0, 1, 3, 11, 12, 13, 100, 1u << 16, 1u << 31, ~0u};
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  const auto spoil = [&](std::uint32_t& size) {
    if (below(10) < 3) size = sizes[below(10)];
  };
  int nb_read = 0, nb_refused = 0;
  for (int i = 0; i < 20000; ++i) {
    PointCloud2 cloud = cloudOf(SIX, packed(6));
    for (auto* size : {&cloud.width, &cloud.height, &cloud.point_step, &cloud.row_step}) {
      spoil(*size);
    }
    for (PointField& f : cloud.fields) {
      if (below(10) == 0) spoil(f.offset), spoil(f.count);
      if (below(20) == 0) f.datatype = static_cast<std::uint8_t>(random());
    }
    if (below(3) == 0) {
      std::vector<std::uint8_t> data(below(2000));  // of its own, so that a sanitizer sees its end
      for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
      cloud.data = data;
    }
    cloud.is_bigendian = below(3) == 0;
    try {
      nb_read += read(cloud).size() <= cloud.data.size();
    } catch (const InputError&) {
      ++nb_refused;
    }
  }
  EXPECT_EQ(nb_read + nb_refused, 20000);
  EXPECT_GT(nb_read, 1000);
  EXPECT_GT(nb_refused, 1000);
}

TEST(PointCloud, OfTheUsualLayoutGivesItsPointsWithAndWithoutRowPadding) {
  Layout layout = packed(3, 2);
  EXPECT_EQ(read(cloudOf(SIX, layout)), SIX);
  layout.row_padding = 20;
  PointCloud2 cloud = cloudOf(SIX, layout);
  EXPECT_EQ(read(cloud), SIX);
  cloud.data.resize(cloud.data.size() - 20);  // the last row need not be padded
  EXPECT_EQ(read(cloud), SIX);
}

TEST(PointCloud, LeavesOutPointsThatAreNotFiniteOrAtTheSensor) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const bool big_endian : {false, true}) {
    std::vector<Vector3d> points = SIX;
    points[0].x() = nan;
    points[2].y() = -infinity;
    points[5] = Vector3d::Constant(nan);
    points.push_back(Vector3d::Zero());
    points.push_back({-0.0, 0.0, -0.0});
    points.push_back({0.0, -1e-30, 0.0});
    points.push_back({0.0005, 0.0, -0.0004});
    points.push_back({0.0, -0.0011, 0.0});
    Layout layout = packed(11);
    layout.big_endian = big_endian;
    const auto found = read(cloudOf(points, layout));
    ASSERT_EQ(found.size(), 4u);
    EXPECT_EQ((std::vector<Vector3d>{found[0], found[1], found[2]}),
              (std::vector<Vector3d>{SIX[1], SIX[3], SIX[4]}));
    EXPECT_LT(found[3].y(), 0.0);
  }
}

TEST(PointCloud, WithoutPointsIsEmptyAndNoError) {
  for (const auto& [width, height] : {std::pair{0u, 1u}, {0u, 0u}, {5u, 0u}}) {
    PointCloud2 cloud = cloudOf({}, packed(width, height));
    cloud.data.clear();
    EXPECT_TRUE(read(cloud).empty());
  }
}

TEST(PointCloud, WhoseSizesLeavePointsUnreadIsRefused) {
  for (const auto& [width, height] : {std::pair{0u, 1u}, {6u, 0u}, {0u, 0u}, {0u, 6u}}) {
    PointCloud2 cloud = cloudOf(SIX, packed(6));
    cloud.width = width;
    cloud.height = height;
    expectRefused(cloud, "data has 96 bytes, but its width is " + std::to_string(width) +
                             " and its height " + std::to_string(height));
  }
  PointCloud2 cloud = cloudOf(SIX, packed(3, 2));
  cloud.height = 1;
  expectRefused(cloud, "data has 96 bytes, too many for 3 x 1 points");
  cloud.row_step = 96;
  expectRefused(cloud, "row_step is 96, but its one row of 3 points of 16 bytes takes only 48");
  cloud = cloudOf(SIX, packed(6));
  cloud.width = 5;
  cloud.row_step = 80;
  expectRefused(cloud, "data has 96 bytes, too many for 5 x 1 points");
  cloud.data.resize(95);  // less than a point
  EXPECT_EQ(read(cloud).size(), 5u);
}

TEST(PointCloud, OfDoublesIsNotNarrowed) {
  Layout layout{3, 1, 24, 0, {}};
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    layout.fields.push_back(field(std::string(1, "xyz"[axis]), 8 * axis, PointField::FLOAT64));
  }
  const std::vector<Vector3d> points = {
      {5e6 + 0.123, 4e5 - 0.01, 0.1}, {5e6 + 0.124, 1e-300, 1e300}, {-1.0 / 3.0, 0.7, 5e6}};
  for (const bool big_endian : {false, true}) {
    layout.big_endian = big_endian;
    EXPECT_EQ(read(cloudOf(points, layout)), points);
  }
}

TEST(PointCloud, WhoseCoordinatesAreWrongIsRefused) {
  const PointCloud2 sound = cloudOf(SIX, packed(6));
  PointCloud2 cloud = sound;
  cloud.fields.clear();
  expectRefused(cloud, "no field 'x' (its fields: none)");
  cloud = sound;
  cloud.fields[2].name = "depth";
  expectRefused(cloud, "no field 'z' (its fields: x, y, depth, rgb)");
  cloud = sound;
  cloud.fields[1].datatype = PointField::INT16;
  expectRefused(cloud, "field 'y' is of datatype 3");
  cloud = sound;
  cloud.fields[3].name = "y";
  expectRefused(cloud, "field 'y' occurs twice");
  cloud = sound;
  cloud.fields[1].name = "x";
  expectRefused(cloud, "field 'x' occurs twice");
  cloud = sound;
  cloud.fields[0].name = "first";
  for (int i = 0; i < 8; ++i) cloud.fields.push_back(field(std::string(1, 'a' + i), 12, 7));
  expectRefused(cloud, "(its fields: first, y, z, rgb, a, b, c, d, e, f)");
  cloud = sound;
  cloud.fields[0].count = 3;
  expectRefused(cloud, "field 'x' has count 3");
  cloud.fields[0].count = 2;
  expectRefused(cloud, "field 'x' has count 2");
  cloud.fields[0].count = 0;  // of old publishers
  EXPECT_EQ(read(cloud), SIX);
}

TEST(PointCloud, WhoseSizesDoNotFitIsRefused) {
  const PointCloud2 sound = cloudOf(SIX, packed(3, 2));
  PointCloud2 cloud = sound;
  cloud.point_step = 0;
  expectRefused(cloud, "its point_step is 0");
  cloud = sound;
  cloud.point_step = 11;
  expectRefused(cloud, "field 'z' ends 12 bytes into a point, but point_step is 11");
  cloud = sound;
  cloud.fields[1].datatype = PointField::FLOAT64;
  cloud.fields[1].offset = 9;
  expectRefused(cloud, "field 'y' ends 17 bytes into a point, but point_step is 16");
  cloud = sound;
  cloud.fields[1].offset = std::numeric_limits<std::uint32_t>::max();
  expectRefused(cloud, "field 'y' ends 4294967299 bytes");
  for (std::uint32_t offset = 5; offset < 12; ++offset) {
    cloud.fields[1].offset = offset;
    expectRefused(cloud, "fields 'y' and 'z' overlap");
  }
  for (std::uint32_t offset = 0; offset < 4; ++offset) {
    cloud.fields[1].offset = offset;
    expectRefused(cloud, "fields 'x' and 'y' overlap");
  }
  cloud = sound;
  cloud.row_step = 47;
  expectRefused(cloud, "row_step is 47, but a row of 3 points of 16 bytes takes 48");
  cloud = sound;
  cloud.data.pop_back();
  expectRefused(cloud, "data has 95 bytes, too few for 3 x 2 points");
  cloud.data.clear();
  expectRefused(cloud, "data has 0 bytes");
}

TEST(PointCloud, WhoseSizesWouldOverflowIsRefused) {
  const std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  PointCloud2 cloud = cloudOf(SIX, packed(6));
  cloud.width = most;
  expectRefused(cloud, "row_step is 96");
  cloud.row_step = most;
  expectRefused(cloud, "row_step is 4294967295, but a row");
  // 2^32 - 1 rows of 2^32 - 16 bytes: more than 64 bits hold of bits, not of bytes.
  cloud.width = most / 16;
  cloud.height = most;
  expectRefused(cloud, "too few for 268435455 x 4294967295 points");
  cloud.width = 1;
  cloud.row_step = 16;
  expectRefused(cloud, "too few for 1 x 4294967295 points");
}

TEST(PointCloud, ThatWasWrittenIsReadAsItWas) {
  std_msgs::Header header;
  header.frame_id = "camera";
  const PointCloud2 cloud = toPointCloud2(SIX, header);
  EXPECT_EQ(read(cloud), SIX);
  EXPECT_EQ(cloud.header.frame_id, "camera");
  const PointCloud2 none = toPointCloud2({}, header);
  EXPECT_TRUE(read(none).empty());
  EXPECT_EQ(
      printed(none),
      "header frame_id camera height 1 fields[0] name x datatype 7 count 1 fields[1] name y "
      "offset 4 datatype 7 count 1 fields[2] name z offset 8 datatype 7 count 1 point_step 12 "
      "is_dense 1");
  EXPECT_EQ(cloud.row_step, 6u * 12u);
}

}  // namespace collision_pairs::test_point_cloud
