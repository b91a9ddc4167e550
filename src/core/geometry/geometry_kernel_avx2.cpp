// 4 lanes. Compiled for AVX2; called only if the machine supports it.
#include "geometry_kernel_loops.h"

namespace collision_pairs {

typedef double FourDoubles __attribute__((vector_size(32)));
typedef long long FourIntegers __attribute__((vector_size(32)));

extern const GeometryKernel GEOMETRY_AVX2;
const GeometryKernel GEOMETRY_AVX2 = geometryKernel<FourDoubles, FourIntegers, 4>("avx2");

}  // namespace collision_pairs
