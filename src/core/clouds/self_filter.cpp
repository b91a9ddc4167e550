#include "collision_pairs/self_filter.h"

#include <algorithm>
#include <cmath>

#include "cells_about_link.h"
#include "collision_pairs/input_error.h"
#include "near_parts.h"
#include "pose_repair.h"
#include "scene_element.h"
#include "scene_members.h"

namespace collision_pairs {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double LEAST_EDGE = 0.02;  // metres, of the cells in which parts are looked up

struct SelfFilter::Store {
  struct Part {
    int body;  ///< index in `bodies`
    int name;  ///< index in `names`
    Isometry3d X_BE;
    CellsAboutLink cells;
  };

  void addPart(const std::string& name, int body, const Isometry3d& X_BE, SceneElement element) {
    if (names.empty() || names.back() != name) names.push_back(name);
    parts.push_back({body, static_cast<int>(names.size()) - 1, X_BE,
                     CellsAboutLink(std::move(element), padding)});
  }

  int indexOf(int robot_body, const std::string& link) {
    const auto found = std::find_if(bodies.begin(), bodies.end(), [&](const SceneBody& known) {
      return known.body == robot_body;
    });
    if (found != bodies.end()) return static_cast<int>(found - bodies.begin());
    bodies.push_back({robot_body, link});
    return static_cast<int>(bodies.size()) - 1;
  }

  double padding = 0.0;
  std::vector<SceneBody> bodies;
  std::vector<std::string> names, left_out;
  std::vector<Part> parts;
  std::vector<Isometry3d> X_EW;  ///< one per part
  NearParts near;
  std::vector<std::uint32_t> open;  ///< parts to which a point may belong
  NarrowPhase narrow_phase;
};

SelfFilter::SelfFilter(const SceneDescription& description, double padding, SceneCache* cache,
                       const std::set<std::string>* only)
    : store_(std::make_unique<Store>()) {
  if (!(padding >= 0.0) || !std::isfinite(padding)) {
    throw InputError("the padding of the self filter is " + std::to_string(padding) +
                     ", but must be 0 or more metres, and finite");
  }
  store_->padding = padding;
  const auto robot = mergedRobot(description);
  checkDescription(description, objectsOf(description), *robot);
  SceneCache of_this_filter;
  ElementMaker& maker = cache ? *cache->maker_ : *of_this_filter.maker_;
  std::vector<std::pair<const Shape*, Fidelity>> wanted;
  const auto forEachOwn = [&](const auto& take) {
    for (const Link& link : robot->links()) take(link.name, link, link.X_BL, link.elements);
    for (const RigidObject& object : description.objects) {
      if (object.attached_link.empty()) continue;
      const Link& link = robot->links()[robot->findLink(object.attached_link)];
      take(object.name, link, link.X_BL * object.X_PO, object.elements);
    }
  };
  forEachOwn([&](const std::string&, const Link&, const Isometry3d&, const auto& elements) {
    for (const Element& element : elements) wanted.emplace_back(&element.shape, Fidelity::MESH);
  });
  const PreparedElements prepared = maker.prepare(wanted, description.settings);
  forEachOwn(
      [&](const std::string& name, const Link& link, const Isometry3d& X_BM, const auto& elements) {
        if (elements.empty()) return;
        const int of_link = robot->bodies()[link.body].link;
        const int body = store_->indexOf(link.body, robot->links()[of_link].name);
        if (only && only->count(name) == 0) return;
        for (const Element& element : elements) {
          store_->addPart(name, body, X_BM * element.X_LE,
                          prepared.make(element.shape, Fidelity::MESH));
        }
      });
  store_->X_EW.resize(store_->parts.size());
}

SelfFilter::~SelfFilter() = default;
SelfFilter::SelfFilter(SelfFilter&&) noexcept = default;
SelfFilter& SelfFilter::operator=(SelfFilter&&) noexcept = default;

const std::vector<SceneBody>& SelfFilter::bodies() const { return store_->bodies; }
const std::vector<std::string>& SelfFilter::leftOut() const { return store_->left_out; }
const std::vector<std::string>& SelfFilter::names() const { return store_->names; }
Aabb SelfFilter::bounds() const { return store_->near.bounds(); }

void SelfFilter::begin(const BodyPoses& poses) {
  Store& store = *store_;
  const std::size_t expected = store.bodies.size();
  if (poses.X_WB.size() != expected || poses.known.size() != expected) {
    throw InputError("poses of " + std::to_string(poses.X_WB.size()) +
                     " bodies were given, but the self filter needs " + std::to_string(expected));
  }
  store.left_out.clear();
  store.near.begin(std::max(LEAST_EDGE, store.padding));
  for (std::size_t i = 0; i < store.parts.size(); ++i) {
    const Store::Part& part = store.parts[i];
    const auto body = static_cast<std::size_t>(part.body);
    Isometry3d X_WB = poses.X_WB[body];
    const bool is_known = poses.known[body] != 0 && repairPose(X_WB);
    const Isometry3d X_WE = X_WB * part.X_BE;
    store.X_EW[i] = X_WE.inverse(Eigen::Isometry);
    if (is_known) {
      store.near.add(part.cells.grownBox().movedBy(X_WE));
      continue;
    }
    store.near.addNothing();
    const std::string& name = store.names[static_cast<std::size_t>(part.name)];
    if (store.left_out.empty() || store.left_out.back() != name) store.left_out.push_back(name);
  }
  store.near.end();
}

// Points of one link are often near the border of the next link's padding, so the stored cells of
// all links are read before any distance is computed.
bool SelfFilter::isOwn(const Vector3d& p_WP) {
  using Points = CellsAboutLink::Points;
  Store& store = *store_;
  store.open.clear();
  for (const std::uint32_t i : store.near.at(p_WP)) {
    const Points own = store.parts[i].cells.ownAbout(store.X_EW[i] * p_WP, store.narrow_phase);
    if (own == Points::ALL) return true;
    if (own == Points::SOME) store.open.push_back(i);
  }
  return std::any_of(store.open.begin(), store.open.end(), [&](std::uint32_t i) {
    return store.parts[i].cells.isOwn(store.X_EW[i] * p_WP, store.narrow_phase);
  });
}

bool SelfFilter::mayBeOwn(const Vector3d& p_WP) {
  Store& store = *store_;
  const auto parts = store.near.at(p_WP);
  return std::any_of(parts.begin(), parts.end(), [&](std::uint32_t i) {
    return store.parts[i].cells.ownAbout(store.X_EW[i] * p_WP, store.narrow_phase) !=
           CellsAboutLink::Points::NONE;
  });
}

SelfFilter::Nearest SelfFilter::nearest(const Vector3d& p_WP, const std::set<std::string>* only) {
  Store& store = *store_;
  Nearest found{"", 0, store.padding};
  for (const std::uint32_t i : store.near.at(p_WP)) {
    const Store::Part& part = store.parts[i];
    const std::string& name = store.names[static_cast<std::size_t>(part.name)];
    if (only && only->count(name) == 0) continue;
    const double metres =
        part.cells.distance(store.X_EW[i] * p_WP, store.padding, store.narrow_phase);
    if (metres > found.distance || (metres == found.distance && !found.name.empty())) continue;
    found = {name, static_cast<std::size_t>(part.body), metres};
  }
  return found;
}

}  // namespace collision_pairs
