// The instruction sets for which inner loops are compiled, besides the base target.
#pragma once

#include <cstdlib>
#include <string>

namespace collision_pairs {

/// Ascending: a machine that supports one supports those before it.
enum class InstructionSet { BASE, AVX2, AVX512 };

/// The best one that both this machine and this library support, or the one set in the environment
/// (COLLISION_PAIRS_INSTRUCTION_SET: base or avx2) if that is lower. Results must not depend on it.
inline InstructionSet instructionSet() {
  const char* const given = std::getenv("COLLISION_PAIRS_INSTRUCTION_SET");
  const std::string most = given ? given : "";
  if (most == "base") return InstructionSet::BASE;
#ifdef COLLISION_PAIRS_X86_KERNELS
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi");
  // VBMI2 is not used. It distinguishes Ice Lake, Zen 4 and later from the first processors with
  // AVX-512, which reduce their clock rate while they use it.
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vbmi2") &&
                      __builtin_cpu_supports("popcnt");
  if (avx2) return avx512 && most != "avx2" ? InstructionSet::AVX512 : InstructionSet::AVX2;
#endif
  return InstructionSet::BASE;
}

}  // namespace collision_pairs
