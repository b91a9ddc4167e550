// The innermost loops over points and oriented boxes, for each instruction set, and the choice
// among them at run time.
#pragma once

#include <vector>

namespace collision_pairs {

constexpr int POINT_LANES = 8;  // two registers of the widest instruction set, for all of them
constexpr int BOX_LANES = 4;

/// Points as structure of arrays.
struct alignas(POINT_LANES * sizeof(double)) PointBlock {
  double xyz[3][POINT_LANES];
};

/// Four oriented boxes as structure of arrays; of a matrix, column by column.
struct alignas(BOX_LANES * sizeof(double)) BoxBlock {
  double R[9][BOX_LANES];
  double center[3][BOX_LANES];
  double half[3][BOX_LANES];
};

/// One instruction set's code. Counts of blocks are at least 1.
struct GeometryKernel {
  const char* name;

  /// Index of the point furthest along `direction`, the first if there are several; writes its
  /// coordinate along it.
  unsigned long (*furthest_point)(const PointBlock* blocks, unsigned long count,
                                  const double* direction, double* height);
  /// The smallest and largest coordinates of R p; R is column-major.
  void (*extent)(const PointBlock* blocks, unsigned long count, const double* R, double* lower,
                 double* upper);

  /// Squared gaps of the block's boxes to a box, to the box in a lane of another block moved by X
  /// (4 by 4, column-major), and to a point; see squaredBoxGaps().
  void (*box_gaps)(const BoxBlock& block, const double* R, const double* center, const double* half,
                   double* squared);
  void (*moved_box_gaps)(const BoxBlock& block, const BoxBlock& other, int lane, const double* X,
                         double* squared);
  void (*point_gaps)(const BoxBlock& block, const double* point, double* squared);
};

/// The kernels that this machine can run, the fastest first.
const std::vector<GeometryKernel>& geometryKernels();

}  // namespace collision_pairs
