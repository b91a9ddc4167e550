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
                  ///< nothing is checked, or the input is in doubt (BodyPoses::doubts)
};

/// The rule that every verdict follows: a contact is certain whatever else is in doubt, and only
/// what is not in doubt is free.
constexpr Verdict verdictOf(bool is_in_contact, bool is_in_doubt) {
  if (is_in_contact) return Verdict::COLLISION;
  return is_in_doubt ? Verdict::UNKNOWN : Verdict::FREE;
}

}  // namespace collision_pairs
