// The inner loops of the batch stage, for each instruction set, and the choice among them at run
// time: forward kinematics of several joint states at once, and spheres against spheres. In float;
// docs/batch.md derives by how much that may be off.
#pragma once

#include <vector>

namespace collision_pairs {

constexpr int MOST_BATCH_LANES = 16;  // states at once, of the widest processors

/// A body of the robot in the frames of the batch stage: B has the origin of the body's frame, its
/// z axis is the axis of the body's joint.
struct BatchBody {
  enum Kind { STANDS, TURNS, SLIDES };
  int parent;  ///< -1: R and p are its pose in W
  int column;  ///< of the positions; unless it stands
  Kind kind;
  float R[9];  ///< of B at position 0 in its parent's B, row by row
  float p[3];
};

struct BatchSphere {
  float center[3];  ///< in its body's frame B
  float radius;     ///< outer: grown by what the centre in W may be off; inner: shrunk
  int body;
  int first_child;  ///< of an outer one, among all spheres, with the next one; 0: it has none
  float rank;       ///< of two outer spheres the one of higher rank is divided first
};

/// The spheres of an element: a tree of outer ones, a list of inner ones.
struct BatchTree {
  int first_outer;  ///< the root
  int first_inner, nb_inner;
};

struct BatchPair {
  int first, second;                   ///< trees
  float outer_padding, inner_padding;  ///< rounded so that nothing is missed, and nothing invented
  bool has_table;
};

/// What does not change from state to state.
struct BatchTables {
  const BatchBody* bodies;  ///< parents first
  int nb_bodies;
  const BatchSphere* spheres;
  int nb_spheres;
  const BatchTree* trees;
  const BatchPair* pairs;
  int nb_pairs;
};

/// Of one group of states; arrays of lanes. Lane l of entry i of an array with n numbers an entry:
/// [(i n + number) lanes + l].
struct BatchLanes {
  const double* positions;  ///< one a column, rad or m; |turns| at most MOST_TURNS
  float* poses;             ///< 12 a body: R column by column, p; of B in W
  float* centers;           ///< 3 a sphere, in W
  unsigned* placed;         ///< a sphere: the group that its centre is of
  unsigned group;           ///< not that of any other call with these arrays
  /// Of the lanes that a pair with a table may meet in: those that the table does not know to be
  /// apart; those known to be in contact are written to `certain`.
  unsigned (*look_up)(void* tables, int pair, unsigned lanes, unsigned* certain);
  void* tables;
};

/// A pair that spheres could not settle, and in which lanes.
struct OpenBatchPair {
  int pair;
  unsigned lanes;
};

/// Radians: beyond, reducing the angle would cost accuracy.
constexpr double MOST_TURNS = 1e4;

struct BatchKernel {
  const char* name;
  int lanes;

  /// Places all bodies.
  void (*place)(const BatchTables& tables, const BatchLanes& group);
  /// Of the `lanes` (bits): settles pairs by spheres. Writes to `open` those that are neither
  /// certain to be apart nor certain to be in contact, and returns how many; `contact` is given,
  /// for lanes in certain contact, the pair (others are left alone). A lane in contact is not
  /// looked at further, so its pairs may be left in `open`. The result of a lane depends on its
  /// state alone.
  int (*settle)(const BatchTables& tables, const BatchLanes& group, unsigned lanes,
                OpenBatchPair* open, int* contact);
  /// The centre of a sphere in W, of all lanes: x, then y, then z.
  const float* (*center)(const BatchTables& tables, const BatchLanes& group, int sphere);
};

/// What this machine can run, the best one first.
const std::vector<BatchKernel>& batchKernels();

}  // namespace collision_pairs
