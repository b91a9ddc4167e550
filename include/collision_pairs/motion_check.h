// Straight motions in joint space: certified to be free between their ends, or a contact.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

struct MotionSettings {
  /// The geometry that decides.
  Fidelity fidelity = Fidelity::MESH;
  /// Metres, >= 0: FREE means that no pair comes nearer than this; for 0, that none touches.
  double clearance = 0.0;
  /// Metres, > 0. A pair that is still open where its motion is finer than this is given up, which
  /// makes the segment UNKNOWN unless a contact is found elsewhere: pairs that keep more than the
  /// clearance and this are certified. Finer costs more where something is nearly touched.
  double resolution = 1e-3;
};

/// The robot's joints go straight from one waypoint to the other: at fraction f of the segment
/// joint i stands at from[i] + f (to[i] - from[i]). Joints that turn without limits go the way the
/// numbers say, more than once around if they say so.
struct JointMotion {
  /// RobotModel::joints() long; rad or m. Joints that mimic follow their leaders, whatever stands
  /// here for them.
  std::vector<double> from, to;
};

/// Poses of bodies in their parent's frame (of roots: in W), by RobotModel::bodies(), for those
/// that do not stand where their joint's position says: joints that are left where TF has them,
/// floating and planar ones. They stand still during the motion. Empty: none.
using PlacedBodies = std::vector<std::optional<Eigen::Isometry3d>>;

struct MotionReport {
  /// FREE: certified, at no configuration of the segment is a pair in contact, nor nearer than the
  /// clearance. COLLISION: a configuration in contact was found. UNKNOWN: neither.
  Verdict verdict = Verdict::UNKNOWN;
  /// Metres. FREE: a lower bound of the smallest distance of all pairs along the segment, at least
  /// what was asked for and otherwise as good as came for free; infinite if there is no pair. Else
  /// 0.
  double clearance = 0.0;
  /// COLLISION: the fraction of the segment, 0 to 1, at which the contact was found. Else 0.
  double contact_at = 0.0;
  /// Models, first < second, sorted. COLLISION: those in contact at contact_at. UNKNOWN: those that
  /// could not be certified.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::uint32_t nb_checks = 0;   ///< configurations that were looked at
  std::uint32_t nb_queries = 0;  ///< pairs of elements whose shapes were asked, beyond their boxes
  double seconds = 0.0;          ///< that the check took
};

/// Certifies motions. Holds scratch memory only: the answer depends on (scene, motion, settings)
/// alone. One per thread; no lock is needed around the shared scene.
///
/// How. F. Schwarzer, M. Saha, J.-C. Latombe, "Adaptive dynamic collision checking for single and
/// multiple articulated robots in complex environments" (T-RO 2005): a pair whose distance is more
/// than the two can move towards each other is free for so long; what is left of its way is cut at
/// its middle. What is different here: each pair has its own way left, so that one pair that is
/// near does not make others be looked at again; the way is covered from the inside, from the
/// middle as far as the bound reaches; where a plane lies between the two, only motion along its
/// normal counts, to first order exactly and to second order bounded (S. Redon, M. C. Lin, D.
/// Manocha, Y. J. Kim, "Fast continuous collision detection for articulated models", 2005, bound
/// motion along a normal to first order). The part that may hold a contact soonest comes first.
///
/// Cost (docs/motions.md): a free segment of 0.5 to 2 rad takes 1 to 20 configurations in the
/// median, the more the nearer something is passed; at each only the pairs that are still open are
/// measured.
class MotionCheck {
 public:
  explicit MotionCheck(std::shared_ptr<const CollisionScene> scene);
  ~MotionCheck();
  MotionCheck(MotionCheck&&) noexcept;
  MotionCheck& operator=(MotionCheck&&) noexcept;

  /// Valid until the next call. Throws InputError for settings out of their range, for positions
  /// that are not finite or not one a joint, and where a link is too far away for a finite box.
  /// `voxels`: what its clouds show. Of a cloud that shows nothing known, or only a part, no pair
  /// is certified.
  const MotionReport& check(const JointMotion& motion, const MotionSettings& settings,
                            const PlacedBodies& placed = {}, const CloudVoxels& voxels = {});

  const CollisionScene& scene() const { return *scene_; }

 private:
  class Search;
  std::shared_ptr<const CollisionScene> scene_;
  std::unique_ptr<Search> search_;
};

struct SegmentOptions {
  unsigned threads = 0;  ///< 0: as many as the machine has; the reports are the same
  PlacedBodies placed;
  CloudVoxels voxels;
  /// Called when one more segment is done, by one thread at a time. May be empty.
  std::function<void(std::size_t nb_done)> done;
};

/// The segments between neighbouring waypoints, which are states as JointMotion has them: report i
/// is that of the segment from waypoint i to waypoint i + 1. Throws as MotionCheck::check() does,
/// with the number of the segment.
std::vector<MotionReport> checkSegments(const std::shared_ptr<const CollisionScene>& scene,
                                        const std::vector<std::vector<double>>& waypoints,
                                        const MotionSettings& settings,
                                        const SegmentOptions& options = {});

}  // namespace collision_pairs
