#include "pair_certifier.h"

#include <algorithm>
#include <cmath>

#include "convex_distance.h"
#include "infinity.h"
#include "scene_element.h"

namespace collision_pairs {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double BEYOND_ENOUGH = 1e-3;       // of the resolution
constexpr double RELATIVE_ROUNDING = 1e-12;  // relative to the coordinates
constexpr double DISTANCE_ERROR = 1e-7;      // of the two bodies' size: five times docs/accuracy.md
// Axis-aligned boxes do not rotate with their elements: their faces move as far as the elements
// move in W, on up to three axes at a time. OBBs do, but their corners lie outside the spheres: by
// at most the same factor, since each of their faces touches the element.
constexpr double LOOSE_SPEED = 1.7320508075688773;

// Certify at least this share of the distance at a configuration beyond the requested clearance, so
// that the reported clearance is positive, at a bounded cost.
constexpr double KEPT_SHARE = 0.1;

// A finer bound is worth its cost if it may certify the whole interval, but not while the pair can
// still move by much of its size. In sizes of the smaller of the two:
constexpr double MOTION_FOR_HULLS = 1.0;   // hulls of boxes that are …
constexpr double GAP_FOR_HULLS = 0.3;      // … no further apart than this, or for less motion
constexpr double MOTION_FOR_SHAPES = 0.5;  // distance of shapes whose hulls overlap
constexpr double POOR = 0.05;              // share of the interval: below it shapes follow hulls

double finiteOr0(double radius) { return std::isfinite(radius) ? radius : 0.0; }

}  // namespace

/// One call of measure().
struct PairCertifier::Query {
  OpenPair& open;
  CertifiedInterval& certified;
  const bool rigid;
  const double before, after;  ///< the open interval on either side
  const double radius_a, radius_b;
  const MovingPair& moving;
  const double resolution;
  double box_gap = 0.0;  ///< metres between the boxes of the two elements

  double size() const { return std::min(radius_a, radius_b); }
  /// Largest relative motion on the longer side of the interval, metres.
  double motion() const {
    const double length = std::max(before, after);
    return length > 0.0 ? moving.bound.speed * length : 0.0;
  }
  /// A larger distance certifies the whole interval, for any direction, and so does what a query
  /// with this limit leaves of it after rounding.
  double enough() const {
    return open.clearance + motion() / (1.0 - KEPT_SHARE) + BEYOND_ENOUGH * resolution;
  }
  double levelOf(double distance) const {
    return open.clearance + KEPT_SHARE * (distance - open.clearance);
  }
  bool isCertified() const { return certified.before >= before && certified.after >= after; }
  bool isPoor() const { return certified.before < POOR * before || certified.after < POOR * after; }

  /// Not where it overflowed: then so did what it may change by.
  bool isClear(double distance) const {
    return distance > open.clearance && std::isfinite(distance);
  }

  /// `distance`: lower bound of the distance of the two at this configuration.
  void certifyByDistance(double distance) {
    if (!isClear(distance)) return;
    const double level = levelOf(distance), speed = moving.bound.speed;
    const auto reach = [&](double length) {
      return distance - speed * length >= level ? length : (distance - level) / speed;
    };
    CertifiedInterval found{reach(before), reach(after), level};
    found.clearance = std::max(level, distance - speed * std::max(found.before, found.after));
    extendBy(found);
  }

  /// `gap(s)` is a lower bound of their distance when the fraction has changed by s; concave.
  template <class Gap>
  void certifyByGap(const Gap& gap) {
    const double here = gap(0.0);
    if (!isClear(here)) return;
    const double level = levelOf(here);
    CertifiedInterval found;
    found.before = lengthAbove(gap, here, level, -before, found.clearance);
    found.after = lengthAbove(gap, here, level, after, found.clearance);
    extendBy(found);
    if (!isCertified()) certifyByDistance(here);
  }

  void extendBy(const CertifiedInterval& found) {
    if (found.before <= certified.before && found.after <= certified.after) return;
    const bool replaces = found.before >= certified.before && found.after >= certified.after;
    certified.clearance =
        replaces ? found.clearance : std::min(certified.clearance, found.clearance);
    certified.before = std::max(certified.before, found.before);
    certified.after = std::max(certified.after, found.after);
  }
};

PairCertifier::PairCertifier(const CollisionScene& scene, MotionState& state)
    : scene_(scene), state_(state), boxes_(scene.elements().size(), noBox()) {
  for (std::uint32_t i = 0; i < scene.nbStaticElements(); ++i) {
    boxes_[i] = scene.staticBoxes().box(i);
  }
  ladder_.begin(scene, state.poses(), boxes_);
  voxel_search_.begin(scene, state.poses(), boxes_, ladder_);
}

void PairCertifier::begin(const MotionSettings& settings, const CloudVoxels& voxels) {
  voxels_ = voxels;
  fidelity_ = settings.fidelity;
  resolution_ = settings.resolution;
  nb_queries_ = 0;
  const auto& elements = scene_.elements();
  all_rigid_ = fidelity_ == Fidelity::MESH &&
               std::all_of(elements.begin(), elements.end(), [](const SceneElement& element) {
                 return element.finest == Fidelity::MESH;
               });
}

int PairCertifier::cloudOf(const BoxPair& pair) const {
  return std::max(scene_.cloudOf(pair.first), scene_.cloudOf(pair.second));
}

PairCertifier::Voxels PairCertifier::voxelsOf(const BoxPair& pair) const {
  const int cloud = cloudOf(pair);
  if (cloud < 0) return Voxels::NO_CLOUD;
  const auto i = static_cast<std::size_t>(cloud);
  if (i >= voxels_.size() || !voxels_[i]) return Voxels::UNKNOWN;
  if (voxels_[i]->isTruncated()) return voxels_[i]->isEmpty() ? Voxels::UNKNOWN : Voxels::IN_PART;
  return voxels_[i]->isEmpty() ? Voxels::NONE : Voxels::KNOWN;
}

bool PairCertifier::isRigid(const BoxPair& pair) const {
  if (all_rigid_) return true;
  const Fidelity rung = ladder_.rungOf(pair, fidelity_);
  const auto isLoose = [&](std::uint32_t element) {
    return scene_.elements()[element].rung(rung).loose;
  };
  return rung == Fidelity::MESH ||
         (rung == Fidelity::CONVEX && !isLoose(pair.first) && !isLoose(pair.second));
}

PairCertifier::Outcome PairCertifier::measure(double at, OpenPair& open,
                                              CertifiedInterval& certified) {
  const auto [a, b] = open.pair;
  const double before = at - open.begin, after = open.end - at;
  const BoundingSphere &sphere_a = state_.sphere(a), &sphere_b = state_.sphere(b);
  MovingPair moving;
  moving.p_AB_W = sphere_b.center - sphere_a.center;
  moving.slack = RELATIVE_ROUNDING * (sphere_a.center.lpNorm<1>() + sphere_b.center.lpNorm<1>() +
                                      finiteOr0(sphere_a.radius) + finiteOr0(sphere_b.radius));
  moving.padding = scene_.padding(a, b);
  const bool rigid = isRigid(open.pair);
  const int frame = rigid ? open.frame : -1;
  const MotionBound bound_a = state_.bound(a, frame), bound_b = state_.bound(b, frame);
  moving.deviation =
      ROUNDED_UP * (rigid ? 1.0 : LOOSE_SPEED) * (bound_a.deviation + bound_b.deviation);
  moving.rounding = moving.slack + bound_a.rounding + bound_b.rounding;
  moving.slack = moving.rounding + moving.deviation;
  if (rigid) {
    moving.bound.speed = ROUNDED_UP * (bound_a.speed + bound_b.speed);
    moving.bound.acceleration = ROUNDED_UP * (bound_a.acceleration + bound_b.acceleration);
  } else {
    moving.bound.speed = ROUNDED_UP * LOOSE_SPEED * (bound_a.speed + bound_b.speed);
  }
  open.speed = moving.bound.speed;
  certified = {};
  Query query{open,   certified,  rigid, before, after, sphere_a.radius, sphere_b.radius,
              moving, resolution_};
  if (!rigid || !std::isfinite(open.speed)) return byShapes(query);
  if (cloudOf(open.pair) >= 0) {  // any voxel may be met, not only the nearest
    moving.twist_a = state_.twist(a, open.frame);
    moving.twist_b = state_.twist(b, open.frame);
    ++nb_queries_;
    return byShapes(query);
  }
  query.certifyByDistance(moving.p_AB_W.norm() - sphere_a.radius - sphere_b.radius - moving.slack -
                          moving.padding);
  if (query.isCertified()) return Outcome::CERTIFIED;
  moving.twist_a = state_.twist(a, open.frame);
  moving.twist_b = state_.twist(b, open.frame);
  byBoxes(query);
  if (query.isCertified()) return Outcome::CERTIFIED;
  const double size = std::max(query.size(), resolution_);  // two points have none
  const double motion = query.motion() / size;
  const bool is_finest = query.motion() <= 0.5 * resolution_;
  if (!is_finest && motion > MOTION_FOR_HULLS && query.box_gap > GAP_FOR_HULLS * size) {
    return Outcome::OPEN;
  }
  ++nb_queries_;
  byHulls(query);
  if (query.isCertified()) return Outcome::CERTIFIED;
  if (is_finest) return byShapes(query);
  const bool is_apart = certified.before >= 0.0;
  const bool is_coarse = motion > MOTION_FOR_SHAPES;
  const bool may_gain = query.isPoor() && ladder_.needsTriangles(open.pair, fidelity_);
  if (is_apart && (is_coarse || !may_gain)) return Outcome::OPEN;
  if (!is_coarse || open.clearance > 0.0) return byShapes(query);
  const PairDistance found = ladder_.touches(open.pair, fidelity_).found;
  return found.certainty == Certainty::BOUND ? Outcome::CONTACT : Outcome::OPEN;
}

double PairCertifier::deviationAlong(const Query& query, const Vector3d& n_W, double half_width) {
  const OpenPair& open = query.open;
  const double deviation = query.moving.deviation;
  if (!query.rigid || !(deviation > 0.0)) return deviation;
  const double along = state_.deviationAlong(open.pair.first, open.frame, n_W, half_width) +
                       state_.deviationAlong(open.pair.second, open.frame, n_W, half_width);
  return std::min(deviation, ROUNDED_UP * along);
}

double PairCertifier::slackAlong(const Query& query, const Vector3d& n_W) {
  return query.moving.rounding + deviationAlong(query, n_W, state_.halfWidth());
}

// The direction in which the boxes are furthest apart, along the axes of either: the part of the
// vector between their centres that neither box covers.
void PairCertifier::byBoxes(Query& query) {
  if (!std::isfinite(query.radius_a) || !std::isfinite(query.radius_b)) return;
  const auto [a, b] = query.open.pair;
  const Vector3d &half_a = scene_.elements()[a].box_half, &half_b = scene_.elements()[b].box_half;
  const Vector3d& p_AB_W = query.moving.p_AB_W;
  const Matrix3d R_WA = state_.pose(a).linear(), R_WB = state_.pose(b).linear();
  const Matrix3d reach = (R_WA.transpose() * R_WB).cwiseAbs();
  const auto outside = [](const Vector3d& t, const Vector3d& taken) -> Vector3d {
    return t.cwiseSign().cwiseProduct((t.cwiseAbs() - taken).cwiseMax(0.0));
  };
  const Vector3d along_a = outside(R_WA.transpose() * p_AB_W, half_a + reach * half_b);
  const Vector3d along_b = outside(R_WB.transpose() * p_AB_W, half_b + reach.transpose() * half_a);
  const double gap_a = along_a.norm(), gap_b = along_b.norm();
  query.box_gap = std::max(gap_a, gap_b);
  if (!(query.box_gap > query.moving.padding)) return;
  const Vector3d n_W = gap_a > gap_b ? R_WA * (along_a / gap_a) : R_WB * (along_b / gap_b);
  const BoxSupport box_a{R_WA, half_a}, box_b{R_WB, half_b};
  query.certifyByGap(PlaneBound(query.moving, box_a, box_b, n_W, slackAlong(query, n_W)));
}

void PairCertifier::byPlane(Query& query, const Vector3d& n_W) {
  const auto [a, b] = query.open.pair;
  const Fidelity rung = ladder_.rungOf(query.open.pair, fidelity_);
  const SceneElement &of_a = scene_.elements()[a], &of_b = scene_.elements()[b];
  const Matrix3d R_WA = state_.pose(a).linear(), R_WB = state_.pose(b).linear();
  const Prepared &shape_a = preparedOf(of_a.rung(rung)), &shape_b = preparedOf(of_b.rung(rung));
  const HullSupport hull_a{shape_a.core, R_WA, of_a.box_center, of_a.rung(rung).margin};
  const HullSupport hull_b{shape_b.core, R_WB, of_b.box_center, of_b.rung(rung).margin};
  const PlaneSupport plane;
  const double slack = slackAlong(query, n_W);
  if (shape_a.isHalfSpace()) {
    query.certifyByGap(PlaneBound(query.moving, plane, hull_b, n_W, slack));
  } else if (shape_b.isHalfSpace()) {
    query.certifyByGap(PlaneBound(query.moving, hull_a, plane, n_W, slack));
  } else {
    query.certifyByGap(PlaneBound(query.moving, hull_a, hull_b, n_W, slack));
  }
}

void PairCertifier::byHulls(Query& query) {
  OpenPair& open = query.open;
  const auto [a, b] = open.pair;
  const Fidelity rung = ladder_.rungOf(open.pair, fidelity_);
  const Rung &rung_a = scene_.elements()[a].rung(rung), &rung_b = scene_.elements()[b].rung(rung);
  const Prepared &shape_a = preparedOf(rung_a), &shape_b = preparedOf(rung_b);
  if (shape_a.isHalfSpace() && shape_b.isHalfSpace()) return;
  if (shape_a.isHalfSpace()) return byPlane(query, state_.pose(a).linear().col(2));
  if (shape_b.isHalfSpace()) return byPlane(query, -state_.pose(b).linear().col(2));
  const Matrix3d R_WF = state_.rotation(open.frame);
  if (open.has_normal) {
    byPlane(query, R_WF * open.normal_F);
    if (query.isCertified()) return;
  }
  const double margin =
      rung_a.margin + rung_b.margin + query.moving.padding + query.moving.rounding;
  const Eigen::Isometry3d X_AB = state_.pose(a).inverse(Eigen::Isometry) * state_.pose(b);
  const PairDistance gap =
      convexGap(shape_a.core, shape_b.core, X_AB, query.enough() + margin + query.moving.deviation);
  if (gap.certainty == Certainty::BEYOND) {
    return query.certifyByDistance(gap.distance - margin - query.moving.deviation);
  }
  if (!(gap.distance > margin)) return;
  const Vector3d n_W = (state_.pose(a).linear() * gap.nhat_AB_A).normalized();
  open.has_normal = true;
  open.normal_F = R_WF.transpose() * n_W;
  byPlane(query, n_W);
}

PairDistance PairCertifier::queryShapes(const Query& query, double max_distance) {
  const BoxPair& pair = query.open.pair;
  const int cloud = cloudOf(pair);
  if (cloud < 0) return ladder_.refine(pair, fidelity_, max_distance).found;
  const OccupiedVoxels& voxels = *voxels_[static_cast<std::size_t>(cloud)];
  const double reach = max_distance * ROUNDED_UP;  // so that BEYOND implies enough
  PairDistance found =
      voxel_search_.nearest(pair, voxels, fidelity_, reach, Deadline({}, 0.0)).answer.found;
  if (found.certainty == Certainty::BEYOND) found.distance = reach;
  return found;
}

PairCertifier::Outcome PairCertifier::byShapes(Query& query) {
  const OpenPair& open = query.open;
  const MovingPair& moving = query.moving;
  const auto [a, b] = open.pair;
  for (const std::uint32_t element : {a, b}) {
    const Eigen::Isometry3d& X_WE = state_.pose(element);
    const bool needs_none = query.rigid && cloudOf(open.pair) < 0;
    if (needs_none || element < scene_.nbStaticElements() || scene_.cloudOf(element) >= 0) continue;
    boxes_[element] = scene_.elements()[element].boxAt(X_WE);
  }
  const double error =
      DISTANCE_ERROR * (finiteOr0(query.radius_a) + finiteOr0(query.radius_b)) + moving.slack;
  const PairDistance found = queryShapes(query, query.enough() + error);
  const bool is_certain = found.certainty != Certainty::DEGRADED;
  if (is_certain && found.touches()) return Outcome::CONTACT;
  const double distance = found.distance - error;
  query.certifyByDistance(distance);
  const double speed = (moving.twist_b.v - moving.twist_a.v).norm() +
                       moving.twist_a.omega.norm() * query.radius_a +
                       moving.twist_b.omega.norm() * query.radius_b;
  if (query.rigid && !query.isCertified() && std::isfinite(speed)) {
    query.certifyByGap([&](double s) {
      return distance - speed * std::abs(s) - 0.5 * moving.bound.acceleration * s * s;
    });
  }
  if (query.isCertified()) return Outcome::CERTIFIED;
  const double motion = query.motion();
  const bool can_be_cut = motion > 0.5 * resolution_ && motion < INF &&
                          std::max(query.before, query.after) > SHORTEST_INTERVAL;
  if (!can_be_cut) return Outcome::GIVEN_UP;
  // Or its deviation takes it there: no finer search can certify this configuration.
  const double deviation =
      open.has_normal ? deviationAlong(query, state_.rotation(open.frame) * open.normal_F, 0.0)
                      : moving.deviation;
  const bool is_nearer = found.certainty == Certainty::EXACT &&
                         found.distance + error - moving.deviation - deviation < open.clearance;
  return is_nearer ? Outcome::NEARER : Outcome::OPEN;
}

}  // namespace collision_pairs
