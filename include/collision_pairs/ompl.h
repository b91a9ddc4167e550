// Validity of states and motions for planners of OMPL. Header only; needs OMPL (target
// collision_pairs::ompl).
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateValidityChecker.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/joint_columns.h"
#include "collision_pairs/motion_check.h"

namespace collision_pairs {

/// What a state of a RealVectorStateSpace says about the robot of a scene.
struct OmplJoints {
  /// One joint per dimension, in its order; rad or m. None that mimics another.
  std::vector<std::string> names;
  /// Positions of all joints of the robot, for those that are not named: one entry per
  /// RobotModel::joints(). Entries of joints that mimic another are ignored. Empty:
  /// RobotModel::unnamedPositions().
  std::vector<double> positions;
  /// Of the scene's clouds. Without them no state near a cloud is valid.
  CloudVoxels voxels;
};

/// The check of single states, with its memory.
struct OmplDetector {
  explicit OmplDetector(std::shared_ptr<const CollisionScene> scene) : detector(std::move(scene)) {}

  /// At `positions`.
  const CollisionReport& check(const CheckSettings& settings, const CloudVoxels& voxels) {
    detector.scene().robot().forwardKinematics(positions, X_RB);
    detector.scene().gatherPoses(X_RB, poses);
    poses.voxels = voxels;
    return detector.detect(poses, settings);
  }

  CollisionDetector detector;
  std::vector<double> positions;  ///< of all joints of the robot; rad or m
  std::vector<Eigen::Isometry3d> X_RB;
  BodyPoses poses;
};

/// One Check (and what else `Worker` holds) for each thread that asks at the same time; the rest is
/// shared and read only.
template <class Worker>
class OmplWorkers {
 public:
  OmplWorkers(const ompl::base::SpaceInformation& space,
              std::shared_ptr<const CollisionScene> scene, OmplJoints joints)
      : scene_(std::move(scene)),
        joints_(std::move(joints)),
        columns_(joints_.names, scene_->robot()) {
    using ompl::base::RealVectorStateSpace;
    const auto* vectors = dynamic_cast<const RealVectorStateSpace*>(space.getStateSpace().get());
    if (!vectors) throw InputError("the state space is not a RealVectorStateSpace");
    if (vectors->getDimension() != columns_.size()) {
      throw InputError("the state space has " + std::to_string(vectors->getDimension()) +
                       " dimensions, but " + std::to_string(columns_.size()) + " joints are named");
    }
    if (joints_.positions.empty()) joints_.positions = scene_->robot().unnamedPositions();
    scene_->robot().requireOneEntryPerJoint(joints_.positions);
    refuseWhatIsNeverValid();
    scene_->robot().applyMimics(joints_.positions);  // columns_ sets those of named joints only
  }

  /// Throws what later answers would take for a state that is not valid: the settings, or the
  /// voxels, do not fit the scene. `ask` gets the positions of the joints that are not named.
  template <class Ask>
  void requireAnswer(const Ask& ask) {
    auto worker = std::make_unique<Worker>(scene_);
    ask(*worker, joints_.positions);
    idle_.push_back(std::move(worker));
  }

  const CollisionScene& scene() const { return *scene_; }
  const CloudVoxels& voxels() const { return joints_.voxels; }

  /// Throws InputError for a number that is not finite.
  void read(const ompl::base::State* state, std::vector<double>& positions) const {
    positions = joints_.positions;
    columns_.apply(state->as<ompl::base::RealVectorStateSpace::StateType>()->values, positions);
  }

  /// What `ask` returns for a worker of its own, or `otherwise` if it throws InputError.
  template <class Ask, class Answer>
  Answer ask(const Ask& ask, Answer otherwise) const {
    std::unique_ptr<Worker> worker;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!idle_.empty()) {
        worker = std::move(idle_.back());
        idle_.pop_back();
      }
    }
    if (!worker) worker = std::make_unique<Worker>(scene_);
    try {
      otherwise = ask(*worker);
    } catch (const InputError&) {
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(worker));
    return otherwise;
  }

 private:
  // A planner would look for a valid state until its time is over.
  void refuseWhatIsNeverValid() const {
    const RobotModel& robot = scene_->robot();
    for (const std::string& name : joints_.names) {
      for (const Joint& joint : robot.joints()) {
        if (!joint.mimic || (name != joint.name && name != "/" + joint.name)) continue;
        throw InputError("joint '" + joint.name + "' mimics '" +
                         robot.joints()[joint.mimic->joint].name + "'; name that joint alone");
      }
    }
    for (const std::string& name : columns_.notNamed()) {
      if (std::isfinite(joints_.positions[robot.findJoint(name)])) continue;
      throw InputError("joint '" + name + "' is not named, and its position is not finite");
    }
  }

  const std::shared_ptr<const CollisionScene> scene_;
  OmplJoints joints_;
  const JointColumns columns_;
  mutable std::mutex mutex_;  // guards idle_
  mutable std::vector<std::unique_ptr<Worker>> idle_;
};

/// A state is valid if its verdict is FREE: what could not be checked, or has a number that is not
/// finite, is not valid. One instance serves all threads of a planner.
class OmplStateValidityChecker : public ompl::base::StateValidityChecker {
 public:
  /// Throws InputError if the space is no RealVectorStateSpace with one dimension per joint, or for
  /// an unknown joint or one that mimics another, a joint that is not named and has no finite
  /// position, or settings or voxels that do not fit the scene. Of the settings, fidelity,
  /// tolerance, selection, may_ignore and ignore_revision count; the predicate is asked from all
  /// threads of the planner.
  OmplStateValidityChecker(const ompl::base::SpaceInformationPtr& space,
                           std::shared_ptr<const CollisionScene> scene, OmplJoints joints,
                           const CheckSettings& settings = {})
      : StateValidityChecker(space), workers_(*space, std::move(scene), std::move(joints)) {
    settings_.alarm_distance = 0.0;
    settings_.fidelity = settings.fidelity;
    settings_.tolerance = settings.tolerance;
    settings_.selection = settings.selection;
    settings_.may_ignore = settings.may_ignore;
    settings_.ignore_revision = settings.ignore_revision;
    using Specs = ompl::base::StateValidityCheckerSpecs;
    const bool is_exact = settings.tolerance == 0.0;
    specs_.clearanceComputationType = is_exact ? Specs::EXACT : Specs::BOUNDED_APPROXIMATE;
    workers_.requireAnswer([&](OmplDetector& worker, const std::vector<double>& positions) {
      worker.positions = positions;
      worker.check(settings_, workers_.voxels());
    });
  }

  bool isValid(const ompl::base::State* state) const override {
    CheckSettings settings = settings_;
    settings.verdict_only = true;
    return check(state, settings, [](const CollisionReport& report) {
             return report.verdict == Verdict::FREE ? 1.0 : 0.0;
           }) > 0.0;
  }

  /// Metres, signed: the smallest distance of all pairs; at most 0 for a state that is not valid.
  double clearance(const ompl::base::State* state) const override {
    CheckSettings settings = settings_;
    settings.min_distance = true;
    return check(state, settings, [](const CollisionReport& report) {
      return report.verdict == Verdict::FREE ? report.min_distance
                                             : std::min(report.min_distance, 0.0);
    });
  }

 private:
  template <class Answer>
  double check(const ompl::base::State* state, const CheckSettings& settings,
               const Answer& answer) const {
    return workers_.ask(
        [&](OmplDetector& worker) -> double {
          workers_.read(state, worker.positions);
          return answer(worker.check(settings, workers_.voxels()));
        },
        0.0);
  }

  OmplWorkers<OmplDetector> workers_;
  CheckSettings settings_;
};

/// A motion is valid if it is certified (MotionCheck): no configuration between the two states is
/// in contact, or closer than MotionSettings::clearance. Nothing is sampled, so the planner's
/// resolution of edges has no effect. One instance serves all threads of a planner.
class OmplMotionValidator : public ompl::base::MotionValidator {
 public:
  /// Throws as OmplStateValidityChecker does, and if the space is of a class derived from
  /// RealVectorStateSpace.
  OmplMotionValidator(const ompl::base::SpaceInformationPtr& space,
                      std::shared_ptr<const CollisionScene> scene, OmplJoints joints,
                      const MotionSettings& settings = {})
      : MotionValidator(space),
        workers_(*space, std::move(scene), std::move(joints)),
        settings_(settings) {
    const ompl::base::StateSpace& states = *space->getStateSpace();
    if (typeid(states) != typeid(ompl::base::RealVectorStateSpace)) {
      throw InputError(
          "the state space is derived from RealVectorStateSpace, so that its motions may be others "
          "than straight lines, which alone are certified");
    }
    workers_.requireAnswer([&](Worker& worker, const std::vector<double>& positions) {
      worker.check.check({positions, positions}, settings_, {}, workers_.voxels());
    });
  }

  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to) const override {
    return counted(freeUntil(from, to, false) == 1.0);
  }

  /// The last valid state is that at MotionReport::free_until, or just before.
  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to,
                   std::pair<ompl::base::State*, double>& last_valid) const override {
    const double free_until = freeUntil(from, to, true);
    if (free_until == 1.0) return counted(true);
    last_valid.second = free_until > 0.0 ? std::nextafter(free_until, 0.0) : 0.0;
    if (last_valid.first) {
      si_->getStateSpace()->interpolate(from, to, last_valid.second, last_valid.first);
    }
    return counted(false);
  }

 private:
  struct Worker {
    explicit Worker(const std::shared_ptr<const CollisionScene>& scene) : check(scene) {}
    MotionCheck check;
    JointMotion motion;
  };

  /// Without `from_start` only 1 is of interest.
  double freeUntil(const ompl::base::State* from, const ompl::base::State* to,
                   bool from_start) const {
    MotionSettings settings = settings_;
    settings.from_start = from_start;
    settings.only_free = !from_start;
    return workers_.ask(
        [&](Worker& worker) {
          workers_.read(from, worker.motion.from);
          workers_.read(to, worker.motion.to);
          return worker.check.check(worker.motion, settings, {}, workers_.voxels()).free_until;
        },
        0.0);
  }

  /// OMPL's counters are no atomic numbers.
  bool counted(bool is_valid) const {
    const std::lock_guard<std::mutex> lock(counters_);
    ++(is_valid ? valid_ : invalid_);
    return is_valid;
  }

  OmplWorkers<Worker> workers_;
  const MotionSettings settings_;
  mutable std::mutex counters_;
};

}  // namespace collision_pairs
