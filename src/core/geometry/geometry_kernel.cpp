// The kernel that runs on every machine, and the choice among all kernels.
#include "geometry_kernel.h"

#include "geometry_kernel_loops.h"
#include "instruction_set.h"

namespace collision_pairs {

#ifdef COLLISION_PAIRS_X86_KERNELS
extern const GeometryKernel GEOMETRY_AVX2;
#endif

const std::vector<GeometryKernel>& geometryKernels() {
  typedef double TwoDoubles __attribute__((vector_size(16)));
  typedef long long TwoIntegers __attribute__((vector_size(16)));
  static const std::vector<GeometryKernel> KERNELS = [] {
    std::vector<GeometryKernel> kernels;
#ifdef COLLISION_PAIRS_X86_KERNELS
    if (instructionSet() >= InstructionSet::AVX2) kernels.push_back(GEOMETRY_AVX2);
#endif
    kernels.push_back(geometryKernel<TwoDoubles, TwoIntegers, 2>("two lanes"));
    return kernels;
  }();
  return KERNELS;
}

}  // namespace collision_pairs
