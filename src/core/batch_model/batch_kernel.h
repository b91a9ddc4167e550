// The inner loops of the batch stage, for each instruction set, and the choice among them at run
// time: forward kinematics of several joint states at once, and tests of spheres against spheres.
// In float; batch_model.cpp derives bounds of the error.
#pragma once

#include <vector>

namespace collision_pairs {

constexpr int MOST_BATCH_LANES = 16;  // states at once, of the widest instruction set

/// A body of the robot in the frames of the batch stage: B has the origin of the body's frame, its
/// z axis is the axis of the body's joint.
struct BatchBody {
  enum Kind { STANDS, TURNS, SLIDES };
  int parent;  ///< -1: R and p are its pose in W
  int column;  ///< of the positions; -1 for STANDS
  Kind kind;
  float R[9];  ///< of B at position 0 in its parent's B, row by row
  float p[3];
};

struct BatchSphere {
  float center[3];  ///< in its body's frame B
  float radius;     ///< outer: enlarged by the error bound of the centre in W; inner: reduced by it
  int body;
  int first_child;  ///< of an outer sphere: index of its first child, the other follows; 0: a leaf
  float rank;       ///< of two outer spheres the one of higher rank is divided; a leaf: the lowest
};

/// The spheres of an element: a tree of outer ones, a list of inner ones.
struct BatchTree {
  int first_outer;  ///< the root
  int first_inner, nb_inner;
};

/// The inner spheres of a tree once more, the largest MOST_BATCH_LANES of them, for loops over
/// spheres instead of states. Entries from nb on have a radius of minus infinity.
struct alignas(64) BatchInner {
  float center[3][MOST_BATCH_LANES], radius[MOST_BATCH_LANES];
  int body, nb;
};

struct BatchPair {
  int first, second;                   ///< trees
  float outer_padding, inner_padding;  ///< rounded up and down, so that both answers are certain
  bool has_table;
  int first_root, second_root;  ///< outer spheres
  float squared_reach;          ///< of the roots: further apart, they do not overlap
};

/// What all states have in common.
struct BatchTables {
  const BatchBody* bodies;  ///< parents first
  int nb_bodies;
  const BatchSphere* spheres;
  int nb_spheres;
  const BatchTree* trees;
  const BatchInner* inner;  ///< by tree
  int nb_trees;
  const BatchPair* pairs;
  int nb_pairs;
};

/// Data of one group of states, as arrays of lanes. Lane l of a number of entry i, with n numbers
/// per entry, is at [(i n + number) lanes + l].
struct BatchLanes {
  const double* positions;  ///< one per column, rad or m; |angle| at most MOST_TURNS
  float* poses;             ///< 12 a body: R column by column, p; of B in W
  float* centers;           ///< 3 a sphere, in W
  unsigned* placed;         ///< by sphere: the group for which its centre was computed
  unsigned group;           ///< different for each group that uses these arrays
  /// Reads the table of a pair, for the lanes in which the pair may be in contact. Returns the
  /// undecided lanes; those in contact are written to `certain`.
  unsigned (*look_up)(void* tables, int pair, unsigned lanes, unsigned* certain);
  void* tables;
};

/// Lower bounds of a distance at the centres of the cells of a box in W, which are at
/// origin + (i + 0.5) size, metres.
struct BatchGrid {
  /// By cell, x fastest: a float, lower than the bound by more than the rounding of the kernels, or
  /// minus infinity where it is not known yet. As the bits of an int, which other threads may
  /// write.
  const int* apart;
  int side;  ///< cells along each side
  float origin[3], size[3], cells_a_metre[3];
};

/// A pair that spheres could not settle, and the lanes in which they could not.
struct OpenBatchPair {
  int pair;
  unsigned lanes;
};

/// Radians. Reducing larger angles would cost accuracy.
constexpr double MOST_TURNS = 1e4;

struct BatchKernel {
  const char* name;
  int lanes;

  /// Computes the poses of all bodies.
  void (*place)(const BatchTables& tables, const BatchLanes& group);
  /// Settles pairs by spheres in the given `lanes` (bits). Writes those that are neither certainly
  /// apart nor certainly in contact to `open`, and returns their number. For lanes in certain
  /// contact, `contact` is set to the pair; other entries are not written. A lane in contact is not
  /// processed further, so `open` may still contain its pairs. The result of a lane depends on its
  /// state alone.
  int (*settle)(const BatchTables& tables, const BatchLanes& group, unsigned lanes,
                OpenBatchPair* open, int* contact);
  /// The lanes in which the centre of a sphere is certainly further than `reach` (m) from what the
  /// grid is about.
  unsigned (*further)(const BatchTables& tables, const BatchLanes& group, int sphere,
                      const BatchGrid& grid, float reach);
  /// The centre of a sphere in W, of all lanes: x, then y, then z.
  const float* (*center)(const BatchTables& tables, const BatchLanes& group, int sphere);
};

/// The kernels that this machine can run, the fastest first.
const std::vector<BatchKernel>& batchKernels();

}  // namespace collision_pairs
