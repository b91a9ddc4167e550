// The Python class Detector.
#include <atomic>
#include <mutex>
#include <thread>

#include <pybind11/stl.h>

#include "bindings.h"
#include "check_result.h"
#include "collision_pairs/batch_check.h"
#include "collision_pairs/input_error.h"
#include "joint_states.h"
#include "long_call.h"

namespace py = pybind11;

namespace collision_pairs {
namespace {

/// Of the state that a thread is checking.
struct Posture {
  std::vector<double> state, positions;
  std::vector<Eigen::Isometry3d> X_WB;
};

Posture& postureOfThisThread() {
  thread_local Posture posture;
  return posture;
}

/// Checks one call at a time; a second thread waits for the first.
class PythonDetector {
 public:
  PythonDetector(const PythonScene& scene, unsigned threads)
      : scene_(scene.scene),
        model_names_(scene.model_names),
        all_joints_(namesOfAllJoints(scene_->robot())),
        single_(scene_),
        batch_(scene_, usableThreads(threads)),
        zero_(scene_->robot().unnamedPositions()) {}

  std::unique_ptr<CheckResult> check(const py::object& states, const py::object& joints,
                                     const CheckSettings& settings, bool gradient) {
    if (gradient && settings.verdict_only) {
      throw InputError("gradient needs distances and cannot be combined with verdict_only");
    }
    const std::shared_ptr<const NamedJoints> named = jointsOf(joints);
    const JointStatesArray array(states, named->columns.size());
    auto result = std::make_unique<CheckResult>();
    result->is_single = array.isSingle();
    result->has_gradient = gradient;
    result->nb_joints = named->columns.size();
    result->joints_at_zero = named->at_zero;
    result->unchecked = scene_->unchecked();
    result->model_names = model_names_;
    result->resize(array.size());
    try {
      const OthersMayRun others_may_run;
      const OneAtATime one_at_a_time(*this);
      run(array, *named, settings, *result);
    } catch (const Interrupted&) {
      throw py::error_already_set();
    }
    return result;
  }

  const std::vector<std::string>& joints() const { return all_joints_; }

 private:
  /// Holds the detector. Throws InputError where its thread holds it already: a handler of a
  /// signal, which Python runs in the middle of a check.
  class OneAtATime {
   public:
    explicit OneAtATime(PythonDetector& detector) : detector_(detector) {
      if (detector.user_ == std::this_thread::get_id()) {
        throw InputError(
            "this detector is already in use by this thread: use a separate one in a signal "
            "handler");
      }
      detector.mutex_.lock();
      detector.user_ = std::this_thread::get_id();
    }
    ~OneAtATime() {
      detector_.user_ = std::thread::id();
      detector_.mutex_.unlock();
    }
    OneAtATime(const OneAtATime&) = delete;
    OneAtATime& operator=(const OneAtATime&) = delete;

   private:
    PythonDetector& detector_;
  };

  std::shared_ptr<const NamedJoints> jointsOf(const py::object& joints) {
    if (named_ && named_->areNamedBy(joints)) return named_;
    const auto named = std::make_shared<const NamedJoints>(joints, scene_->robot());
    named->warnOfOthers();
    return named_ = named;
  }

  void run(const JointStatesArray& states, const NamedJoints& named, const CheckSettings& settings,
           CheckResult& result) {
    ResultCollector collector(*scene_, result.has_gradient ? &named.columns : nullptr, result);
    SignalCheck signals(32);
    const auto read = [&](std::size_t i, std::vector<double>& positions) {
      Posture& posture = postureOfThisThread();
      states.read(i, posture.state);
      positions = zero_;
      try {
        named.columns.apply(posture.state.data(), positions);
      } catch (const InputError& error) {
        if (states.isSingle()) throw;
        throw InputError("state " + std::to_string(i) + ": " + error.what());
      }
    };
    const auto pose = [&](std::size_t i, BodyPoses& poses) {
      Posture& posture = postureOfThisThread();
      read(i, posture.positions);
      scene_->robot().forwardKinematics(posture.positions, posture.X_WB);
      scene_->gatherPoses(posture.X_WB, poses);
    };
    const auto take = [&](std::size_t i, const CollisionReport& report) {
      collector.take(i, report, postureOfThisThread().X_WB);
      signals.now();
    };
    if (states.size() == 1) {  // without a call of each thread's detector
      poses_.resize(scene_->bodies().size());
      pose(0, poses_);
      take(0, single_.detect(poses_, settings));
    } else if (settings.verdict_only) {  // poses are for gradients alone
      batch_.runJoints(states.size(), settings, read, {}, take);
    } else {
      batch_.run(states.size(), settings, pose, take);
    }
    collector.finish();
  }

  std::shared_ptr<const CollisionScene> scene_;
  py::array model_names_;
  const std::vector<std::string> all_joints_;
  std::shared_ptr<const NamedJoints> named_;  // guarded by the GIL
  std::mutex mutex_;                          // guards what follows; taken without the GIL
  std::atomic<std::thread::id> user_{std::thread::id()};
  CollisionDetector single_;
  BatchCheck batch_;
  BodyPoses poses_;
  const std::vector<double> zero_;
};

}  // namespace
}  // namespace collision_pairs

COLLISION_PAIRS_BIND(collision_pairs::PythonDetector)

namespace collision_pairs {

void bindDetector(py::module& module) {
  bindCheckResult(module);
  const CheckSettings defaults;
  py::class_<PythonDetector>(module, "Detector",
                             "Checks joint states of a scene. A second thread waits for the "
                             "first, so use one detector per thread.")
      .def(py::init<const PythonScene&, unsigned>(), py::arg("scene"), py::arg("threads") = 0,
           "threads: of a batch; 0: one per core.")
      .def(
          "check",
          [](PythonDetector& detector, const py::object& states, const py::object& joints,
             double alarm_distance, const py::object& fidelity, bool min_distance,
             bool verdict_only, double time_budget, bool gradient, double tolerance,
             const py::str& broad_phase) {
            CheckSettings settings;
            settings.alarm_distance = alarm_distance;
            settings.fidelity = fidelityFrom(fidelity);
            settings.min_distance = min_distance;
            settings.verdict_only = verdict_only;
            settings.time_budget = time_budget;
            settings.broad_phase = parseBroadPhase(utf8From(broad_phase));
            // NaN is refused with or without a gradient.
            settings.tolerance = gradient && tolerance > 0.0 ? 0.0 : tolerance;
            return detector.check(states, joints, settings, gradient);
          },
          py::arg("states"), py::arg("joints") = py::none(),
          py::arg("alarm_distance") = defaults.alarm_distance,
          py::arg("fidelity") = fidelityName(defaults.fidelity),
          py::arg("min_distance") = defaults.min_distance,
          py::arg("verdict_only") = defaults.verdict_only,
          py::arg("time_budget") = defaults.time_budget, py::arg("gradient") = false,
          py::arg("tolerance") = defaults.tolerance,
          py::arg("broad_phase") = broadPhaseName(defaults.broad_phase),
          "states: float64 (n, len(joints)), or (len(joints),) for one; rad or m. Read in place, "
          "with any strides; float32, integers and lists are converted. joints: their names "
          "(None: Detector.joints); others are taken as zero, or their nearest limit, with a "
          "warning. alarm_distance: m, pairs up to this far apart are reported. fidelity: "
          "'aabb', 'spheres', 'obb', 'convex', 'mesh' or a Fidelity. min_distance: the exact "
          "smallest "
          "distance, even "
          "beyond the alarm distance. verdict_only: ends at the first contact. time_budget: s per "
          "state, 0: no limit. gradient: also the gradient of each pair's distance. tolerance: m "
          "by which a distance may be too small; 0 with gradient. broad_phase: 'auto' or 'sweep' "
          "(direct sweep and prune for any "
          "number of boxes; the same pairs). Other Python threads run "
          "meanwhile. Raises InputError that names the state and the joint.")
      .def_property_readonly("joints", &PythonDetector::joints,
                             "The joint names that check() uses by default.");
}

}  // namespace collision_pairs
