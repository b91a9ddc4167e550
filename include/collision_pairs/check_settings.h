// What a check of one state is to find out, and at which cost.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "collision_pairs/collision_report.h"
#include "collision_pairs/fidelity.h"
#include "collision_pairs/pair_selection.h"
#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

/// "May the pair of models `first` < `second` be left out?"
using MayIgnore = std::function<bool(std::uint32_t first, std::uint32_t second)>;
/// "May the check end with this contact?"
using IsEnough = std::function<bool(const Contact& contact)>;

struct CheckSettings {
  /// Metres, >= 0. Pairs up to this far apart are reported as near. 0: contacts only. Larger
  /// values cost more: boxes are compared at this distance, and distances computed up to it.
  double alarm_distance = 0.05;
  /// The geometry that decides. The first check at SPHERES prepares each mesh: 0.1 to 0.3 s of one
  /// core.
  Fidelity fidelity = Fidelity::MESH;
  /// How pairs of moving boxes are found. The report is the same. A BatchCheck, which looks at
  /// eight states at a time, asks it only for those that are checked one by one.
  BroadPhase broad_phase = BroadPhase::AUTO;
  /// Metres, >= 0. The search for a distance may end as soon as its certified interval is no wider.
  /// The lower end is reported, with Certainty::TOLERATED. Larger values cost less. Contacts and
  /// depths are not affected. Pairs up to this much further apart than the alarm distance may be
  /// reported as near; none within the alarm distance is missed. Distances to clouds are exact.
  double tolerance = 0.0;
  /// Compute the smallest distance of all pairs even if it is beyond the alarm distance.
  bool min_distance = false;
  /// Compute only the verdict: the check ends at the first certain contact, which is then the only
  /// one in the report, without points and depth (its distance is 0). The alarm distance counts as
  /// 0.
  bool verdict_only = false;
  /// Ends the check at this number of contacts: of pairs of elements in CONTACT, each of which has
  /// one, whatever is near or UNRESOLVED besides. 0: no limit. CollisionReport::ended_early then
  /// says what the report is worth. Contacts come in the order of CollisionReport::candidates,
  /// those of clouds last, or under a time budget the likely ones first.
  std::uint32_t max_contacts = 0;
  /// Is shown each such contact when it is found, and ends the check if it returns true. So a
  /// caller that wants at most n contacts for a pair of models, and m in all, counts those that it
  /// keeps. What it throws ends the check, whose report is then UNKNOWN. A BatchCheck asks from
  /// several threads at a time. Both are without effect with verdict_only.
  IsEnough is_enough;
  /// Seconds, >= 0, for the whole check; 0: no limit. Boxes are always rebuilt, swept and compared.
  /// Then the pairs most likely to be in contact climb the ladder of fidelities until the time is
  /// spent; a query in progress is finished. The remaining pairs are reported as UNRESOLVED, with
  /// their lower bound and the rung that gave it, so no pair is dropped.
  double time_budget = 0.0;
  /// Fill in CollisionReport::boxes, for drawing them, and with verdict_only also all candidates.
  /// Costs the tight box of every mesh, about 50 ns each, most of which are not needed otherwise.
  bool list_boxes = false;
  /// Fill in CollisionReport::times. Reading the clock six times takes about 0.15 µs, a tenth of a
  /// small robot's check.
  bool stage_times = false;
  /// The pairs that the check is limited to, of the same scene. Null: all that the scene allows.
  std::shared_ptr<const PairSelection> selection;
  /// Leaves out pairs for which it returns true, and lists them in CollisionReport::ignored: an
  /// allowed collision matrix that changes from check to check. Asked only about pairs whose boxes,
  /// with verdict_only looser ones, are within the alarm distance, or the smallest distance found
  /// so far if that is searched for, and where none of them is kept, about others until one is;
  /// once per check. The time budget does not limit its time. What it throws ends the check, whose
  /// report is then UNKNOWN. A BatchCheck asks from several threads at a time. Cost: 10 ns a pair,
  /// and what it takes itself; none if it is empty.
  MayIgnore may_ignore;
  /// Which list of pairs may_ignore answers from: the caller's number for what is in it, since the
  /// detector looks at no address. With the number of the check before, not 0, answers are kept and
  /// it is asked about no pair again; give another whenever any answer changes. 0: asked anew.
  std::uint64_t ignore_revision = 0;
};

}  // namespace collision_pairs
