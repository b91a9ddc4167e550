// One check: poses in, report out.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

class PairLadder;

struct CheckSettings {
  /// Metres, >= 0. Pairs up to this far apart are reported as near. 0: contacts only. Larger
  /// costs more: the boxes are compared at this distance and distances are computed up to it.
  double alarm_distance = 0.05;
  /// The geometry that decides.
  Fidelity fidelity = Fidelity::MESH;
  /// Find the smallest distance of all pairs even where it is beyond the alarm distance.
  bool min_distance = false;
  /// Only in_collision is asked for: ends at the first contact, which is then the only pair in the
  /// report, without points and depth. The alarm distance counts as 0.
  bool verdict_only = false;
};

/// Runs the check. Holds scratch memory only: the answer depends on (scene, poses, settings)
/// alone. One per thread; no lock is needed around the shared scene. No heap allocation in boxes
/// and broad phase once warm.
///
/// detect() checks every allowed pair. The three steps of SOFA's narrow-phase component do the
/// same pair by pair, for a caller that has its own broad phase over models:
///
///   detector.beginNarrowPhase(poses, settings);
///   for (…) detector.addCollisionPair(first_model, second_model);
///   const CollisionReport& report = detector.endNarrowPhase();
class CollisionDetector {
 public:
  explicit CollisionDetector(std::shared_ptr<const CollisionScene> scene);
  ~CollisionDetector();
  CollisionDetector(CollisionDetector&&) noexcept;
  CollisionDetector& operator=(CollisionDetector&&) noexcept;

  /// Throws InputError for an alarm distance that is negative or not a number, or if `poses` does
  /// not fit the scene.
  const CollisionReport& detect(const BodyPoses& poses, const CheckSettings& settings);

  void beginNarrowPhase(const BodyPoses& poses, const CheckSettings& settings);
  /// By model id, in either order. Pairs that the scene's filter forbids stay out.
  void addCollisionPair(std::uint32_t model_a, std::uint32_t model_b);
  const CollisionReport& endNarrowPhase();

  /// The last check's, empty before the first.
  const CollisionReport& report() const { return report_; }

  /// Takes another scene from the next check on.
  void setScene(std::shared_ptr<const CollisionScene> scene);
  const CollisionScene& scene() const { return *scene_; }

  /// Forgets a begun check and gives the scratch memory back.
  void reset();

 private:
  void checkInput(const BodyPoses& poses, const CheckSettings& settings) const;
  const CollisionReport& run(const BodyPoses& poses);
  void prepareStaticElements();
  void rebuildBoxes(const BodyPoses& poses);
  /// The pairs of elements whose boxes are no further apart than `reach`, sorted.
  void sweep(double reach, std::vector<BoxPair>& candidates);
  void findFirstContact();
  void measureCandidates();
  void searchMinimum();
  void measureNearestFirst(const std::vector<BoxPair>& pairs, double& best);
  void assembleReport();

  /// The elements of `pair`, first the one of the model with the smaller id.
  BoxPair byModel(const BoxPair& pair) const;
  void record(const BoxPair& pair, const PairDistance& found, Fidelity rung);

  std::shared_ptr<const CollisionScene> scene_;
  CheckSettings settings_;
  SweepAndPrune sweep_;
  std::unique_ptr<PairLadder> ladder_;
  CollisionReport report_;
  std::vector<Eigen::Isometry3d> X_WE_;  // one an element

  BodyPoses begun_poses_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> added_pairs_;
  bool only_added_pairs_ = false;

  std::vector<PairReport> found_;        // one an element pair, until they are put together
  std::vector<Contact> found_contacts_;  // beside found_
  std::vector<std::uint32_t> order_;
  std::vector<BoxPair> reached_;
  std::vector<std::pair<double, BoxPair>> by_gap_;
};

}  // namespace collision_pairs
