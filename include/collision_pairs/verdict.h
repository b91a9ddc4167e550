// Free, in collision, or unknown.
#pragma once

#include <cstdint>

namespace collision_pairs {

/// The overall result. Treat everything but FREE as a collision.
enum class Verdict : std::uint8_t {
  FREE = 0,       ///< every pair that the scene requires (at least one) was checked and is apart,
                  ///< except pairs left out by CheckSettings::selection or may_ignore
  COLLISION = 1,  ///< some pair is certainly in contact, at the requested fidelity
  UNKNOWN = 2     ///< neither: a model has no pose, a pair that may be in contact is unresolved,
                  ///< nothing is checked, or the input is suspect (BodyPoses::unknown_because)
};

/// The rule that every verdict follows: a contact is certain whatever else is suspect, and only
/// what is not suspect is free.
constexpr Verdict verdictOf(bool is_in_contact, bool is_suspect) {
  if (is_in_contact) return Verdict::COLLISION;
  return is_suspect ? Verdict::UNKNOWN : Verdict::FREE;
}

}  // namespace collision_pairs
