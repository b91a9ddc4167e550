#include "check_result.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <tuple>

#include <pybind11/stl.h>

#include "collision_pairs/input_error.h"

namespace py = pybind11;

namespace collision_pairs {
namespace {

DistanceWorth worthOf(Certainty certainty) {
  switch (certainty) {
    case Certainty::EXACT:
      return DistanceWorth::EXACT;
    case Certainty::BOUND:
      return DistanceWorth::DEPTH_BOUND;
    default:
      return DistanceWorth::LOWER_BOUND;
  }
}

template <class Row>
void setContact(const Contact& contact, const CollisionScene& scene, Row& row) {
  Eigen::Map<Eigen::Vector3d>(row.first_point.data()) = contact.p_WFirst;
  Eigen::Map<Eigen::Vector3d>(row.second_point.data()) = contact.p_WSecond;
  Eigen::Map<Eigen::Vector3d>(row.normal.data()) = contact.nhat_W;
  row.first_element = scene.indexInModel(contact.elements.first);
  row.second_element = scene.indexInModel(contact.elements.second);
}

PairRow rowOf(std::size_t i, const PairReport& pair, const CollisionReport& report,
              const CollisionScene& scene) {
  PairRow row;
  row.row = static_cast<std::int64_t>(i);
  row.first = pair.first;
  row.second = pair.second;
  row.state = static_cast<std::uint8_t>(pair.state);
  row.certainty = static_cast<std::uint8_t>(worthOf(pair.certainty));
  row.fidelity = static_cast<std::uint8_t>(pair.fidelity);
  row.distance = pair.distance;
  row.first_element = row.second_element = 0;
  if (const Contact* nearest = report.nearestContact(pair)) {
    setContact(*nearest, scene, row);
  } else {
    for (auto* point : {&row.first_point, &row.second_point, &row.normal}) {
      point->fill(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return row;
}

NearestRow rowOf(std::size_t i, const Contact& nearest, const CollisionScene& scene) {
  NearestRow row;
  row.row = static_cast<std::int64_t>(i);
  row.first = scene.elements()[nearest.elements.first].model;
  row.second = scene.elements()[nearest.elements.second].model;
  row.distance = -nearest.depth;
  setContact(nearest, scene, row);
  return row;
}

std::uint64_t nextId() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

/// An array over the numbers of a vector, which `owner` holds; `Shown` is what Python has them as.
template <class Shown, class T>
py::array_t<Shown> viewOf(const std::vector<T>& numbers, const py::object& owner) {
  static_assert(sizeof(Shown) == sizeof(T), "not copied");
  return py::array_t<Shown>(static_cast<py::ssize_t>(numbers.size()),
                            reinterpret_cast<const Shown*>(numbers.data()), owner);
}

/// The getter of numbers by state: an array, or the number of one state that was given as
/// (joints,).
template <class Shown, class T>
auto byState(std::vector<T> CheckResult::*numbers) {
  return [numbers](const py::object& self) -> py::object {
    const auto& result = self.cast<const CheckResult&>();
    const std::vector<T>& all = result.*numbers;
    if (result.is_single) return py::cast(static_cast<Shown>(all[0]));
    return viewOf<Shown>(all, self);
  };
}

/// The getter of a structured array.
template <class Row>
auto rows(std::vector<Row> CheckResult::*all) {
  return [all](const py::object& self) {
    return viewOf<Row>(self.cast<const CheckResult&>().*all, self);
  };
}

py::array gradientOf(const py::object& self) {
  const auto& result = self.cast<const CheckResult&>();
  if (!result.has_gradient) {
    throw InputError("the gradient was not requested: check(..., gradient=True)");
  }
  return py::array_t<double>({result.pairs.size(), result.nb_joints}, result.gradient.data(), self);
}

std::string textOf(const CheckResult& result) {
  const auto count = [&](Verdict verdict) {
    const auto& all = result.verdict;
    return std::to_string(std::count(all.begin(), all.end(), static_cast<std::uint8_t>(verdict)));
  };
  return "<CheckResult of " + std::to_string(result.verdict.size()) +
         (result.verdict.size() == 1 ? " state: " : " states: ") + count(Verdict::FREE) +
         " FREE, " + count(Verdict::COLLISION) + " COLLISION, " + count(Verdict::UNKNOWN) +
         " UNKNOWN; " + std::to_string(result.pairs.size()) +
         (result.pairs.size() == 1 ? " pair>" : " pairs>");
}

}  // namespace

void CheckResult::resize(std::size_t nb_states) {
  verdict.resize(nb_states);
  in_collision.resize(nb_states);
  min_distance_is_bound.resize(nb_states);
  min_distance.resize(nb_states);
}

void CheckResult::takeVerdict(std::size_t i, const CollisionReport& report) {
  verdict[i] = static_cast<std::uint8_t>(report.verdict);
  in_collision[i] = report.in_collision;
  min_distance_is_bound[i] = report.min_distance_is_bound;
  min_distance[i] = report.min_distance;
}

ResultCollector::ResultCollector(const CollisionScene& scene, const JointColumns* joints,
                                 CheckResult& result)
    : scene_(scene), joints_(joints), result_(result), id_(nextId()) {
  places_.resize(result.verdict.size());
}

ResultCollector::Part& ResultCollector::partOfThisThread() {
  thread_local std::uint64_t collector = 0;
  thread_local Part* part = nullptr;
  if (collector == id_) return *part;
  const std::lock_guard<std::mutex> lock(mutex_);
  part = parts_.emplace_back(std::make_unique<Part>()).get();
  collector = id_;
  if (joints_ != nullptr) part->differentiate.emplace(scene_, *joints_);
  return *part;
}

void ResultCollector::take(std::size_t i, const CollisionReport& report,
                           const std::vector<Eigen::Isometry3d>& X_WB) {
  result_.takeVerdict(i, report);
  if (report.pairs.empty() && !report.nearest && report.left_out.empty()) return;
  Part& part = partOfThisThread();
  places_[i] = {&part, static_cast<std::uint32_t>(report.pairs.size()), report.nearest.has_value(),
                part.pairs.size(), part.nearest.size()};
  if (report.nearest) part.nearest.push_back(rowOf(i, *report.nearest, scene_));
  for (const PairReport& pair : report.pairs) {
    part.pairs.push_back(rowOf(i, pair, report, scene_));
    if (joints_ == nullptr) continue;
    const std::size_t begin = part.gradient.size();
    part.gradient.resize(begin + joints_->size());
    part.differentiate->compute(pair, report, X_WB, part.gradient.data() + begin);
  }
  for (const std::uint32_t model : report.left_out) {
    part.left_out.push_back({static_cast<std::int64_t>(i), model});
  }
}

void ResultCollector::finish() {
  std::size_t nb_pairs = 0, nb_nearest = 0;
  for (const auto& part : parts_) {
    nb_pairs += part->pairs.size();
    nb_nearest += part->nearest.size();
    result_.left_out.insert(result_.left_out.end(), part->left_out.begin(), part->left_out.end());
  }
  std::sort(result_.left_out.begin(), result_.left_out.end(), [](const auto& a, const auto& b) {
    return std::tie(a.row, a.model) < std::tie(b.row, b.model);
  });
  const std::size_t width = joints_ == nullptr ? 0 : joints_->size();
  result_.pairs.reserve(nb_pairs);
  result_.nearest.reserve(nb_nearest);
  result_.gradient.reserve(nb_pairs * width);
  for (const Place& place : places_) {
    if (place.nb_nearest > 0) result_.nearest.push_back(place.part->nearest[place.nearest]);
    if (place.nb_pairs == 0) continue;
    const auto pairs = place.part->pairs.data() + place.first_pair;
    result_.pairs.insert(result_.pairs.end(), pairs, pairs + place.nb_pairs);
    const auto slopes = place.part->gradient.data() + place.first_pair * width;
    result_.gradient.insert(result_.gradient.end(), slopes, slopes + place.nb_pairs * width);
  }
}

void bindCheckResult(py::module& module) {
  PYBIND11_NUMPY_DTYPE(PairRow, row, first, second, state, certainty, fidelity, distance,
                       first_point, second_point, normal, first_element, second_element);
  PYBIND11_NUMPY_DTYPE(NearestRow, row, first, second, distance, first_point, second_point, normal,
                       first_element, second_element);
  PYBIND11_NUMPY_DTYPE(LeftOutRow, row, model);
  py::class_<CheckResult>(module, "CheckResult",
                          "Result of Detector.check for n states. If one state was given as "
                          "(joints,), values of shape (n,) are scalars. Arrays are views that "
                          "keep the result alive.")
      .def_property_readonly("verdict", byState<std::uint8_t>(&CheckResult::verdict),
                             "uint8 (n,): Verdict.FREE, COLLISION or UNKNOWN.")
      .def_property_readonly("in_collision", byState<bool>(&CheckResult::in_collision),
                             "bool (n,): true unless the verdict is FREE.")
      .def_property_readonly(
          "min_distance", byState<double>(&CheckResult::min_distance),
          "float64 (n,), m: the smallest signed distance of all pairs, if it is at most the "
          "alarm distance or was requested; otherwise a lower bound of it.")
      .def_property_readonly("min_distance_is_bound",
                             byState<bool>(&CheckResult::min_distance_is_bound),
                             "bool (n,): true if min_distance is only a lower bound.")
      .def_property_readonly(
          "pairs", rows(&CheckResult::pairs),
          "Structured (p,): the pairs in contact, near or unresolved of all states, sorted by "
          "state and name. row: of the state; first, second: indices into models; state: "
          "PairState; distance: m, signed; certainty: Certainty; fidelity: Fidelity; first_point, "
          "second_point, normal: (3,), m, in the root link's frame, for the nearest two elements; "
          "first_element, second_element: index of the <collision> (or shape) within its link.")
      .def_property_readonly(
          "nearest", rows(&CheckResult::nearest),
          "Structured (k,): what has min_distance, of each state in which it is not a bound; none "
          "with verdict_only. Fields as in pairs; distance is min_distance.")
      .def_property_readonly(
          "left_out", rows(&CheckResult::left_out),
          "Structured (l,): row, model: models that could not be checked, because their pose or "
          "size is not finite; the state is never FREE.")
      .def_property_readonly("gradient", &gradientOf,
                             "float64 (p, joints): d(distance)/d(position) of each pair, m/rad or "
                             "m/m; NaN if there is none. Requires gradient=True.")
      .def_readonly("models", &CheckResult::model_names,
                    "str (m,): model names of the scene, referred to by pairs and left_out.")
      .def_readonly("joints_at_zero", &CheckResult::joints_at_zero,
                    "Moving joints that were not named: taken as zero, or their nearest limit.")
      .def_readonly(
          "unchecked", &CheckResult::unchecked,
          "Usually empty: why there is nothing to check, or the robot or the environment is not "
          "checked at all. The verdict is then never FREE, unless the setting allow_empty_scene "
          "permits it.")
      .def("__bool__",
           [](const CheckResult&) -> bool {
             throw py::type_error("a CheckResult is neither true nor false: use its in_collision");
           })
      .def("__repr__", &textOf);
}

}  // namespace collision_pairs
