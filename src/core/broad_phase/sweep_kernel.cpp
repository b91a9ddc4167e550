// The kernel that runs on every machine, and the choice among all kernels.
#include "sweep_kernel.h"

#include <cstring>

#include "instruction_set.h"
#include "sweep_kernel_loops.h"

namespace collision_pairs {
namespace {

// Four lanes of whatever the compiler's base target has: SSE2 on any x86-64, NEON on arm64.
struct FourLanes {
  static constexpr std::size_t COUNT = 4;
  typedef float Floats __attribute__((vector_size(16)));
  typedef std::int32_t Ints __attribute__((vector_size(16)));
  using Mask = Ints;

  static Floats load(const float* p) {
    Floats v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  static Ints loadInts(const std::uint32_t* p) {
    Ints v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  static Floats setFloat(float x) { return Floats{x, x, x, x}; }
  static Ints setInt(std::uint32_t x) {
    const auto y = static_cast<std::int32_t>(x);
    return Ints{y, y, y, y};
  }
  static Floats add(Floats a, const float* b) { return a + load(b); }
  static Floats larger(Floats a, Floats b) { return a < b ? b : a; }
  static Mask notPositive(Floats a) { return a <= 0.0f; }
  static Mask negative(Floats a) { return a < 0.0f; }
  static Mask both(Mask a, Mask b) { return a & b; }
  static Mask noCommonBits(Ints a, const std::uint32_t* b) { return (a & loadInts(b)) == 0; }
  static Mask differ(Ints a, const std::uint32_t* b) { return a != loadInts(b); }
  static std::uint32_t bits(Mask m) {
    std::uint64_t half[2];
    std::memcpy(half, &m, sizeof half);
    const std::uint64_t two = (half[0] & 0x0000000200000001u) | (half[1] & 0x0000000800000004u);
    return static_cast<std::uint32_t>(two | two >> 32);
  }
  static std::size_t append(Mask closed, Mask open, std::uint32_t id, const std::uint32_t* tags,
                            std::uint32_t unsure, std::uint32_t* first, std::uint32_t* second) {
    const std::uint32_t is_open = bits(open);
    std::size_t count = 0;
    for (std::uint32_t rest = bits(closed); rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      first[count] = id;
      second[count++] = (tags[lane] & ID_MASK) | ((~is_open >> lane & 1u) * UNSURE) | unsure;
    }
    return count;
  }
};

const SweepKernel FOUR_LANES_KERNEL = makeKernel<FourLanes>("four lanes", 110);

}  // namespace

#ifdef COLLISION_PAIRS_X86_KERNELS
extern const SweepKernel AVX2_KERNEL;
extern const SweepKernel AVX512_KERNEL;
#endif

const std::vector<const SweepKernel*>& sweepKernels() {
  static const std::vector<const SweepKernel*> KERNELS = [] {
    std::vector<const SweepKernel*> kernels;
#ifdef COLLISION_PAIRS_X86_KERNELS
    if (instructionSet() >= InstructionSet::AVX512) kernels.push_back(&AVX512_KERNEL);
    if (instructionSet() >= InstructionSet::AVX2) kernels.push_back(&AVX2_KERNEL);
#endif
    kernels.push_back(&FOUR_LANES_KERNEL);
    return kernels;
  }();
  return KERNELS;
}

}  // namespace collision_pairs
