// 16 lanes. Compiled for AVX-512; called only if the machine supports it.
#include <immintrin.h>

#include "batch_kernel_loops.h"

namespace collision_pairs {
namespace {

struct SixteenLanes {
  typedef float Floats __attribute__((vector_size(64)));
  typedef int Ints __attribute__((vector_size(64)));
  static constexpr int LANES = 16;
  static unsigned bits(const Ints& mask) {
    const __m512i lanes = reinterpret_cast<__m512i>(mask);
    return static_cast<unsigned>(_mm512_cmplt_epi32_mask(lanes, _mm512_setzero_si512()));
  }
};

}  // namespace

extern const BatchKernel BATCH_AVX512;
const BatchKernel BATCH_AVX512 = BatchLoops<SixteenLanes>::kernel("avx512");

}  // namespace collision_pairs
