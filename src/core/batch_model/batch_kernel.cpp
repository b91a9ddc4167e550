// The kernel that runs on every machine, and the choice among all kernels.
#include "batch_kernel.h"

#include "batch_kernel_loops.h"
#include "instruction_set.h"

namespace collision_pairs {
namespace {

struct FourLanes {
  typedef float Floats __attribute__((vector_size(16)));
  typedef int Ints __attribute__((vector_size(16)));
  static constexpr int LANES = 4;
  static unsigned bits(const Ints& mask) {
    return (mask[0] & 1u) | (mask[1] & 2u) | (mask[2] & 4u) | (mask[3] & 8u);
  }
};

}  // namespace

#ifdef COLLISION_PAIRS_X86_KERNELS
extern const BatchKernel BATCH_AVX2;
extern const BatchKernel BATCH_AVX512;
#endif

const std::vector<BatchKernel>& batchKernels() {
  static const std::vector<BatchKernel> KERNELS = [] {
    std::vector<BatchKernel> kernels;
#ifdef COLLISION_PAIRS_X86_KERNELS
    const InstructionSet best = instructionSet();
    if (best >= InstructionSet::AVX512) kernels.push_back(BATCH_AVX512);
    if (best >= InstructionSet::AVX2) kernels.push_back(BATCH_AVX2);
#endif
    kernels.push_back(BatchLoops<FourLanes>::kernel("four lanes"));
    return kernels;
  }();
  return KERNELS;
}

}  // namespace collision_pairs
