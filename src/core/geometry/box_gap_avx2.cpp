// 4 lanes. Compiled for AVX2 and FMA; entered only where the machine has them.
#include "box_gap_loop.h"

namespace collision_pairs {

typedef double FourDoubles __attribute__((vector_size(32)));
typedef long long FourIntegers __attribute__((vector_size(32)));

extern const BoxGapLoops BOX_GAPS_AVX2;
const BoxGapLoops BOX_GAPS_AVX2 = BoxGapLoop<FourDoubles, FourIntegers, 4>::ALL;

}  // namespace collision_pairs
