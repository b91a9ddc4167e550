// 4 lanes. Compiled for AVX2 and FMA; entered only where the machine has them.
#include "vertex_extent_loop.h"

namespace collision_pairs {

typedef double FourDoubles __attribute__((vector_size(32)));

extern const ExtentLoop EXTENT_AVX2;
const ExtentLoop EXTENT_AVX2 = &extentLoop<FourDoubles, 4>;

}  // namespace collision_pairs
