#include "motion_state.h"

#include <algorithm>
#include <cmath>

#include "collision_pairs/input_error.h"
#include "pose_repair.h"

namespace collision_pairs {
namespace {

constexpr double POSITION_ROUNDING = 1e-15;  // of a joint's position on a straight line

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

}  // namespace

MotionState::MotionState(const CollisionScene& scene, const MotionPairs& pairs)
    : scene_(scene),
      robot_(scene.robot()),
      pairs_(pairs),
      stride_(static_cast<std::size_t>(pairs.max_depth) + 2),
      bodies_(robot_.bodies().size()),
      elements_(scene.elements().size()),
      X_WE_(scene.elements().size()),
      X_WB_(robot_.bodies().size()),
      bounds_(scene.elements().size() * stride_) {
  for (const Joint& joint : robot_.joints()) has_mimics_ |= joint.mimic.has_value();
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const SceneElement& element = scene.elements()[i];
    elements_[i].sphere.radius = element.box_half.norm();
    X_WE_[i] = element.X_BE;
    elements_[i].center_B = elements_[i].sphere.center = element.X_BE * element.box_center;
  }
}

void MotionState::begin(const JointMotion& motion, const PlacedBodies& placed) {
  const std::size_t nb_joints = robot_.joints().size();
  if (motion.from.size() != nb_joints || motion.to.size() != nb_joints) {
    throw InputError("a motion from " + std::to_string(motion.from.size()) + " to " +
                     std::to_string(motion.to.size()) + " joint positions, but the robot has " +
                     std::to_string(nb_joints) + " joints");
  }
  if (!placed.empty() && placed.size() != bodies_.size()) {
    throw InputError("poses of " + std::to_string(placed.size()) +
                     " bodies were given, but the robot has " + std::to_string(bodies_.size()));
  }
  from_ = motion.from;
  to_ = motion.to;
  if (has_mimics_) {
    robot_.applyMimics(from_);
    robot_.applyMimics(to_);
  }
  for (std::size_t i = 0; i < nb_joints; ++i) {
    if (std::isfinite(from_[i]) && std::isfinite(to_[i] - from_[i])) continue;
    const Joint& joint = robot_.joints()[i];
    throw InputError("joint '" + joint.name + "': " +
                     (joint.leader_missing
                          ? "it needs a position, because the joint that it mimics does not exist"
                          : "the ends of its motion, or the way between them, are not finite"));
  }
  setDeviation(motion.deviation);
  begun_ = ++now_;
  for (std::size_t i = 0; i < bodies_.size(); ++i) beginBody(static_cast<int>(i), placed);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    ElementState& element = elements_[i];
    const int id = pairs_.body_of[i];
    element.moves = id >= 0 && bodies_[id].nb_moving > 0;
  }
}

void MotionState::setDeviation(const std::vector<double>& deviation) {
  deviation_ = deviation;
  if (deviation.empty()) {
    deviation_.assign(from_.size(), 0.0);
    return;
  }
  if (deviation.size() != from_.size()) {
    throw InputError("a motion with " + std::to_string(deviation.size()) +
                     " deviations, but the robot has " + std::to_string(from_.size()) + " joints");
  }
  for (std::size_t i = 0; i < deviation.size(); ++i) {
    if (deviation[i] >= 0.0 && std::isfinite(deviation[i])) continue;
    throw InputError("joint '" + robot_.joints()[i].name +
                     "': its deviation is not finite, or negative");
  }
  if (!has_mimics_) return;
  std::vector<double> at_zero(deviation.size(), 0.0);
  robot_.applyMimics(at_zero);
  robot_.applyMimics(deviation_);
  for (std::size_t i = 0; i < deviation_.size(); ++i) {
    deviation_[i] = std::abs(deviation_[i] - at_zero[i]);
  }
}

void MotionState::beginBody(int id, const PlacedBodies& placed) {
  const Body& of_robot = robot_.bodies()[id];
  BodyState& state = bodies_[id];
  state.rate = state.deviation = 0.0;
  state.is_placed = !placed.empty() && placed[id].has_value();
  if (state.is_placed) {
    state.X_PB = *placed[id];
    if (!repairPose(state.X_PB)) {
      throw InputError("link '" + robot_.links()[of_robot.link].name +
                       "': the pose given for it is not finite, or has no rotation");
    }
  } else if (of_robot.joint < 0) {
    state.X_PB = of_robot.X_PJ;
  } else {
    const bool can_move = robot_.joints()[of_robot.joint].hasPosition();
    if (can_move) state.rate = to_[of_robot.joint] - from_[of_robot.joint];
    if (can_move) state.deviation = deviation_[of_robot.joint];
  }
  const int above = of_robot.parent < 0 ? 0 : bodies_[of_robot.parent].nb_moving;
  state.nb_moving = above + (state.moves() ? 1 : 0);
}

bool MotionState::moves(const MotionPairs::Pair& pair) {
  const MotionBound a = bound(pair.first, pair.frame), b = bound(pair.second, pair.frame);
  return a.speed + b.speed + a.deviation + b.deviation > 0.0;
}

bool MotionState::movesModels(std::uint32_t first, std::uint32_t second) {
  const auto& models = scene_.models();
  for (const auto& [still, other] : {std::pair(first, second), std::pair(second, first)}) {
    if (models[still].body < 0 && models[other].body >= 0) {
      return moves(models[other].first_element);
    }
  }
  const auto& elements = scene_.elements();
  const auto models_of = std::minmax(first, second);
  return std::any_of(pairs_.pairs.begin(), pairs_.pairs.end(), [&](const MotionPairs::Pair& pair) {
    return std::minmax(elements[pair.first].model, elements[pair.second].model) == models_of &&
           moves(pair);
  });
}

double MotionState::length() const {
  double length = 0.0;
  for (std::size_t i = 0; i < from_.size(); ++i) {
    length = std::max(length, std::abs(to_[i] - from_[i]));
  }
  return length;
}

void MotionState::moveTo(double at, double half_width) {
  at_ = at;
  half_width_ = half_width;
  ++now_;
}

const MotionState::BodyState& MotionState::body(int id) {
  BodyState& state = bodies_[id];
  const bool is_known = state.stamp == now_ || (state.nb_moving == 0 && state.stamp >= begun_);
  if (is_known) return state;
  state.stamp = now_;
  const Body& of_robot = robot_.bodies()[id];
  if (of_robot.parent < 0) {
    state.X_WB = state.X_PB;
    return state;
  }
  const BodyState& parent = body(of_robot.parent);
  const Joint& joint = robot_.joints()[of_robot.joint];
  if (state.is_placed) {
    state.X_WB = parent.X_WB * state.X_PB;
  } else {
    robot_.placeBody(id, parent.X_WB, positionOf(of_robot.joint), state.X_WB);
  }
  state.twist.omega = parent.twist.omega;
  state.twist.v = parent.twist.v +
                  parent.twist.omega.cross(state.X_WB.translation() - parent.X_WB.translation());
  if (state.moves()) {
    state.axis_W = state.X_WB.linear() * joint.axis;
    Vector3d& moved = joint.type == JointType::PRISMATIC ? state.twist.v : state.twist.omega;
    moved += state.rate * state.axis_W;
  }
  return state;
}

const Isometry3d& MotionState::pose(std::uint32_t element) {
  const int id = pairs_.body_of[element];
  if (id < 0 || isOfNow(element, elements_[element].pose_stamp)) return X_WE_[element];
  elements_[element].pose_stamp = now_;
  X_WE_[element] = body(id).X_WB * scene_.elements()[element].X_BE;
  return X_WE_[element];
}

Matrix3d MotionState::rotation(int frame) {
  return frame < 0 ? Matrix3d::Identity() : Matrix3d(body(frame).X_WB.linear());
}

void MotionState::moveSphere(std::uint32_t element) {
  ElementState& state = elements_[element];
  const int id = pairs_.body_of[element];
  state.stamp = now_;
  state.sphere.center = id < 0 ? state.center_B : Vector3d(body(id).X_WB * state.center_B);
}

// From the element to W. Viewed from the element, the joints turn one after the other, the nearest
// to the element first, each about its present axis. So each adds at most the arc of the point's
// present radius about that axis, whatever the others do (isometries preserve distances).
//
// A point deviates from motion at constant velocity because of the curvature of each joint's arc,
// by at most (rate s)^2 / 2 times its radius by then, and because it moved before that joint
// turned, by at most rate s times that earlier motion.
//
// From a place on the line to its deviation: the joints turn one after the other as above, about
// their axes at that place, where the point's radius is at most its present one plus its motion.
void MotionState::setBounds(std::uint32_t element) {
  elements_[element].bound_stamp = now_;
  MotionBound* bounds = &bounds_[element * stride_];
  const BoundingSphere& sphere = this->sphere(element);
  MotionBound bound;
  for (int id = pairs_.body_of[element]; id >= 0; id = robot_.bodies()[id].parent) {
    bounds[pairs_.depth_of[id] + 1] = bound;
    if (!bodies_[id].moves()) continue;
    const double rate = std::abs(bodies_[id].rate), deviation = bodies_[id].deviation;
    const int joint = robot_.bodies()[id].joint;
    const double rounding =
        POSITION_ROUNDING * std::max(std::abs(from_[joint]), std::abs(to_[joint]));
    if (robot_.joints()[joint].type == JointType::PRISMATIC) {
      bound.speed += rate;
      bound.rounding += rounding;
      bound.deviation += deviation;
      continue;
    }
    const BodyState& state = body(id);
    const Vector3d p_AxisCenter_W = sphere.center - state.X_WB.translation();
    const double radius = state.axis_W.cross(p_AxisCenter_W).norm() + sphere.radius;
    const double moved = half_width_ * bound.speed;
    if (deviation > 0.0) bound.deviation += deviation * (radius + moved);
    bound.acceleration += rate * (2.0 * bound.speed + rate * (radius + moved));
    bound.speed += rate * radius;
    bound.rounding += rounding * radius;
  }
  bounds[0] = bound;
}

Twist MotionState::twist(std::uint32_t element, int frame) {
  Twist twist;
  if (!moves(element)) return twist;
  const Vector3d& center = sphere(element).center;
  const auto velocityAt = [&](const BodyState& carrier) -> Vector3d {
    return carrier.twist.v + carrier.twist.omega.cross(center - carrier.X_WB.translation());
  };
  const BodyState& mover = body(pairs_.body_of[element]);
  twist.omega = mover.twist.omega;
  twist.v = velocityAt(mover);
  if (frame < 0) return twist;
  const BodyState& carrier = body(frame);
  twist.omega -= carrier.twist.omega;
  twist.v -= velocityAt(carrier);
  return twist;
}

// From a place on the line to its deviation: the joints turn one after the other, that nearest to
// the frame first. So before joint j turns, those between it and the frame have turned all that it
// carries, and nothing else has changed: its radius is that of the place on the line. It then moves
// a point p by at most
//     deviation * |n.v| + deviation^2 / 2 * radius,   v = axis x (p - origin),
// the second term being that of the arc. At the middle of the interval p is within the box along
// the element's own axes: |n.v| is at most |(n x axis).(center - origin)| and what the box reaches
// along n x axis, which of a long element is less than what its sphere does. Until
// another fraction, v changes by no more than p moves relative to the body above the joint, and by
// the angle by which the joints between that body and the frame turn, from the middle to the line
// and from the line to their deviations, times the radius. Of a prismatic joint v is its axis,
// which only turns.
double MotionState::deviationAlong(std::uint32_t element, int frame, const Vector3d& n_W,
                                   double half_width) {
  const auto isPrismatic = [this](int id) {
    return robot_.joints()[robot_.bodies()[id].joint].type == JointType::PRISMATIC;
  };
  const auto nextMoving = [this, frame](int id) {
    while (id != frame && id >= 0 && !bodies_[id].moves()) id = robot_.bodies()[id].parent;
    return id == frame ? -1 : id;
  };
  const int first = nextMoving(pairs_.body_of[element]);
  double turning = 0.0, turned = 0.0;  // rad, of all joints between the present one and the frame
  for (int id = first; id >= 0; id = nextMoving(robot_.bodies()[id].parent)) {
    if (isPrismatic(id)) continue;
    turning += half_width * std::abs(bodies_[id].rate);
    turned += bodies_[id].deviation;
  }
  const BoundingSphere& sphere = this->sphere(element);
  const Matrix3d axes_EW = pose(element).linear().transpose();
  const Vector3d& half = scene_.elements()[element].box_half;
  double moved = 0.0, sum = 0.0;
  for (int id = first; id >= 0; id = nextMoving(robot_.bodies()[id].parent)) {
    const BodyState& state = body(id);
    const double way = half_width * std::abs(state.rate), deviation = state.deviation;
    if (isPrismatic(id)) {
      sum += deviation * std::min(1.0, std::abs(n_W.dot(state.axis_W)) + turning + turned);
      moved += way;
      continue;
    }
    turning -= way;
    turned -= deviation;
    const Vector3d p_AxisCenter_W = sphere.center - state.X_WB.translation();
    const double radius = state.axis_W.cross(p_AxisCenter_W).norm() + sphere.radius;
    const double furthest = radius + moved;  // at any fraction
    moved += way * radius;
    const Vector3d across_W = n_W.cross(state.axis_W);
    const double along =
        std::abs(across_W.dot(p_AxisCenter_W)) + (axes_EW * across_W).cwiseAbs().dot(half);
    sum += deviation *
           std::min(furthest, along + moved + (turning + turned + 0.5 * deviation) * furthest);
  }
  return sum;
}

void MotionState::gatherPoses(BodyPoses& poses) {
  positions_.resize(from_.size());
  for (std::size_t i = 0; i < from_.size(); ++i) positions_[i] = positionOf(static_cast<int>(i));
  if (has_mimics_) robot_.applyMimics(positions_);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& of_robot = robot_.bodies()[i];
    if (of_robot.parent < 0) {
      X_WB_[i] = bodies_[i].X_PB;
    } else if (bodies_[i].is_placed) {
      X_WB_[i] = X_WB_[of_robot.parent] * bodies_[i].X_PB;
    } else {
      robot_.placeBody(static_cast<int>(i), X_WB_[of_robot.parent], positions_[of_robot.joint],
                       X_WB_[i]);
    }
  }
  scene_.gatherPoses(X_WB_, poses);
}

}  // namespace collision_pairs
