// Certifies straight motions in joint space as free, or finds a contact.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// What a pair of models (first < second) keeps: metres, no more than MotionSettings::clearance.
/// Negative: the pair is left out, also where it touches; FREE says nothing of it, and is not said
/// if every pair is left out (but for SceneSettings::allow_empty_scene).
using ClearanceOf = std::function<double(std::uint32_t first, std::uint32_t second)>;

struct MotionSettings {
  /// The geometry that decides.
  Fidelity fidelity = Fidelity::MESH;
  /// Metres, >= 0: FREE means that no pair comes closer than this; for 0, that none touches.
  double clearance = 0.0;
  /// Of pairs that may come nearer, or are left out; empty: none. It is asked several times about a
  /// pair, by checkSegments() and planners from several threads, and may depend on the pair alone.
  ClearanceOf clearance_of = {};
  /// Metres, > 0. A pair that is still open when its motion is split finer than this is given up,
  /// which makes the segment UNKNOWN unless a contact is found elsewhere. Pairs that stay further
  /// apart than clearance + resolution are certified. Finer values cost more near contacts.
  double resolution = 1e-3;
  /// Also certify the part before a contact or a near miss, for MotionReport::free_until. Costs
  /// nothing if the motion is free; a motion in contact takes longer, since its search does not end
  /// at the first contact.
  bool from_start = false;
  /// Only FREE is of interest: the search ends at the first pair that cannot be certified. The
  /// verdict is then UNKNOWN although a contact might have been found, free_until is 0, and
  /// MotionReport::clearance is that of these settings, 0 with clearance_of. Many such motions are
  /// settled by the batch stage: see MotionCheck.
  bool only_free = false;
  /// Leave out pairs whose relative pose the motion cannot change, for example a base that stands
  /// on its table. FREE then says nothing of them, and is not said if no other pair is left.
  bool only_moved = false;
  /// Seconds, >= 0, for the search; 0: no limit but one of about a second. When they are over, what
  /// is still open is given up as at the resolution; a query in progress is finished.
  double time_budget = 0.0;
};

/// A straight line in joint space: at fraction f of the segment joint i is at
/// from[i] + f (to[i] - from[i]). Continuous joints follow the numbers, over several turns if the
/// numbers say so.
struct JointMotion {
  /// One entry per RobotModel::joints(); rad or m. Entries of mimic joints are ignored; these
  /// follow their leaders.
  std::vector<double> from, to;
  /// One entry per joint, rad or m, >= 0, or empty for none: at every fraction each joint may be
  /// this far from its place on the line, independently of the others, but for mimic joints: they
  /// follow their leaders, whatever their entries are. FREE then holds for all these
  /// configurations.
  std::vector<double> deviation = {};
};

/// Poses of bodies in the frame of their parent body (of roots: in W), indexed as
/// RobotModel::bodies(), for bodies whose pose is not given by a joint position: floating and
/// planar joints, and joints left where TF has them. They do not move during the motion. Empty:
/// none.
using PlacedBodies = std::vector<std::optional<Eigen::Isometry3d>>;

struct MotionReport {
  /// FREE: certified; at no configuration of the segment is a pair in contact or closer than the
  /// clearance. COLLISION: a configuration in contact was found. UNKNOWN: neither, or nothing is
  /// checked. A deviation makes COLLISION rarer: it is said of the line alone.
  Verdict verdict = Verdict::UNKNOWN;
  /// Metres. FREE: a lower bound of the smallest distance of all pairs along the segment: at least
  /// the requested clearance, and more if that was found without extra work; infinite if there is
  /// no pair, which SceneSettings::allow_empty_scene permits. Otherwise 0.
  double clearance = 0.0;
  /// COLLISION: the fraction of the segment, 0 to 1, at which a contact was found. Otherwise 0.
  double contact_at = 0.0;
  /// How far from its start the segment is certified with the requested clearance: no configuration
  /// at a smaller fraction comes closer. 1 if FREE. With from_start it ends where a pair comes
  /// closer, or is still open at the resolution; without, COLLISION gives 0, and UNKNOWN what was
  /// certified without extra work. 0 where nothing is checked.
  double free_until = 0.0;
  /// Ids of models, first < second, sorted. COLLISION: pairs in contact at contact_at; with
  /// only_free one of them. UNKNOWN: pairs that could not be certified.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::string unchecked;  ///< CollisionScene::unchecked(), or that every pair is left out
  /// UNKNOWN: all reasons, one sentence each.
  std::vector<std::string> unknown_because;
  std::uint32_t nb_checks = 0;   ///< configurations that were checked
  std::uint32_t nb_queries = 0;  ///< queries of element pairs that needed more than their boxes
  double seconds = 0.0;          ///< duration of the check
};

/// Certifies motions. The answer depends on (scene, motion, settings) alone, but for what a time
/// budget cuts short; with only_free that is whether it is FREE. Use one per thread; the shared
/// scene needs no lock.
///
/// Method: F. Schwarzer, M. Saha, J.-C. Latombe, "Adaptive dynamic collision checking for single
/// and multiple articulated robots in complex environments" (T-RO 2005): a pair is free as long as
/// the two cannot have moved towards each other by more than their distance; the rest of the motion
/// is split at its middle. Deviations: each pair has its own remaining motion, so a pair that is
/// close does not cause others to be checked again. An interval is covered from its middle
/// outwards, as far as the bound reaches. If a plane separates the two, only motion along its
/// normal counts, exact to first order and bounded to second order (S. Redon, M. C. Lin, D.
/// Manocha, Y. J. Kim, "Fast continuous collision detection for articulated models", 2005, bound
/// motion along a normal to first order). The interval that may contain the earliest contact comes
/// first.
///
/// With only_free, no clearance, deviation, placed body, budget nor pair left out, at
/// Fidelity::MESH and a resolution of at most a millimetre, once as much has been searched as it
/// costs to prepare, the batch stage (BatchCheck) comes first: several configurations of the motion
/// at a time, by enclosing spheres that are enlarged by what moves between them, and for pairs that
/// one or two joints move, tables of these joints, in which the motion is a straight line. The
/// search has to look only at what these leave open. All checks of a scene that live share it;
/// memory: docs/motions.md.
///
/// Cost (docs/data/motions.csv): a free segment of 0.5 to 2 rad takes 1 to 20 configurations in the
/// median, more if it passes something closely; at each only the pairs that are still open are
/// measured.
class MotionCheck {
 public:
  explicit MotionCheck(std::shared_ptr<const CollisionScene> scene);
  ~MotionCheck();
  MotionCheck(MotionCheck&&) noexcept;
  MotionCheck& operator=(MotionCheck&&) noexcept;

  /// The result is valid until the next call. Throws InputError for settings out of range, for
  /// positions or deviations that are not finite or not one per joint, for poses without a
  /// rotation, for voxels that do not match their cloud, and if a link is too far away for a finite
  /// box. `voxels`: the occupied voxels of the scene's clouds. No pair with a cloud whose voxels
  /// are unknown or truncated is certified. `unknown_because`: as BodyPoses::unknown_because; with
  /// one nothing is FREE, and free_until is 0.
  const MotionReport& check(const JointMotion& motion, const MotionSettings& settings,
                            const PlacedBodies& placed = {}, const CloudVoxels& voxels = {},
                            const std::vector<std::string>& unknown_because = {});

  const CollisionScene& scene() const { return *scene_; }

 private:
  class Search;
  std::shared_ptr<const CollisionScene> scene_;
  std::unique_ptr<Search> search_;
};

struct SegmentOptions {
  unsigned threads = 0;  ///< 0: one per core; the reports do not depend on it
  PlacedBodies placed;
  CloudVoxels voxels;
  std::vector<std::string> unknown_because;
  /// Called after each segment, by one thread at a time. May be empty.
  std::function<void(std::size_t nb_done)> done;
};

/// Checks the segments between consecutive waypoints (states as in JointMotion): report i is that
/// of the segment from waypoint i to waypoint i + 1. Throws as MotionCheck::check() does, with the
/// number of the segment.
std::vector<MotionReport> checkSegments(const std::shared_ptr<const CollisionScene>& scene,
                                        const std::vector<std::vector<double>>& waypoints,
                                        const MotionSettings& settings,
                                        const SegmentOptions& options = {});

}  // namespace collision_pairs
