// 16 lanes. Compiled for AVX-512; called only if the machine supports it.
#include <immintrin.h>

#include "sweep_kernel_loops.h"

namespace collision_pairs {
namespace {

struct Avx512Lanes {
  static constexpr std::size_t COUNT = 16;
  using Floats = __m512;
  using Ints = __m512i;
  using Mask = __mmask16;

  static Floats setFloat(float x) { return _mm512_set1_ps(x); }
  static Ints setInt(std::uint32_t x) { return _mm512_set1_epi32(static_cast<int>(x)); }
  static Floats add(Floats a, const float* b) { return _mm512_add_ps(a, _mm512_loadu_ps(b)); }
  static Floats larger(Floats a, Floats b) { return _mm512_max_ps(a, b); }
  static Mask notPositive(Floats a) {
    return _mm512_cmp_ps_mask(a, _mm512_setzero_ps(), _CMP_LE_OQ);
  }
  static Mask negative(Floats a) { return _mm512_cmp_ps_mask(a, _mm512_setzero_ps(), _CMP_LT_OQ); }
  static Mask both(Mask a, Mask b) { return static_cast<Mask>(a & b); }
  static Mask noCommonBits(Ints a, const std::uint32_t* b) {
    return _mm512_testn_epi32_mask(a, _mm512_loadu_si512(b));
  }
  static Mask differ(Ints a, const std::uint32_t* b) {
    return _mm512_cmpneq_epi32_mask(a, _mm512_loadu_si512(b));
  }
  static std::uint32_t bits(Mask m) { return m; }

  // Compresses in registers: compressing into memory is slow on some processors.
  static std::size_t append(Mask closed, Mask open, std::uint32_t id, const std::uint32_t* tags,
                            std::uint32_t unsure, std::uint32_t* first, std::uint32_t* second) {
    const Ints ids = _mm512_and_si512(_mm512_loadu_si512(tags), setInt(ID_MASK));
    const Mask not_sure = static_cast<Mask>(~open);
    const Ints mark = _mm512_mask_mov_epi32(setInt(unsure), not_sure, setInt(UNSURE));
    _mm512_storeu_si512(first, setInt(id));
    _mm512_storeu_si512(second, _mm512_maskz_compress_epi32(closed, _mm512_or_si512(ids, mark)));
    return static_cast<std::size_t>(__builtin_popcount(closed));
  }
};

}  // namespace

extern const SweepKernel AVX512_KERNEL;
const SweepKernel AVX512_KERNEL = makeKernel<Avx512Lanes>("avx512", 160);

}  // namespace collision_pairs
