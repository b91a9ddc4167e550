// 8 lanes. Compiled for AVX2; called only if the machine supports it.
#include <immintrin.h>

#include "sweep_kernel_loops.h"

namespace collision_pairs {
namespace {

/// For each set of lanes, the permutation that moves the lanes of the set to the front, in order.
struct Compressions {
  alignas(64) std::uint8_t lane[256][8] = {};
  constexpr Compressions() {
    for (int set = 0; set < 256; ++set) {
      int count = 0;
      for (std::uint8_t i = 0; i < 8; ++i) {
        if (set >> i & 1) lane[set][count++] = i;
      }
    }
  }
};
constexpr Compressions COMPRESSIONS;

struct Avx2Lanes {
  static constexpr std::size_t COUNT = 8;
  using Floats = __m256;
  using Ints = __m256i;
  using Mask = __m256;

  static Ints loadInts(const std::uint32_t* p) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
  }
  static Floats setFloat(float x) { return _mm256_set1_ps(x); }
  static Ints setInt(std::uint32_t x) { return _mm256_set1_epi32(static_cast<int>(x)); }
  static Floats add(Floats a, const float* b) { return _mm256_add_ps(a, _mm256_loadu_ps(b)); }
  static Floats larger(Floats a, Floats b) { return _mm256_max_ps(a, b); }
  static Mask notPositive(Floats a) { return _mm256_cmp_ps(a, _mm256_setzero_ps(), _CMP_LE_OQ); }
  static Mask negative(Floats a) { return _mm256_cmp_ps(a, _mm256_setzero_ps(), _CMP_LT_OQ); }
  static Mask both(Mask a, Mask b) { return _mm256_and_ps(a, b); }
  static Mask noCommonBits(Ints a, const std::uint32_t* b) {
    const Ints common = _mm256_and_si256(a, loadInts(b));
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(common, _mm256_setzero_si256()));
  }
  static Mask differ(Ints a, const std::uint32_t* b) {
    const Ints same = _mm256_cmpeq_epi32(a, loadInts(b));
    return _mm256_castsi256_ps(_mm256_xor_si256(same, _mm256_set1_epi32(-1)));
  }
  static std::uint32_t bits(Mask m) { return static_cast<std::uint32_t>(_mm256_movemask_ps(m)); }

  // Compresses by a table: the end of a loop over the set lanes would be mispredicted mostly.
  static std::size_t append(Mask closed, Mask open, std::uint32_t id, const std::uint32_t* tags,
                            std::uint32_t unsure, std::uint32_t* first, std::uint32_t* second) {
    const std::uint32_t set = bits(closed);
    const Ints ids = _mm256_and_si256(loadInts(tags), setInt(ID_MASK));
    const Ints mark = _mm256_andnot_si256(_mm256_castps_si256(open), setInt(UNSURE));
    const Ints all = _mm256_or_si256(_mm256_or_si256(ids, mark), setInt(unsure));
    const Ints lanes = _mm256_cvtepu8_epi32(
        _mm_loadl_epi64(reinterpret_cast<const __m128i*>(COMPRESSIONS.lane[set])));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(first), setInt(id));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(second),
                        _mm256_permutevar8x32_epi32(all, lanes));
    return static_cast<std::size_t>(__builtin_popcount(set));
  }
};

}  // namespace

extern const SweepKernel AVX2_KERNEL;
const SweepKernel AVX2_KERNEL = makeKernel<Avx2Lanes>("avx2", 160);

}  // namespace collision_pairs
