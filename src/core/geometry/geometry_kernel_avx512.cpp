// 8 lanes. Compiled for AVX-512; called only if the machine supports it.
#include "geometry_kernel_loops.h"

namespace collision_pairs {

typedef double EightDoubles __attribute__((vector_size(64)));

extern const decltype(GeometryKernel::extent) EXTENT_AVX512;
const decltype(GeometryKernel::extent) EXTENT_AVX512 = &extentLoop<EightDoubles, 8>;

}  // namespace collision_pairs
