// The kernel that runs on every machine, and the choice among all kernels.
#include "geometry_kernel.h"

#include "geometry_kernel_loops.h"
#include "instruction_set.h"

namespace collision_pairs {

#ifdef COLLISION_PAIRS_X86_KERNELS
extern const GeometryKernel GEOMETRY_AVX2;
extern const decltype(GeometryKernel::extent) EXTENT_AVX512;
#endif

const std::vector<GeometryKernel>& geometryKernels() {
  typedef double TwoDoubles __attribute__((vector_size(16)));
  typedef long long TwoIntegers __attribute__((vector_size(16)));
  static const std::vector<GeometryKernel> KERNELS = [] {
    std::vector<GeometryKernel> kernels;
#ifdef COLLISION_PAIRS_X86_KERNELS
    const InstructionSet best = instructionSet();
    if (best >= InstructionSet::AVX512) {  // only the extent gains from more than four lanes
      kernels.push_back(GEOMETRY_AVX2);
      kernels.back().name = "avx512";
      kernels.back().extent = EXTENT_AVX512;
    }
    if (best >= InstructionSet::AVX2) kernels.push_back(GEOMETRY_AVX2);
#endif
    kernels.push_back(geometryKernel<TwoDoubles, TwoIntegers, 2>("two lanes"));
    return kernels;
  }();
  return KERNELS;
}

}  // namespace collision_pairs
