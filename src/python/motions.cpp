// The Python class MotionCheck, and what it answers.
#include <pybind11/stl.h>

#include "bindings.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/motion_check.h"
#include "joint_states.h"
#include "long_call.h"

namespace py = pybind11;

namespace collision_pairs {
namespace {

/// An entry of the structured array `pairs`.
struct SegmentPair {
  std::int64_t segment;
  std::uint32_t first, second;  ///< in `models`
};

struct MotionResult {
  py::array_t<std::uint8_t> verdict;
  py::array_t<double> clearance, contact_at, free_until;
  py::array_t<SegmentPair> pairs;
  py::array model_names;
  std::vector<std::string> joints_at_zero;
  std::string unchecked;  ///< MotionReport::unchecked
};

class PythonMotionCheck {
 public:
  PythonMotionCheck(const PythonScene& scene, unsigned threads)
      : scene_(scene.scene), model_names_(scene.model_names), threads_(usableThreads(threads)) {}

  MotionResult check(const py::object& waypoints, const py::object& joints,
                     const MotionSettings& settings) const {
    const NamedJoints named(joints, scene_->robot());
    named.warnOfOthers();
    const JointStatesArray array(waypoints, named.columns.size());
    if (array.size() < 2 || array.isSingle()) {
      throw InputError("a motion needs two or more waypoints: an array of shape (n, joints)");
    }
    std::vector<MotionReport> reports;
    try {
      const OthersMayRun others_may_run;
      reports = reportsOf(array, named.columns, settings);
    } catch (const Interrupted&) {
      throw py::error_already_set();
    }
    return resultOf(reports, named);
  }

 private:
  std::vector<MotionReport> reportsOf(const JointStatesArray& array, const JointColumns& columns,
                                      const MotionSettings& settings) const {
    std::vector<std::vector<double>> waypoints(array.size(), scene_->robot().unnamedPositions());
    std::vector<double> state;
    for (std::size_t i = 0; i < waypoints.size(); ++i) {
      array.read(i, state);
      try {
        columns.apply(state.data(), waypoints[i]);
      } catch (const InputError& error) {
        throw InputError("waypoint " + std::to_string(i) + ": " + error.what());
      }
    }
    SignalCheck signals(1);  // a segment may take a second
    SegmentOptions options;
    options.threads = threads_;
    options.done = [&](std::size_t) { signals.now(); };
    return checkSegments(scene_, waypoints, settings, options);
  }

  MotionResult resultOf(const std::vector<MotionReport>& reports, const NamedJoints& named) const {
    const auto count = static_cast<py::ssize_t>(reports.size());
    MotionResult result{py::array_t<std::uint8_t>(count),
                        py::array_t<double>(count),
                        py::array_t<double>(count),
                        py::array_t<double>(count),
                        {},
                        model_names_,
                        named.at_zero,
                        scene_->unchecked()};
    std::vector<SegmentPair> pairs;
    for (py::ssize_t i = 0; i < count; ++i) {
      const MotionReport& report = reports[static_cast<std::size_t>(i)];
      result.verdict.mutable_at(i) = static_cast<std::uint8_t>(report.verdict);
      result.clearance.mutable_at(i) = report.clearance;
      result.contact_at.mutable_at(i) = report.contact_at;
      result.free_until.mutable_at(i) = report.free_until;
      for (const auto& [first, second] : report.pairs) pairs.push_back({i, first, second});
    }
    result.pairs = py::array_t<SegmentPair>(static_cast<py::ssize_t>(pairs.size()), pairs.data());
    return result;
  }

  std::shared_ptr<const CollisionScene> scene_;
  py::array model_names_;
  unsigned threads_;
};

}  // namespace
}  // namespace collision_pairs

COLLISION_PAIRS_BIND(collision_pairs::MotionResult)
COLLISION_PAIRS_BIND(collision_pairs::PythonMotionCheck)

namespace collision_pairs {

void bindMotions(py::module& module) {
  PYBIND11_NUMPY_DTYPE(SegmentPair, segment, first, second);
  py::class_<MotionResult>(module, "MotionResult",
                           "Result of MotionCheck.check for the n - 1 segments of n waypoints.")
      .def_readonly("verdict", &MotionResult::verdict,
                    "uint8 (n - 1,): FREE: certified, no pair comes closer than the clearance; "
                    "COLLISION: a contact was found; UNKNOWN: neither.")
      .def_readonly("clearance", &MotionResult::clearance,
                    "float64 (n - 1,), m: if FREE, a lower bound of the smallest distance of the "
                    "segment; otherwise 0.")
      .def_readonly("contact_at", &MotionResult::contact_at,
                    "float64 (n - 1,): if COLLISION, the fraction of the segment, 0 to 1, at "
                    "which the contact was found; otherwise 0.")
      .def_readonly("free_until", &MotionResult::free_until,
                    "float64 (n - 1,): the fraction of the segment, 0 to 1, up to which it is "
                    "certified with the clearance; 1: FREE. Without from_start 0 for COLLISION.")
      .def_readonly("pairs", &MotionResult::pairs,
                    "Structured (p,): segment, first, second (in models): in contact there, or "
                    "not certified.")
      .def_readonly("models", &MotionResult::model_names, "str (m,): model names of the scene.")
      .def_readonly("joints_at_zero", &MotionResult::joints_at_zero,
                    "Moving joints that were not named: taken as zero, or their nearest limit.")
      .def_readonly(
          "unchecked", &MotionResult::unchecked,
          "Usually empty: why there is nothing to check, or the robot or the environment is not "
          "checked at all. The verdict is then never FREE, unless the setting allow_empty_scene "
          "permits it.");
  const MotionSettings defaults;
  py::class_<PythonMotionCheck>(module, "MotionCheck",
                                "Certifies straight motions in joint space between waypoints. "
                                "Can be shared by threads.")
      .def(py::init<const PythonScene&, unsigned>(), py::arg("scene"), py::arg("threads") = 0,
           "threads: 0: one per core.")
      .def(
          "check",
          [](const PythonMotionCheck& motions, const py::object& waypoints,
             const py::object& joints, double clearance, double resolution,
             const py::object& fidelity, bool from_start) {
            MotionSettings settings;
            settings.fidelity = fidelityFrom(fidelity);
            settings.clearance = clearance;
            settings.resolution = resolution;
            settings.from_start = from_start;
            return motions.check(waypoints, joints, settings);
          },
          py::arg("waypoints"), py::arg("joints") = py::none(),
          py::arg("clearance") = defaults.clearance, py::arg("resolution") = defaults.resolution,
          py::arg("fidelity") = fidelityName(defaults.fidelity),
          py::arg("from_start") = defaults.from_start,
          "waypoints: float64 (n, len(joints)), rad or m. joints: as in Detector.check. clearance: "
          "m, FREE means that no pair comes closer. resolution: m, a pair still open when its "
          "motion is split finer is given up. from_start: also certify what lies before a contact, "
          "for free_until, at a higher cost. Raises InputError that names the waypoint and the "
          "joint.");
}

}  // namespace collision_pairs
