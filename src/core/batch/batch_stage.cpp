#include "batch_stage.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr std::size_t ALIGNMENT = 64;  // bytes
constexpr std::size_t MOST_FIELDS = 8;
constexpr double MARGIN = 2e-9;  // m: far above the rounding of paddings and bounds in double

Vector3d pointOf(const float* lanes, int nb_lanes, int lane) {
  return {lanes[lane], lanes[nb_lanes + lane], lanes[2 * nb_lanes + lane]};
}

/// Calls work(lane) for each bit.
template <class Work>
void forEachLane(unsigned lanes, const Work& work) {
  for (; lanes != 0; lanes &= lanes - 1) work(__builtin_ctz(lanes));
}

}  // namespace

std::unique_ptr<const BatchStage> BatchStage::make(const CollisionScene& scene, Fidelity fidelity,
                                                   const BatchKernel& kernel) {
  if (!BatchModel::whyNot(scene, fidelity).empty()) return nullptr;
  std::unique_ptr<BatchStage> stage(new BatchStage(scene, fidelity, kernel));
  if (!stage->addFields()) return nullptr;
  return stage;
}

BatchStage::BatchStage(const CollisionScene& scene, Fidelity fidelity, const BatchKernel& kernel)
    : scene_(scene),
      fidelity_(fidelity),
      model_(scene, fidelity == Fidelity::MESH),
      solids_(scene, model_),
      kernel_(kernel) {}

Aabb BatchStage::reachOfRobot() const {
  Aabb box = noBox();
  for (std::size_t i = 0; i < model_.spheres.size(); ++i) {
    const BatchSphere& sphere = model_.spheres[i];
    const PoseError& pose = model_.errors[static_cast<std::size_t>(sphere.body)];
    const double reach = pose.reach + Eigen::Vector3f(sphere.center).cast<double>().norm() + 0.01;
    box = enclosing(box, {Vector3d::Constant(-reach), Vector3d::Constant(reach)});
  }
  return box;
}

bool BatchStage::addFields() {
  const std::uint32_t nb_static = scene_.nbStaticElements();
  if (nb_static > StaticField::MOST_ELEMENTS) return false;
  std::map<std::vector<std::uint32_t>, int> field_of;
  for (std::size_t tree = 0; tree < model_.trees.size(); ++tree) {
    const std::uint32_t element = model_.element_of[tree];
    BesideStatic made{static_cast<int>(tree), 0, 0.0, 0.0};
    std::vector<std::uint32_t> beside;
    for (std::uint32_t i = 0; i < nb_static; ++i) {
      const auto& elements = scene_.elements();
      if (!scene_.filter().allowed(elements[element].model, elements[i].model)) continue;
      const double padding = scene_.padding(element, i);
      made.outer_padding = std::max(made.outer_padding, padding);
      made.inner_padding = beside.empty() ? padding : std::min(made.inner_padding, padding);
      beside.push_back(i);
    }
    if (beside.empty()) continue;
    made.field = field_of.try_emplace(beside, static_cast<int>(field_of.size())).first->second;
    if (made.field == static_cast<int>(fields_.size())) {
      if (fields_.size() == MOST_FIELDS) return false;
      const Aabb region = reachOfRobot();
      fields_.push_back(std::make_unique<StaticField>(scene_, model_, std::move(beside), region));
    }
    beside_static_.push_back(made);
  }
  return true;
}

std::size_t BatchStage::memory() const {
  return model_.memory() + solids_.memory() + fields_.size() * StaticField::memory();
}

BatchStage::Group::Group(const BatchStage& stage)
    : stage_(stage),
      tables_(stage.model_.tables()),
      pairs_(stage.model_.pairs),
      beside_static_(stage.beside_static_) {
  tables_.pairs = pairs_.data();
  const auto nb_lanes = static_cast<std::size_t>(lanes());
  positions_.resize(std::max<std::size_t>(1, stage.model_.columns.size()) * nb_lanes);
  const std::size_t nb_spheres = stage.model_.spheres.size();
  floats_.resize((12 * stage.model_.bodies.size() + 3 * nb_spheres) * nb_lanes +
                 ALIGNMENT / sizeof(float));
  placed_.resize(nb_spheres, 0);
  open_.resize(stage.model_.pairs.size());
  for (const BatchPair& pair : stage.model_.pairs) addTable(pair);
  clear();
}

void BatchStage::Group::addTable(const BatchPair& pair) {
  pair_tables_.emplace_back();
  table_columns_.push_back({-1, -1});
  if (!pair.has_table) return;
  const auto index = static_cast<int>(pair_tables_.size()) - 1;
  pair_tables_.back() =
      std::make_unique<PairTable>(stage_.scene_, stage_.model_, elementsOf(index));
  for (int i = 0; i < pair_tables_.back()->nbJoints(); ++i) {
    const auto& columns = stage_.model_.columns;
    const auto column = std::find_if(columns.begin(), columns.end(), [&](const auto& one) {
      return one.joint == pair_tables_.back()->joint(i);
    });
    table_columns_.back()[static_cast<std::size_t>(i)] = static_cast<int>(column - columns.begin());
  }
}

unsigned BatchStage::Group::lookUp(int pair, unsigned lanes, unsigned* certain) {
  PairTable& table = *pair_tables_[static_cast<std::size_t>(pair)];
  const auto& columns = table_columns_[static_cast<std::size_t>(pair)];
  unsigned open = 0;
  forEachLane(lanes, [&](int lane) {
    const auto position = [&](int column) {
      return column < 0 ? 0.0 : positions_[static_cast<std::size_t>(column * this->lanes() + lane)];
    };
    const PairTable::Cell cell = table.at(position(columns[0]), position(columns[1]), narrow_phase_);
    if (cell == PairTable::Cell::OPEN) open |= 1u << lane;
    if (cell == PairTable::Cell::CONTACT) *certain |= 1u << lane;
  });
  return open;
}

void BatchStage::Group::clear() {
  set_ = 0;
  nb_open_ = 0;
  open_static_.clear();
  std::fill(std::begin(outcomes_), std::end(outcomes_), Outcome::OPEN);
}

bool BatchStage::Group::set(int lane, const std::vector<double>& positions) {
  stage_.scene_.robot().requireOneEntryPerJoint(positions);
  const auto& columns = stage_.model_.columns;
  double* const to = positions_.data() + lane;
  bool is_near = true;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double position = positions[static_cast<std::size_t>(columns[i].joint)];
    is_near &= std::abs(position) <= columns[i].most;
    to[i * static_cast<std::size_t>(lanes())] = position;
  }
  if (is_near) set_ |= 1u << lane;
  return is_near;
}

BatchLanes BatchStage::Group::arrays() {
  const auto address = reinterpret_cast<std::uintptr_t>(floats_.data());
  const std::size_t beside = (ALIGNMENT - address % ALIGNMENT) % ALIGNMENT / sizeof(float);
  float* const poses = floats_.data() + beside;
  float* const centers =
      poses + 12 * stage_.model_.bodies.size() * static_cast<std::size_t>(lanes());
  const auto look_up = [](void* group, int pair, unsigned of_lanes, unsigned* certain) {
    return static_cast<Group*>(group)->lookUp(pair, of_lanes, certain);
  };
  return {positions_.data(), poses, centers, placed_.data(), group_, look_up, this};
}

void BatchStage::Group::settle() {
  if (set_ == 0) return;
  if (++group_ == 0) {  // once in 2^32 groups
    std::fill(placed_.begin(), placed_.end(), 0);
    group_ = 1;
  }
  // Lanes without a state get a copy of one, so that all angles are in range.
  const int example = __builtin_ctz(set_);
  for (std::size_t i = 0; i < positions_.size(); i += static_cast<std::size_t>(lanes())) {
    for (int lane = 0; lane < lanes(); ++lane) {
      if ((set_ >> lane & 1u) == 0) positions_[i + lane] = positions_[i + example];
    }
  }
  stage_.kernel_.place(tables_, arrays());
  unsigned lanes = set_;
  lanes &= ~settlePairs(lanes);
  if (one_contact_will_do_ && lanes != set_) return;
  lanes &= ~settleStatic(lanes);
  for (int i = 0; i < nb_open_; ++i) lanes &= ~open_[static_cast<std::size_t>(i)].lanes;
  for (const OpenTree& open : open_static_) lanes &= ~open.lanes;
  forEachLane(lanes, [&](int lane) { outcomes_[lane] = Outcome::FREE; });
}

unsigned BatchStage::Group::settlePairs(unsigned lanes) {
  int pairs[MOST_BATCH_LANES];
  std::fill(std::begin(pairs), std::end(pairs), -1);
  nb_open_ = stage_.kernel_.settle(tables_, arrays(), lanes, open_.data(), pairs);
  unsigned in_contact = 0;
  forEachLane(lanes, [&](int lane) {
    if (pairs[lane] < 0) return;
    in_contact |= 1u << lane;
    outcomes_[lane] = Outcome::CONTACT;
    contacts_[lane] = elementsOf(pairs[lane]);
  });
  return in_contact;
}

unsigned BatchStage::Group::settleStatic(unsigned lanes) {
  unsigned in_contact = 0;
  for (const BesideStatic& beside : beside_static_) {
    unsigned open = openBesideStatic(beside, lanes & ~in_contact);
    if (open == 0) continue;
    const unsigned touching = contactWithStatic(beside, open);
    in_contact |= touching;
    if (one_contact_will_do_ && touching != 0) return touching;
    if (open != touching) open_static_.push_back({beside.tree, open & ~touching});
  }
  return in_contact;
}

unsigned BatchStage::Group::openBesideStatic(const BesideStatic& beside, unsigned lanes) {
  struct Step {
    int sphere;  // in the tree
    unsigned lanes;
  };
  const BatchTree& tree = tables_.trees[beside.tree];
  const StaticField& field = *stage_.fields_[static_cast<std::size_t>(beside.field)];
  const BatchGrid grid = field.grid();
  Step stack[32];  // the path to a leaf leaves at most one step per sphere
  int depth = 0;
  stack[depth++] = {tree.first_outer, lanes};
  unsigned open = 0;
  while (depth > 0) {
    Step step = stack[--depth];
    step.lanes &= ~open;
    if (step.lanes == 0) continue;
    const BatchSphere& sphere = tables_.spheres[step.sphere];
    const float* const centers = centersOf(step.sphere);
    const double reach = sphere.radius + beside.outer_padding + MARGIN;
    const auto above = std::nextafter(static_cast<float>(reach), std::numeric_limits<float>::max());
    unsigned near =
        step.lanes & ~stage_.kernel_.further(tables_, arrays(), step.sphere, grid, above);
    forEachLane(near, [&](int lane) {
      if (field.isFurther(pointOf(centers, this->lanes(), lane), reach)) near &= ~(1u << lane);
    });
    if (near == 0) continue;
    if (sphere.first_child == 0) {
      open |= near;
    } else {
      stack[depth++] = {sphere.first_child, near};
      stack[depth++] = {sphere.first_child + 1, near};
    }
  }
  return open;
}

unsigned BatchStage::Group::contactWithStatic(const BesideStatic& beside, unsigned lanes) {
  const BatchTree& tree = tables_.trees[beside.tree];
  const StaticField& field = *stage_.fields_[static_cast<std::size_t>(beside.field)];
  unsigned in_contact = 0;
  for (int i = 0; i < tree.nb_inner; ++i) {
    const int sphere = tree.first_inner + i;
    const double reach = tables_.spheres[sphere].radius + beside.inner_padding - MARGIN;
    forEachLane(lanes & ~in_contact, [&](int lane) {
      std::uint32_t element = 0;
      if (!field.isNearer(pointOf(centersOf(sphere), this->lanes(), lane), reach, element)) return;
      in_contact |= 1u << lane;
      outcomes_[lane] = Outcome::CONTACT;
      contacts_[lane] = {element, stage_.model_.element_of[static_cast<std::size_t>(beside.tree)]};
    });
    if (one_contact_will_do_ && in_contact != 0) break;
  }
  return in_contact;
}

const float* BatchStage::Group::centersOf(int sphere) {
  return stage_.kernel_.center(tables_, arrays(), sphere);
}

BoxPair BatchStage::Group::elementsOf(int pair) const {
  const BatchPair& of_model = stage_.model_.pairs[static_cast<std::size_t>(pair)];
  return {stage_.model_.element_of[static_cast<std::size_t>(of_model.first)],
          stage_.model_.element_of[static_cast<std::size_t>(of_model.second)]};
}

void BatchStage::Group::openPairs(int lane, std::vector<BoxPair>& pairs) const {
  pairs.clear();
  for (int i = 0; i < nb_open_; ++i) {
    const OpenBatchPair& open = open_[static_cast<std::size_t>(i)];
    if (open.lanes >> lane & 1u) pairs.push_back(elementsOf(open.pair));
  }
}

void BatchStage::Group::openBesideStatic(int lane, std::vector<std::uint32_t>& elements) const {
  elements.clear();
  for (const OpenTree& open : open_static_) {
    if ((open.lanes >> lane & 1u) == 0) continue;
    elements.push_back(stage_.model_.element_of[static_cast<std::size_t>(open.tree)]);
  }
}

}  // namespace collision_pairs
