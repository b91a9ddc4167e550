// Files of points: PCD, as the Point Cloud Library writes them.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace collision_pairs {

/// The points of a PCD file's bytes, in its frame; VIEWPOINT is not applied. DATA ascii, binary and
/// binary_compressed (little-endian); fields x, y and z of 4 or 8 bytes, floating point, anywhere
/// among others. Coordinates that are not finite are kept. Throws InputError that says what is
/// wrong and in which line or point, without the file's name. Cost: linear in the number of bytes,
/// whatever counts they claim.
std::vector<Eigen::Vector3d> readPcd(const std::string& bytes);

}  // namespace collision_pairs
