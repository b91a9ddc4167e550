// 8 lanes. Compiled for AVX2; called only if the machine supports it.
#include <immintrin.h>

#include "batch_kernel_loops.h"

namespace collision_pairs {
namespace {

struct EightLanes {
  typedef float Floats __attribute__((vector_size(32)));
  typedef int Ints __attribute__((vector_size(32)));
  static constexpr int LANES = 8;
  static unsigned bits(const Ints& mask) {
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
  }
};

}  // namespace

extern const BatchKernel BATCH_AVX2;
const BatchKernel BATCH_AVX2 = BatchLoops<EightLanes>::kernel("avx2");

}  // namespace collision_pairs
