#include "edge_group.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double LONGEST_PART = 0.08;     // rad or m, of the joint that moves most
constexpr int MOST_GROUPS = 64;           // longer motions are left to the search
constexpr double RELATIVE_MARGIN = 1e-5;  // far above the rounding of reaches and widths

}  // namespace

BatchStage::EdgeGroup::EdgeGroup(const BatchStage& stage) : Group(stage) {
  one_contact_will_do_ = true;
  const CollisionScene& scene = stage_.scene_;
  const auto& bodies = scene.robot().bodies();
  const auto bodyOf = [&](std::uint32_t element) {
    return scene.bodies()[scene.elements()[element].body].body;
  };
  for (int i = 0; i < tables_.nb_pairs; ++i) {
    const auto [first, second] = elementsOf(i);
    int a = bodyOf(first), b = bodyOf(second);
    while (a != b) {  // a parent always comes before its children
      int& later = a > b ? a : b;
      later = bodies[later].parent;
    }
    reaches_.emplace_back();
    addReaches(first, a, reaches_.back());
    addReaches(second, a, reaches_.back());
  }
  for (const BesideStatic& beside : beside_static_) {
    static_reaches_.emplace_back();
    addReaches(stage_.model_.element_of[static_cast<std::size_t>(beside.tree)], -1,
               static_reaches_.back());
  }
  from_.resize(stage_.model_.columns.size());
  to_.resize(from_.size());
  lines_.resize(pairs_.size());
}

/// For the joints between the element and the body `up_to`.
void BatchStage::EdgeGroup::addReaches(std::uint32_t element, int up_to,
                                       std::vector<Reach>& reaches) const {
  const CollisionScene& scene = stage_.scene_;
  const RobotModel& robot = scene.robot();
  const SceneElement& of_scene = scene.elements()[element];
  double beyond = 0.0;         // metres: of the element's points from the origin of the body below
  Vector3d origin_B{0, 0, 0};  // of the body below, in that of the joint
  bool is_first = true;
  for (int id = scene.bodies()[of_scene.body].body; id != up_to; id = robot.bodies()[id].parent) {
    const Body& body = robot.bodies()[id];
    if (body.joint < 0) return;
    const Joint& joint = robot.joints()[body.joint];
    double from_axis = joint.axis.cross(origin_B).norm() + beyond,
           from_origin = origin_B.norm() + beyond;
    if (is_first) {
      for (const OuterSphere& sphere : stage_.model_.covers[element].outer) {
        if (sphere.first_child != 0) continue;
        const Vector3d center_B = of_scene.X_BE * sphere.center;
        from_axis = std::max(from_axis, joint.axis.cross(center_B).norm() + sphere.radius);
        from_origin = std::max(from_origin, center_B.norm() + sphere.radius);
      }
      is_first = false;
    }
    if (joint.hasPosition()) {
      const auto& columns = stage_.model_.columns;
      const auto column = std::find_if(columns.begin(), columns.end(),
                                       [&](const auto& one) { return one.joint == body.joint; });
      const bool turns = joint.type != JointType::PRISMATIC;
      reaches.push_back({static_cast<int>(column - columns.begin()), turns ? from_axis : 1.0});
      if (!turns) from_origin += column->most;
    }
    beyond = from_origin;
    origin_B = body.X_PJ.translation();
  }
}

BatchStage::Group::Outcome BatchStage::EdgeGroup::settle(const std::vector<double>& from,
                                                         const std::vector<double>& to) {
  nb_parts_ = 0;
  parts_.clear();
  if (!begin(from, to)) {
    for (int i = 0; i < tables_.nb_pairs; ++i) parts_.push_back({elementsOf(i), false, 0.0, 1.0});
    for (const BesideStatic& beside : beside_static_) {
      const std::uint32_t element = stage_.model_.element_of[static_cast<std::size_t>(beside.tree)];
      parts_.push_back({{element, element}, true, 0.0, 1.0});
    }
    return Outcome::OPEN;
  }
  nb_parts_ = nb_groups_ * lanes();
  for (first_part_ = 0; first_part_ < nb_groups_; ++first_part_) {
    if (meets()) return Outcome::CONTACT;
  }
  return gatherParts();
}

bool BatchStage::EdgeGroup::begin(const std::vector<double>& from, const std::vector<double>& to) {
  const auto& columns = stage_.model_.columns;
  double longest = 0.0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    from_[i] = from[static_cast<std::size_t>(columns[i].joint)];
    to_[i] = to[static_cast<std::size_t>(columns[i].joint)];
    if (!(std::max(std::abs(from_[i]), std::abs(to_[i])) <= columns[i].most)) return false;
    longest = std::max(longest, std::abs(to_[i] - from_[i]));
  }
  const double nb_groups = std::ceil(longest / (LONGEST_PART * lanes()));
  if (!(nb_groups <= MOST_GROUPS)) return false;
  nb_groups_ = std::max(1, static_cast<int>(nb_groups));
  noted_.clear();
  line_in_contact_ = -1;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const BatchPair& of_model = stage_.model_.pairs[i];
    BatchPair& pair = pairs_[i];
    const auto rootOf = [&](int sphere) {
      return tables_.spheres[static_cast<std::size_t>(sphere)].radius;
    };
    pair.outer_padding = of_model.outer_padding + static_cast<float>(widthOf(reaches_[i]));
    const float reach = rootOf(pair.first_root) + rootOf(pair.second_root) + pair.outer_padding;
    pair.squared_reach = reach * reach;
    lines_[i].is_known = false;
  }
  for (std::size_t i = 0; i < beside_static_.size(); ++i) {
    beside_static_[i].outer_padding =
        stage_.beside_static_[i].outer_padding + widthOf(static_reaches_[i]);
  }
  return true;
}

/// Metres by which spheres at the middle of a part have to be further apart.
double BatchStage::EdgeGroup::widthOf(const std::vector<Reach>& reaches) const {
  double width = 0.0;
  for (const Reach& reach : reaches) {
    const auto column = static_cast<std::size_t>(reach.column);
    width += std::abs(to_[column] - from_[column]) * reach.metres;
  }
  return (0.5 * width / (nb_groups_ * lanes()) + PairTable::APART) * (1.0 + RELATIVE_MARGIN);
}

/// Parts first_part_, first_part_ + nb_groups_, …: spread over the motion, so that a contact is
/// found early. True: one is in contact.
bool BatchStage::EdgeGroup::meets() {
  clear();
  for (int lane = 0; lane < lanes(); ++lane) {
    const double middle = fractionAt(lane, 0.5);
    for (std::size_t i = 0; i < from_.size(); ++i) {
      positions_[i * static_cast<std::size_t>(lanes()) + static_cast<std::size_t>(lane)] =
          from_[i] + middle * (to_[i] - from_[i]);
    }
  }
  set_ = (1u << lanes()) - 1u;
  Group::settle();
  for (int lane = 0; lane < lanes(); ++lane) {
    if (outcome(lane) != Outcome::CONTACT) continue;
    contact_ = Group::contact(lane);
    contact_at_ = fractionAt(lane, 0.5);
    if (line_in_contact_ >= 0) {
      contact_ = elementsOf(line_in_contact_);
      contact_at_ = lines_[static_cast<std::size_t>(line_in_contact_)].along.begin;
    }
    return true;
  }
  const auto note = [&](int index, unsigned of_lanes) {
    for (; of_lanes != 0; of_lanes &= of_lanes - 1) {
      noted_.push_back({index, first_part_ + __builtin_ctz(of_lanes) * nb_groups_});
    }
  };
  for (int i = 0; i < nb_open_; ++i) {
    const OpenBatchPair& open = open_[static_cast<std::size_t>(i)];
    note(open.pair, open.lanes);
  }
  for (const OpenTree& open : open_static_) {
    const auto beside = std::find_if(beside_static_.begin(), beside_static_.end(),
                                     [&](const auto& one) { return one.tree == open.tree; });
    note(tables_.nb_pairs + static_cast<int>(beside - beside_static_.begin()), open.lanes);
  }
  return false;
}

/// Adjacent parts are one.
BatchStage::Group::Outcome BatchStage::EdgeGroup::gatherParts() {
  std::sort(noted_.begin(), noted_.end());
  for (std::size_t i = 0; i < noted_.size();) {
    const auto [index, first] = noted_[i];
    int last = first;
    for (++i; i < noted_.size() && noted_[i].index == index && noted_[i].part == last + 1; ++i) {
      ++last;
    }
    Part part{{},
              index >= tables_.nb_pairs,
              static_cast<double>(first) / nb_parts_,
              (last + 1.0) / nb_parts_};
    if (part.is_static) {
      const BesideStatic& beside =
          beside_static_[static_cast<std::size_t>(index - tables_.nb_pairs)];
      part.pair.first = stage_.model_.element_of[static_cast<std::size_t>(beside.tree)];
    } else {
      part.pair = elementsOf(index);
      const Line& line = lines_[static_cast<std::size_t>(index)];
      if (line.is_known) {
        part.begin = std::max(part.begin, line.along.begin);
        part.end = std::min(part.end, line.along.end);
      }
    }
    if (part.begin <= part.end) parts_.push_back(part);
  }
  return parts_.empty() ? Outcome::FREE : Outcome::OPEN;
}

unsigned BatchStage::EdgeGroup::lookUp(int pair, unsigned lanes, unsigned* certain) {
  Line& line = lines_[static_cast<std::size_t>(pair)];
  if (!line.is_known) {
    const auto columns = table_columns_[static_cast<std::size_t>(pair)];
    double from[2] = {}, to[2] = {};
    for (std::size_t i = 0; i < 2; ++i) {
      if (columns[i] < 0) continue;
      from[i] = from_[static_cast<std::size_t>(columns[i])];
      to[i] = to_[static_cast<std::size_t>(columns[i])];
    }
    line.along = pair_tables_[static_cast<std::size_t>(pair)]->along(from, to, narrow_phase_);
    line.is_known = true;
  }
  switch (line.along.cell) {
    case PairTable::Cell::FREE:
      return 0;
    case PairTable::Cell::CONTACT:
      line_in_contact_ = pair;
      *certain = lanes;
      return 0;
    case PairTable::Cell::OPEN:
      break;
  }
  unsigned open = lanes;
  for (; lanes != 0; lanes &= lanes - 1) {
    const int lane = __builtin_ctz(lanes);
    const bool is_open =
        fractionAt(lane, 0.0) <= line.along.end && fractionAt(lane, 1.0) >= line.along.begin;
    if (!is_open) open &= ~(1u << lane);
  }
  return open;
}

}  // namespace collision_pairs
