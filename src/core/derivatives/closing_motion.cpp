#include "collision_pairs/closing_motion.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "convex_distance.h"
#include "infinity.h"
#include "plane_bound.h"
#include "pose_repair.h"
#include "prepared_shape.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double ROUNDING = 1e-12;  // relative to the coordinates
constexpr int NB_BISECTIONS = 20;   // of HORIZON: to 10 microseconds

struct BodyPair {
  Isometry3d X_WB = Isometry3d::Identity(), X_WB_before = Isometry3d::Identity();
};

/// Empty if the pose is unknown at one of the two instants.
std::optional<BodyPair> posesOf(int body, const BodyPoses& now, const BodyPoses& before) {
  BodyPair poses;
  if (body < 0) return poses;  // static
  const auto i = static_cast<std::size_t>(body);
  for (const auto& [given, X_WB] :
       {std::pair(&now, &poses.X_WB), std::pair(&before, &poses.X_WB_before)}) {
    if (i >= given->known.size() || i >= given->X_WB.size() || !given->known[i])
      return std::nullopt;
    *X_WB = given->X_WB[i];
    if (!repairPose(*X_WB)) return std::nullopt;
  }
  return poses;
}

/// Velocity of the mover's frame relative to the base; expressed in W.
struct RelativeVelocity {
  Vector3d v, omega;
  Vector3d origin_W;  ///< of the mover's frame

  RelativeVelocity(const BodyPair& base, const BodyPair& mover, double window) {
    const Isometry3d X_BM = base.X_WB.inverse(Eigen::Isometry) * mover.X_WB;
    const Isometry3d X_BM_before = base.X_WB_before.inverse(Eigen::Isometry) * mover.X_WB_before;
    const Eigen::AngleAxisd turn(X_BM.linear() * X_BM_before.linear().transpose());
    const Matrix3d R_WB = base.X_WB.linear();
    v = R_WB * (X_BM.translation() - X_BM_before.translation()) / window;
    omega = R_WB * turn.axis() * (turn.angle() / window);
    origin_W = mover.X_WB.translation();
  }
  Vector3d at(const Vector3d& p_W) const { return v + omega.cross(p_W - origin_W); }
};

/// An element at its pose.
struct PlacedElement {
  const SceneElement& element;
  Isometry3d X_WE;
  Matrix3d R_WE;
  Vector3d center_W;
  const Prepared* shape;  ///< null if the scene has none finer than a box
  double margin;

  PlacedElement(const SceneElement& of_scene, const Isometry3d& X_WB)
      : element(of_scene),
        X_WE(X_WB * of_scene.X_BE),
        R_WE(X_WE.linear()),
        center_W(isHalfSpace() ? X_WE.translation() : Vector3d(X_WE * of_scene.box_center)) {
    const Rung& mesh = element.rung(Fidelity::MESH);
    const Rung& rung = mesh.shape ? mesh : element.rung(Fidelity::CONVEX);
    shape = static_cast<const Prepared*>(rung.shape.get());
    margin = rung.margin;
  }
  bool isHalfSpace() const { return std::holds_alternative<HalfSpace>(element.shape); }
  double radius() const { return element.box_half.norm(); }
  HullSupport hull() const { return {shape->core, R_WE, element.box_center, margin}; }
};

/// The last instant up to HORIZON until which a concave gap is not negative; gap(0) > 0.
template <class Gap>
double timeAbove(const Gap& gap) {
  if (!(gap(0.0) > 0.0)) return 0.0;
  double sure = 0.0, end = ClosingMotion::HORIZON;
  if (gap(end) >= 0.0) return end;
  for (int i = 0; i < NB_BISECTIONS; ++i) {
    const double middle = 0.5 * (sure + end);
    (gap(middle) >= 0.0 ? sure : end) = middle;
  }
  return sure;
}

/// Two elements, the mover relative to the base: that is the first, or the second if that is a
/// half-space, which must not rotate, or a cloud, of which any voxel may be met first.
struct ClosingElements {
  bool of_cloud, is_swapped;
  double padding;
  PlacedElement base, mover;
  RelativeVelocity velocity;

  ClosingElements(const CollisionScene& scene, const BoxPair& pair, const Eigen::Vector3i& voxel,
                  const BodyPair& first, const BodyPair& second, double window)
      : of_cloud(scene.cloudOf(pair.first) >= 0 || scene.cloudOf(pair.second) >= 0),
        is_swapped(scene.cloudOf(pair.second) >= 0 ||
                   std::holds_alternative<HalfSpace>(scene.elements()[pair.second].shape)),
        padding(scene.padding(pair.first, pair.second)),
        base(placed(scene, is_swapped ? pair.second : pair.first, voxel,
                    is_swapped ? second : first)),
        mover(placed(scene, is_swapped ? pair.first : pair.second, voxel,
                     is_swapped ? first : second)),
        velocity(is_swapped ? second : first, is_swapped ? first : second, window) {}

  static PlacedElement placed(const CollisionScene& scene, std::uint32_t element,
                              const Eigen::Vector3i& voxel, const BodyPair& body) {
    const bool is_voxel = scene.cloudOf(element) >= 0;
    return {scene.elements()[element], is_voxel ? scene.poseOfVoxel(element, voxel) : body.X_WB};
  }

  /// `n_W`: from the base to the mover; none if the base is a cloud, of which other parts than the
  /// nearest may be met. `distance`: of the two, padding subtracted.
  double timeToContact(const Vector3d* n_W, double distance) const {
    const double reach = (mover.center_W - velocity.origin_W).norm() + mover.radius();
    const double turning = velocity.omega.norm();
    if (!std::isfinite(reach)) return 0.0;  // a moving half-space
    MovingPair moving;
    moving.p_AB_W = mover.center_W - base.center_W;
    moving.twist_b = {velocity.at(mover.center_W), velocity.omega};
    moving.bound.acceleration = turning * turning * reach;
    moving.slack = ROUNDING * (mover.center_W.lpNorm<1>() + base.center_W.lpNorm<1>() + reach);
    moving.padding = padding;
    const double speed = moving.twist_b.v.norm() + turning * mover.radius();
    const double time = timeAbove([&](double t) {
      return distance - moving.slack - speed * t - 0.5 * moving.bound.acceleration * t * t;
    });
    if (mover.shape == nullptr || n_W == nullptr) return time;
    if (base.isHalfSpace()) {
      return std::max(
          time, timeAbove(PlaneBound(moving, PlaneSupport(), mover.hull(), *n_W, moving.slack)));
    }
    if (base.shape == nullptr) return time;
    return std::max(time,
                    timeAbove(PlaneBound(moving, base.hull(), mover.hull(), *n_W, moving.slack)));
  }

  /// Of two that are known to be at least that far apart. Any bound that is more than `enough` will
  /// do.
  double timeOutOfReach(double distance, double enough) const {
    if (base.isHalfSpace()) {
      const Vector3d up_W = base.R_WE.col(2);
      return timeToContact(&up_W, distance);
    }
    if (of_cloud || base.shape == nullptr || mover.shape == nullptr) {
      return timeToContact(nullptr, distance);
    }
    const double of_spheres =
        (mover.center_W - base.center_W).norm() - base.radius() - mover.radius() - padding;
    const double time = timeToContact(nullptr, std::max(distance, of_spheres));
    if (time >= enough) return time;
    Vector3d n = Vector3d::Zero();
    const double gap = roughGap(n, base.shape->core, mover.shape->core,
                                base.X_WE.inverse(Eigen::Isometry) * mover.X_WE, INF) -
                       base.margin - mover.margin - padding;
    const Vector3d n_W = base.R_WE * n;
    return timeToContact(&n_W, std::max(distance, gap));
  }
};

}  // namespace

ClosingMotion closingMotion(const CollisionScene& scene, const CollisionReport& report,
                            const PairReport& pair, const BodyPoses& now,
                            const EarlierPoses& before) {
  const CollisionModel &first = scene.models()[pair.first], &second = scene.models()[pair.second];
  const auto of_first = posesOf(first.body, now, before.poses);
  const auto of_second = posesOf(second.body, now, before.poses);
  ClosingMotion closing;
  if (!of_first || !of_second || pair.nb_contacts == 0 || !(before.window > 0.0)) return closing;
  closing.known = true;
  closing.closing_speed = -INF;
  closing.time_to_contact = pair.mayTouch() ? 0.0 : ClosingMotion::HORIZON;
  for (std::uint32_t i = 0; i < pair.nb_contacts; ++i) {
    const Contact& contact = report.contacts[pair.first_contact + i];
    const ClosingElements two(scene, contact.elements, contact.voxel, *of_first, *of_second,
                              before.window);
    const Vector3d n_W = two.is_swapped ? Vector3d(-contact.nhat_W) : contact.nhat_W;
    const Vector3d& p_WMover = two.is_swapped ? contact.p_WFirst : contact.p_WSecond;
    closing.closing_speed = std::max(closing.closing_speed, -n_W.dot(two.velocity.at(p_WMover)));
    if (closing.time_to_contact == 0.0) continue;
    const double time = two.timeToContact(two.of_cloud ? nullptr : &n_W, -contact.depth);
    closing.time_to_contact = std::min(closing.time_to_contact, time);
  }
  if (!std::isfinite(closing.closing_speed)) return {};  // decided by boxes, which have no normal
  const auto contacts = report.contacts.begin() + pair.first_contact;
  const auto isInReach = [&](const BoxPair& elements) {
    return std::any_of(contacts, contacts + pair.nb_contacts,
                       [&](const Contact& contact) { return contact.elements == elements; });
  };
  // The others are no nearer than the nearest, but may be faster.
  for (std::uint32_t i = 0; i < first.nb_elements * second.nb_elements; ++i) {
    const BoxPair elements{first.first_element + i / second.nb_elements,
                           second.first_element + i % second.nb_elements};
    if (closing.time_to_contact == 0.0) break;
    if (isInReach(elements)) continue;
    const ClosingElements two(scene, elements, {0, 0, 0}, *of_first, *of_second, before.window);
    const double time = two.timeOutOfReach(pair.distance, closing.time_to_contact);
    closing.time_to_contact = std::min(closing.time_to_contact, time);
  }
  return closing;
}

ClosingReport closingReport(const CollisionScene& scene, const CollisionReport& report,
                            bool looks_for_near_pairs, const BodyPoses& now,
                            const EarlierPoses& before) {
  ClosingReport closing;
  bool is_known = report.verdict != Verdict::UNKNOWN && looks_for_near_pairs;
  double time = ClosingMotion::HORIZON;
  for (const PairReport& pair : report.pairs) {
    closing.pairs.push_back(closingMotion(scene, report, pair, now, before));
    is_known &= closing.pairs.back().known;
    time = std::min(time, closing.pairs.back().time_to_contact);
  }
  const bool is_in_contact = report.verdict == Verdict::COLLISION;
  closing.time_to_contact_is_known = is_in_contact || is_known;
  closing.time_to_contact = is_in_contact || !is_known ? 0.0 : time;
  return closing;
}

}  // namespace collision_pairs
