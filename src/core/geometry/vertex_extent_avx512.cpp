// 8 lanes. Compiled for AVX-512; entered only where the machine has it.
#include "vertex_extent_loop.h"

namespace collision_pairs {

typedef double EightDoubles __attribute__((vector_size(64)));

extern const ExtentLoop EXTENT_AVX512;
const ExtentLoop EXTENT_AVX512 = &extentLoop<EightDoubles, 8>;

}  // namespace collision_pairs
