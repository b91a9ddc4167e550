#include "pair_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "infinity.h"
#include "solids.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

using Cell = PairTable::Cell;

constexpr std::uint8_t CLEAR = 3;  // FREE, and apart by more than APART
constexpr std::uint8_t OPEN_BLOCK = 16;
constexpr int FIRST_LEVEL = 4;
constexpr int FULL_LEVEL = 7;  // coarser blocks are certified when first read, by what costs little
constexpr int VISITS = 4;      // of a finer one before at() certifies it; costs about as much
constexpr double TABLE_MARGIN = 2e-9;   // m: rounding of the exact check and of this one
constexpr double CELL_ROUNDING = 1e-9;  // relative to the width of a cell
constexpr double BESIDE_LINE = 1e-6;    // cells: far above the rounding of a place on a line
constexpr double LONGEST_LINE = 1e4;    // of a line

std::size_t indexOfBlock(int level, int x, int y) {
  const std::size_t before = ((std::size_t{1} << (2 * level)) - 1) / 3;
  return before + (static_cast<std::size_t>(y) << level) + static_cast<std::size_t>(x);
}

}  // namespace

bool PairTable::joints(const RobotModel& robot, int body_a, int body_b, std::vector<int>& joints) {
  std::vector<int> from_a, from_b;
  const int common = robot.visitBetween(body_a, body_b, [&](int body, bool is_above_a) {
    const int joint = robot.bodies()[body].joint;
    if (joint < 0 || !robot.joints()[joint].hasPosition()) return;
    (is_above_a ? from_a : from_b).push_back(joint);
  });
  joints = from_a;
  joints.insert(joints.end(), from_b.rbegin(), from_b.rend());
  return common >= 0 && !joints.empty() && joints.size() <= 2 &&
         std::all_of(joints.begin(), joints.end(), [&](int id) {
           const Joint& joint = robot.joints()[id];
           return joint.type != JointType::PRISMATIC || joint.upper > joint.lower;
         });
}

PairTable::PairTable(const CollisionScene& scene, const BatchModel& model, const BoxPair& pair)
    : scene_(scene), model_(model), pair_(pair), positions_(scene.robot().zeroPositions()) {
  const auto& elements = scene.elements();
  const auto bodyOf = [&](std::uint32_t i) { return scene.bodies()[elements[i].body].body; };
  joints(scene.robot(), bodyOf(pair.first), bodyOf(pair.second), joints_);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = scene.robot().joints()[joints_[i]];
    const bool turns = joint.type != JointType::PRISMATIC;
    const bool is_limited = joint.hasLimits() && joint.upper > joint.lower &&
                            !(turns && joint.upper - joint.lower >= 2.0 * M_PI);
    axes_[i].is_round = !is_limited;
    axes_[i].lower = is_limited ? joint.lower : -M_PI;
    axes_[i].width = is_limited ? joint.upper - joint.lower : 2.0 * M_PI;
  }
}

bool PairTable::indexOf(const Axis& axis, double position, int& index) const {
  const double from_lower = (position - axis.lower) / axis.width;
  const double share = axis.is_round ? from_lower - std::floor(from_lower) : from_lower;
  if (!(share >= 0.0 && share <= 1.0)) return false;
  index = std::min(static_cast<int>(share * SIDE), SIDE - 1);
  return true;
}

PairTable::Cell PairTable::at(double first, double second, NarrowPhase& narrow_phase) {
  int x = 0, y = 0;
  if (!indexOf(axes_[0], first, x) || !indexOf(axes_[1], second, y)) return Cell::OPEN;
  const std::uint8_t code = codeOf(x, y, false, narrow_phase);
  return code == CLEAR ? Cell::FREE : static_cast<Cell>(code);
}

PairTable::Along PairTable::along(const double* from, const double* to, NarrowPhase& narrow_phase) {
  constexpr Along UNKNOWN{Cell::OPEN, 0.0, 1.0};
  double first[2], step[2];  // in cells
  for (int i = 0; i < 2; ++i) {
    const auto placeOf = [&](double position) {
      return (position - axes_[i].lower) / axes_[i].width * SIDE;
    };
    first[i] = placeOf(from[i]);
    step[i] = placeOf(to[i]) - first[i];
    const double last = placeOf(to[i]);
    if (!axes_[i].is_round &&
        !(std::min(first[i], last) >= 0.0 && std::max(first[i], last) <= SIDE))
      return UNKNOWN;
  }
  if (!(std::abs(step[0]) + std::abs(step[1]) <= LONGEST_LINE)) return UNKNOWN;
  struct Part {
    double begin, end;
  };
  // The fractions of `within` at which the line is in, or nearly in, the cells of an index.
  const auto partIn = [&](int axis, int index, const Part& within) -> Part {
    if (step[axis] == 0.0) return within;
    const double a = (index - BESIDE_LINE - first[axis]) / step[axis],
                 b = (index + 1 + BESIDE_LINE - first[axis]) / step[axis];
    return {std::max(within.begin, std::min(a, b)), std::min(within.end, std::max(a, b))};
  };
  const auto forEachCell = [&](int axis, const Part& part, const auto& work) {
    const double a = first[axis] + part.begin * step[axis], b = first[axis] + part.end * step[axis];
    const int last = static_cast<int>(std::floor(std::max(a, b) + BESIDE_LINE));
    for (int i = static_cast<int>(std::floor(std::min(a, b) - BESIDE_LINE)); i <= last; ++i) {
      const Part of_cell = partIn(axis, i, part);
      if (of_cell.begin > of_cell.end) continue;
      if (!work(axes_[axis].is_round ? i & (SIDE - 1) : std::clamp(i, 0, SIDE - 1), of_cell))
        return;
    }
  };
  Along found{Cell::FREE, 1.0, 0.0};
  forEachCell(0, {0.0, 1.0}, [&](int x, const Part& column) {
    forEachCell(1, column, [&](int y, const Part& part) {
      const std::uint8_t code = codeOf(x, y, true, narrow_phase);
      if (code == CLEAR) return true;
      const double middle = 0.5 * (part.begin + part.end);
      const auto positionAt = [&](int i) { return from[i] + middle * (to[i] - from[i]); };
      int at_x = 0, at_y = 0;
      if (code == static_cast<std::uint8_t>(Cell::CONTACT) &&
          indexOf(axes_[0], positionAt(0), at_x) && indexOf(axes_[1], positionAt(1), at_y) &&
          at_x == x && at_y == y) {  // not only beside it
        found = {Cell::CONTACT, middle, middle};
        return false;
      }
      found = {Cell::OPEN, std::min(found.begin, part.begin), std::max(found.end, part.end)};
      return true;
    });
    return found.cell != Cell::CONTACT;
  });
  return found;
}

std::uint8_t PairTable::codeOf(int x, int y, bool at_once, NarrowPhase& narrow_phase) {
  constexpr auto OPEN = static_cast<std::uint8_t>(Cell::OPEN);
  if (cells_.empty()) {
    cells_.assign(SIDE * SIDE, OPEN_BLOCK + FIRST_LEVEL);
    visits_.assign(indexOfBlock(LEVELS + 1, 0, 0), 0);
  }
  const std::uint8_t code = cells_[static_cast<std::size_t>(y * SIDE + x)];
  if (code < OPEN_BLOCK) return code;
  const int level = code - OPEN_BLOCK;
  const Block block{level, x >> (LEVELS - level), y >> (LEVELS - level)};
  std::uint8_t& visits = visits_[indexOfBlock(level, block.x, block.y)];
  if (visits > VISITS) return OPEN;
  if (!at_once && ++visits < VISITS && level >= FULL_LEVEL) return OPEN;
  visits = VISITS + 1;  // certification was tried
  const std::uint8_t made = certified(block, narrow_phase);
  if (made != OPEN) {
    fill(block, made);
  } else if (level < LEVELS) {
    fill(block, static_cast<std::uint8_t>(code + 1));
  }
  return made;
}

void PairTable::fill(const Block& block, std::uint8_t code) {
  const int side = SIDE >> block.level;
  for (int y = block.y * side; y < (block.y + 1) * side; ++y) {
    std::fill_n(cells_.begin() + y * SIDE + block.x * side, side, code);
  }
}

// From the middle of the block, a joint moves points by at most its angle times their distance from
// its axis there. The two motions add up: with the joint nearer to the points first, the other
// turns what the first has added, but does not stretch it. The distance of two elements changes by
// at most the motion of either relative to the other, and two spheres that overlap by more than
// that still overlap, as do two convex bodies of such a depth: along any direction one can move out
// of the other by no more than it moves. (Schwarzer, Saha, Latombe 2005.) What is free is clear,
// too, but in the smallest blocks.
std::uint8_t PairTable::certified(const Block& block, NarrowPhase& narrow_phase) {
  constexpr auto OPEN = static_cast<std::uint8_t>(Cell::OPEN),
                 FREE = static_cast<std::uint8_t>(Cell::FREE),
                 CONTACT = static_cast<std::uint8_t>(Cell::CONTACT);
  setMotions(block);
  const auto& elements = scene_.elements();
  const auto poseOf = [&](const SceneElement& element) -> Isometry3d {
    return X_WB_[static_cast<std::size_t>(scene_.bodies()[element.body].body)] * element.X_BE;
  };
  const SceneElement &a = elements[pair_.first], &b = elements[pair_.second];
  const Isometry3d X_WA = poseOf(a), X_WC = poseOf(b);
  const SphereCover &cover_a = model_.covers[pair_.first], &cover_b = model_.covers[pair_.second];
  const double padding = scene_.padding(pair_.first, pair_.second);
  const Isometry3d X_AC = X_WA.inverse() * X_WC;
  for (const PlacedSphere& of_a : cover_a.inner) {
    const Vector3d p_W = X_WA * of_a.center;
    const double moves = motionOf(p_W) + TABLE_MARGIN;
    for (const PlacedSphere& of_b : cover_b.inner) {
      const double gap = (X_WC * of_b.center - p_W).norm() - of_a.radius - of_b.radius;
      if (gap + moves < padding) return CONTACT;
    }
  }
  const Prepared &A = preparedOf(a), &C = preparedOf(b);
  const double clear = padding + APART;
  if (hullsStayApart(A.core, X_WA, C.core, X_WC, cover_b, clear)) return CLEAR;
  if (block.level < FULL_LEVEL) return OPEN;
  const double moves = std::min(motionOf(cover_a, X_WA), motionOf(cover_b, X_WC)) + TABLE_MARGIN;
  const PairDistance found = narrow_phase.distance(A, C, X_AC, moves + clear);
  if (found.certainty == Certainty::BEYOND) return CLEAR;
  if (found.distance > padding) {
    const bool is_free = found.certainty == Certainty::EXACT && found.distance > moves + padding;
    return is_free && block.level == LEVELS ? FREE : OPEN;
  }
  if (found.certainty == Certainty::EXACT && found.distance + moves < padding) return CONTACT;
  // Nothing but its surface bounds the inside of a closed mesh, which has inner spheres.
  const auto moveOfA = [&](const Vector3d& p_A) { return motionOf(X_WA * p_A) + TABLE_MARGIN; };
  const auto moveOfC = [&](const Vector3d& p_C) { return motionOf(X_WC * p_C) + TABLE_MARGIN; };
  const bool stays = (!cover_a.inner.empty() && meshHoldsVertexDeep(A, C, X_AC, moveOfA)) ||
                     (!cover_b.inner.empty() && meshHoldsVertexDeep(C, A, X_AC.inverse(), moveOfC));
  return stays ? CONTACT : OPEN;
}

void PairTable::setMotions(const Block& block) {
  motions_.clear();
  const RobotModel& robot = scene_.robot();
  const int index[2] = {block.x, block.y};
  const auto widthOf = [&](std::size_t i) { return axes_[i].width / (1 << block.level); };
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    positions_[static_cast<std::size_t>(joints_[i])] =
        axes_[i].lower + (index[i] + 0.5) * widthOf(i);
  }
  robot.forwardKinematics(positions_, X_WB_);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = robot.joints()[joints_[i]];
    const Isometry3d& X_WB = X_WB_[static_cast<std::size_t>(robot.links()[joint.child_link].body)];
    motions_.push_back({0.5 * widthOf(i) * (1.0 + CELL_ROUNDING), X_WB.linear() * joint.axis,
                        X_WB.translation(), joint.type != JointType::PRISMATIC});
  }
}

/// A bound of the motion of a point, and of all points within `radius` of it.
double PairTable::motionOf(const Vector3d& p_W, double radius) const {
  double moves = 0.0;
  for (const Motion& motion : motions_) moves += motion.half * motion.reachOf(p_W, radius);
  return moves;
}

double PairTable::motionOf(const SphereCover& cover, const Isometry3d& X_WE) const {
  double moves = 0.0;
  for (const OuterSphere& sphere : cover.outer) {
    if (sphere.first_child != 0) continue;
    moves = std::max(moves, motionOf(X_WE * sphere.center, sphere.radius));
  }
  return moves;
}

double PairTable::Motion::reachOf(const Vector3d& p_W, double radius) const {
  return turns ? (axis.cross(p_W - origin).norm() + radius) * (1.0 + CELL_ROUNDING) : 1.0;
}

double PairTable::Motion::reachOf(const SphereCover& cover, const Isometry3d& X_WE) const {
  double reach = 0.0;
  for (const OuterSphere& sphere : cover.outer) {
    if (sphere.first_child != 0) continue;
    reach = std::max(reach, reachOf(X_WE * sphere.center, sphere.radius));
  }
  return reach;
}

// Along the normal n of a plane between the hulls, with the first one at rest. A point p of the
// second, which moves by d_i = u_i x (p - o_i) a radian of joint i, comes to p + t_1 d_1 + t_2 d_2
// but for t_i^2 |d_i| / 2 and, since the joint next to the first one turns what the other has
// moved, |t_1 t_2 d_2| (1 + |t_1| / 2). The height n . (p + t_1 d_1 + t_2 d_2) is linear in p: the
// least is that of a support point along n + t_1 n x u_1 + t_2 n x u_2. It is linear in each t,
// too: the least in the block is that of one of its corners.
bool PairTable::hullsStayApart(const ConvexCore& a, const Isometry3d& X_WA, const ConvexCore& c,
                               const Isometry3d& X_WC, const SphereCover& cover_c,
                               double apart) const {
  const PairDistance gap = convexGap(a, c, X_WA.inverse() * X_WC, INF);
  if (gap.certainty != Certainty::EXACT || !(gap.distance > apart)) return false;
  const Vector3d n = X_WA.linear() * gap.nhat_AB_A;
  const double top = n.dot(X_WA * support<double>(a, X_WA.linear().transpose() * n)) + a.radius;
  double off = 0.0, moved = 0.0;  // moved: by the joints further from A
  for (std::size_t i = motions_.size(); i-- > 0;) {
    const double t = motions_[i].half, reach = motions_[i].reachOf(cover_c, X_WC);
    if (motions_[i].turns) off += 0.5 * t * t * (reach + moved) + t * moved;
    moved += t * reach;
  }
  double least = INF;
  for (unsigned corner = 0; corner < 1u << motions_.size(); ++corner) {
    Vector3d along = n;
    double shift = 0.0;
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      const auto& [half, axis, origin, turns] = motions_[i];
      const double t = corner >> i & 1u ? half : -half;
      const Vector3d turned = t * n.cross(axis);
      if (turns) along += turned;
      shift += turns ? -turned.dot(origin) : t * n.dot(axis);
    }
    const Vector3d p = X_WC * support<double>(c, -X_WC.linear().transpose() * along);
    least = std::min(least, along.dot(p) + shift - c.radius * along.norm());
  }
  return least - off - top > apart + TABLE_MARGIN;
}

}  // namespace collision_pairs
