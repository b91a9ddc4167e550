#include "point_cloud.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include <boost/endian/conversion.hpp>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

using sensor_msgs::PointCloud2;
using sensor_msgs::PointField;

/// Position of a coordinate within each point.
struct Coordinate {
  std::uint32_t offset;
  bool is_double;
  std::uint32_t size() const { return is_double ? 8 : 4; }
};
using Coordinates = std::array<Coordinate, 3>;

std::string fieldNames(const PointCloud2& cloud) {
  std::string names;
  for (std::size_t i = 0; i < std::min<std::size_t>(cloud.fields.size(), 10); ++i) {
    names += (i == 0 ? "" : ", ") + cloud.fields[i].name;
  }
  return names.empty() ? "none" : names;
}

Coordinate findCoordinate(const PointCloud2& cloud, const std::string& name) {
  const auto has_name = [&](const PointField& field) { return field.name == name; };
  const auto found = std::find_if(cloud.fields.begin(), cloud.fields.end(), has_name);
  if (found == cloud.fields.end()) {
    throw InputError("it has no field '" + name + "' (its fields: " + fieldNames(cloud) + ")");
  }
  const std::string field = "its field '" + name + "' ";
  if (std::any_of(found + 1, cloud.fields.end(), has_name)) {
    throw InputError(field + "occurs twice");
  }
  const bool is_double = found->datatype == PointField::FLOAT64;
  if (!is_double && found->datatype != PointField::FLOAT32) {
    throw InputError(field + "is of datatype " + std::to_string(found->datatype) +
                     ", but must be FLOAT32 (7) or FLOAT64 (8)");
  }
  // Old publishers write 0 for 1.
  if (found->count > 1) {
    throw InputError(field + "has count " + std::to_string(found->count) + ", but must have 1");
  }
  const Coordinate coordinate{found->offset, is_double};
  if (std::uint64_t{coordinate.offset} + coordinate.size() > cloud.point_step) {
    throw InputError(field + "ends " +
                     std::to_string(std::uint64_t{coordinate.offset} + coordinate.size()) +
                     " bytes into a point, but point_step is " + std::to_string(cloud.point_step));
  }
  return coordinate;
}

std::string sizeOf(const PointCloud2& cloud) {
  return std::to_string(cloud.width) + " x " + std::to_string(cloud.height) + " points of " +
         std::to_string(cloud.point_step) + " bytes";
}

/// As many bytes as its sizes say: fewer could not be read, and in more are points that nobody
/// would see. No product or sum of these 32-bit sizes exceeds 64 bits.
void requireData(const PointCloud2& cloud) {
  const std::uint64_t available = cloud.data.size();
  const std::string has = "its data has " + std::to_string(available) + " bytes, ";
  if (cloud.width == 0 || cloud.height == 0) {
    if (available == 0) return;
    throw InputError(has + "but its width is " + std::to_string(cloud.width) + " and its height " +
                     std::to_string(cloud.height) + "; in one row the height is 1");
  }
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.row_step < row) {
    throw InputError("its row_step is " + std::to_string(cloud.row_step) + ", but a row of " +
                     std::to_string(cloud.width) + " points of " +
                     std::to_string(cloud.point_step) + " bytes takes " + std::to_string(row));
  }
  if (cloud.height == 1 && cloud.row_step - row >= cloud.point_step) {
    throw InputError("its row_step is " + std::to_string(cloud.row_step) + ", but its one row of " +
                     std::to_string(cloud.width) + " points of " +
                     std::to_string(cloud.point_step) + " bytes takes only " + std::to_string(row));
  }
  const std::uint64_t before_last = std::uint64_t{cloud.height - 1} * cloud.row_step;
  const std::string in_rows = sizeOf(cloud) + " in rows of " + std::to_string(cloud.row_step);
  if (row > available || before_last > available - row) {
    throw InputError(has + "too few for " + in_rows);
  }
  if (available - before_last >= std::uint64_t{cloud.row_step} + cloud.point_step) {
    throw InputError(has + "too many for " + in_rows);
  }
}

template <class Number, class Bits>
double numberAt(const std::uint8_t* at, bool swapped) {
  Bits bits;
  std::memcpy(&bits, at, sizeof bits);
  if (swapped) boost::endian::endian_reverse_inplace(bits);
  Number number;
  std::memcpy(&number, &bits, sizeof number);
  return number;
}

struct AnyLayout {
  Coordinates coordinates;
  bool swapped;
  Eigen::Vector3d operator()(const std::uint8_t* point) const {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
      const Coordinate& c = coordinates[axis];
      p[axis] = c.is_double ? numberAt<double, std::uint64_t>(point + c.offset, swapped)
                            : numberAt<float, std::uint32_t>(point + c.offset, swapped);
    }
    return p;
  }
};

/// Contiguous native float32 coordinates, as from nearly every camera.
struct PackedFloats {
  std::uint32_t offset;
  Eigen::Vector3d operator()(const std::uint8_t* point) const {
    Eigen::Vector3f p;
    std::memcpy(p.data(), point + offset, sizeof(float) * 3);
    return p.cast<double>();
  }
};

constexpr double NO_RETURN = 1e-3;  // m: drivers write zeros, which may be rounded on the way

/// Writes each point, but advances only if something returned: no branch to be mispredicted.
template <class Layout>
void readRows(const PointCloud2& cloud, const Layout& layout,
              std::vector<Eigen::Vector3d>& points) {
  points.resize(std::size_t{cloud.width} * cloud.height);
  Eigen::Vector3d* out = points.data();
  for (std::uint32_t row = 0; row < cloud.height; ++row) {
    const std::uint8_t* point = cloud.data.data() + std::size_t{row} * cloud.row_step;
    for (std::uint32_t i = 0; i < cloud.width; ++i, point += cloud.point_step) {
      *out = layout(point);
      const double size = std::abs(out->x()) + std::abs(out->y()) + std::abs(out->z());
      out += (size > NO_RETURN) & (size - size == 0.0);  // NaN if one is infinite or NaN
    }
  }
  points.resize(out - points.data());
}

Coordinates coordinatesOf(const PointCloud2& cloud) {
  if (cloud.point_step == 0) throw InputError("its point_step is 0");
  const Coordinates c = {findCoordinate(cloud, "x"), findCoordinate(cloud, "y"),
                         findCoordinate(cloud, "z")};
  for (int axis = 0; axis < 3; ++axis) {
    const Coordinate &a = c[axis], &b = c[(axis + 1) % 3];
    if (a.offset + a.size() <= b.offset || b.offset + b.size() <= a.offset) continue;
    throw InputError(std::string("its fields '") + "xyz"[axis] + "' and '" + "xyz"[(axis + 1) % 3] +
                     "' overlap");
  }
  requireData(cloud);
  return c;
}

}  // namespace

void requireReadable(const PointCloud2& cloud) { coordinatesOf(cloud); }

void readPoints(const PointCloud2& cloud, std::vector<Eigen::Vector3d>& points) {
  points.clear();
  const Coordinates c = coordinatesOf(cloud);
  if (cloud.width == 0 || cloud.height == 0) return;
  const bool is_native =
      (boost::endian::order::native == boost::endian::order::big) == (cloud.is_bigendian != 0);
  const bool is_packed = !c[0].is_double && !c[1].is_double && !c[2].is_double &&
                         c[1].offset == c[0].offset + 4 && c[2].offset == c[0].offset + 8;
  if (is_native && is_packed) {
    readRows(cloud, PackedFloats{c[0].offset}, points);
  } else {
    readRows(cloud, AnyLayout{c, !is_native}, points);
  }
}

PointCloud2 toPointCloud2(const std::vector<Eigen::Vector3d>& points,
                          const std_msgs::Header& header) {
  PointCloud2 cloud;
  cloud.header = header;
  cloud.height = 1;
  cloud.is_bigendian = boost::endian::order::native == boost::endian::order::big;
  cloud.is_dense = true;
  sensor_msgs::PointCloud2Modifier layout(cloud);
  constexpr auto FLOAT = PointField::FLOAT32;
  layout.setPointCloud2Fields(3, "x", 1, FLOAT, "y", 1, FLOAT, "z", 1, FLOAT);
  layout.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f point = points[i].cast<float>();
    std::memcpy(&cloud.data[i * cloud.point_step], point.data(), cloud.point_step);
  }
  return cloud;
}

}  // namespace collision_pairs
