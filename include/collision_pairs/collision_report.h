// The result of a check.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "collision_pairs/aabb.h"
#include "collision_pairs/fidelity.h"
#include "collision_pairs/narrow_phase.h"
#include "collision_pairs/pair_distance.h"
#include "collision_pairs/sweep_and_prune.h"
#include "collision_pairs/verdict.h"

namespace collision_pairs {

enum class PairState {
  NEAR,       ///< apart, and no further than the alarm distance
  CONTACT,    ///< touching or penetrating
  UNRESOLVED  ///< not settled; `distance` is a lower bound of the signed distance, so the two are
              ///< known to be apart if it is positive
};

/// Closest (or deepest) points of two elements, measured and expressed in the world frame W. They
/// lie on the geometry that decided, for example on boxes if the time was spent. With a tolerance
/// they are two points of the elements that are no further apart than distance + tolerance.
struct Contact {
  Eigen::Vector3d p_WFirst;   ///< on the element of the first model
  Eigen::Vector3d p_WSecond;  ///< on the element of the second model
  Eigen::Vector3d nhat_W;     ///< unit normal, from the first to the second model
  double depth;               ///< metres; minus the distance if the two are apart. An upper bound
                              ///< where the time budget ended before the two were settled
  BoxPair elements;           ///< element of the first model, element of the second
  /// If one of the two is a cloud: the cell of the voxel in contact (OccupiedVoxels), else 0.
  Eigen::Vector3i voxel = Eigen::Vector3i::Zero();
};

/// Two models, first < second by id and by name.
struct PairReport {
  std::uint32_t first;
  std::uint32_t second;
  PairState state;
  double distance;  ///< metres, signed: the smallest of all its element pairs
  Fidelity fidelity;
  Certainty certainty;
  std::uint32_t first_contact;  ///< its contacts are a range of CollisionReport::contacts,
  std::uint32_t nb_contacts;    ///< one for each pair of elements in reach; for a cloud only the
                                ///< nearest (or deepest) voxel

  /// In contact, or unresolved without a bound that shows the two apart.
  bool mayTouch() const {
    return state == PairState::CONTACT || (state == PairState::UNRESOLVED && distance <= 0.0);
  }
};

/// Seconds spent in each stage; 0 unless CheckSettings::stage_times is set.
struct StageTimes {
  double boxes = 0.0;
  double broad_phase = 0.0;
  double narrow_phase = 0.0;
  double total = 0.0;
};

/// Owned by the detector and valid until its next check; copy it to keep it.
struct CollisionReport {
  Verdict verdict = Verdict::UNKNOWN;
  bool in_collision = true;  ///< verdict != FREE
  /// UNKNOWN: all reasons, one sentence each. Otherwise, and before the first check, empty.
  std::vector<std::string> unknown_because;
  /// Smallest signed distance of all pairs that were not left out, in metres, if it is at most the
  /// alarm distance or was requested. Otherwise (`…_is_bound`) a lower bound of it: the alarm
  /// distance, or if a pair is UNRESOLVED the smallest of the lower bounds. With a tolerance it may
  /// be smaller than the true value by up to that amount.
  double min_distance = 0.0;
  bool min_distance_is_bound = true;
  /// The nearest two elements; its depth is exactly -min_distance. Empty if min_distance is a
  /// bound, and with verdict_only. Of pairs equally near: the first in the order
  /// of `contacts`, or beyond the alarm distance the first measured; the same for the same scene,
  /// poses and settings.
  std::optional<Contact> nearest;
  /// The check ended at a contact (CheckSettings::verdict_only, max_contacts, is_enough). The
  /// verdict is COLLISION. Pairs that are not in the report may not have been measured; state and
  /// distance of a pair in the report are those of its elements that were. Except with
  /// verdict_only, min_distance is the smallest distance measured, and counts as a bound.
  bool ended_early = false;
  /// Reason why this check is not conclusive: CollisionScene::unchecked(), or that the selection or
  /// may_ignore leaves no pair. Empty if it is. With a reason, what is not in collision is FREE
  /// only if SceneSettings::allow_empty_scene permits it, otherwise UNKNOWN; without pairs
  /// min_distance is then 0, a bound.
  std::string unchecked;
  double tolerance = 0.0;         ///< CheckSettings::tolerance
  std::vector<PairReport> pairs;  ///< sorted by (first, second)
  std::vector<Contact> contacts;  ///< in the order of `pairs`
  /// The investigated pairs of elements (nb_pairs of the messages), sorted: those whose boxes,
  /// SceneElement::boxAt(), are no further apart than the alarm distance. A cloud is one element
  /// with many boxes. With verdict_only, max_contacts or is_enough they are listed only if
  /// CheckSettings::list_boxes is set.
  std::vector<BoxPair> candidates;
  /// The boxes of all elements, in W; not valid() for elements without a pose and for clouds. Empty
  /// unless CheckSettings::list_boxes is set.
  std::vector<Aabb> boxes;
  /// Pairs of models, first < second, sorted, that CheckSettings::may_ignore left out: no
  /// result, not even FREE, includes them. With verdict_only also those of which only looser boxes
  /// are in reach; with max_contacts or is_enough those met until the check ended.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ignored;
  /// Models without a usable pose, and clouds whose voxels are unknown or truncated; ascending.
  std::vector<std::uint32_t> left_out;
  std::uint32_t nb_boxes = 0;  ///< moving and static boxes and voxels of this cycle
  /// Investigated pairs by the rung (Fidelity) that settled them; if the check ended early, only up
  /// to its last contact.
  std::array<std::uint32_t, 5> nb_settled = {0, 0, 0, 0, 0};
  /// Investigated pairs left UNRESOLVED by the time budget. All others are in nb_settled.
  std::uint32_t nb_unresolved = 0;
  bool budget_spent = false;      ///< the time was spent before everything was settled
  std::uint32_t nb_degraded = 0;  ///< element pairs that the first method could not settle
  NarrowPhaseMethod narrow_phase = NarrowPhaseMethod::NATIVE;  ///< the scene's
  /// With FCL: queries that were answered wholly or partly by the native narrow phase
  /// (NarrowPhase::numAnsweredNatively).
  std::uint32_t nb_answered_natively = 0;
  StageTimes times;

  /// The contact of a pair that determines its distance; null if it has none (verdict_only).
  const Contact* nearestContact(const PairReport& pair) const {
    const Contact* deepest = nullptr;
    for (std::uint32_t i = 0; i < pair.nb_contacts; ++i) {
      const Contact& contact = contacts[pair.first_contact + i];
      if (deepest == nullptr || contact.depth > deepest->depth) deepest = &contact;
    }
    return deepest;
  }
};

}  // namespace collision_pairs
