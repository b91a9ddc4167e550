// 4 lanes. Compiled for AVX2 and FMA; entered only where the machine has them.
#include "furthest_point_loop.h"

namespace collision_pairs {

typedef double FourDoubles __attribute__((vector_size(32)));
typedef long long FourIntegers __attribute__((vector_size(32)));

extern const FurthestPointLoop FURTHEST_POINT_AVX2;
const FurthestPointLoop FURTHEST_POINT_AVX2 = &furthestPointLoop<FourDoubles, FourIntegers, 4>;

}  // namespace collision_pairs
