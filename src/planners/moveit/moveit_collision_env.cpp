#include "moveit_collision_env.h"

#include <algorithm>

#include <geometric_shapes/shapes.h>

#include "moveit_check.h"
#include "moveit_motion.h"

namespace collision_pairs {
namespace {

constexpr std::size_t MAX_SCENES = 16;

/// What all environments of a process share, so that each mesh is prepared once. Never destroyed:
/// environments may outlive what is static.
struct Shared {
  SceneCache scenes;
  MoveitShapes shapes;
};
Shared& shared() {
  static auto* all = new Shared;
  return *all;
}

template <class Shapes, class Poses>
std::vector<Element> scaledElements(const Shapes& parts, const Poses& poses, double scale) {
  std::vector<Element> elements;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    shared().shapes.append(parts[i], scale, poses[i], elements);
  }
  return elements;
}

void warnOfProblem(const std::string& problem) {
  warnRarely("cannot be checked, and so taken for a collision: " + problem);
}

/// False if it throws, which MoveIt does not expect of a detector: a warning says why.
template <class Do>
bool isDone(const Do& act) {
  try {
    act();
    return true;
  } catch (const std::exception& problem) {
    warnOfProblem(problem.what());
    return false;
  }
}

}  // namespace

bool MoveitCollisionEnv::Attached::is(const moveit::core::AttachedBody& body) const {
  const auto& poses = body.getShapePoses();
  const auto& parts = body.getShapes();
  return name == body.getName() && link == body.getAttachedLink() &&
         touch_links == body.getTouchLinks() &&
         std::equal(X_OE.begin(), X_OE.end(), poses.begin(), poses.end(),
                    [](const auto& a, const auto& b) { return a.matrix() == b.matrix(); }) &&
         std::equal(shapes.begin(), shapes.end(), parts.begin(), parts.end(), areAlike);
}

MoveitCollisionEnv::MoveitCollisionEnv(const moveit::core::RobotModelConstPtr& model,
                                       double padding, double scale)
    : CollisionEnv(model, padding, scale) {
  observe();
}

MoveitCollisionEnv::MoveitCollisionEnv(const moveit::core::RobotModelConstPtr& model,
                                       const collision_detection::WorldPtr& world, double padding,
                                       double scale)
    : CollisionEnv(model, world, padding, scale) {
  observe();
}

MoveitCollisionEnv::MoveitCollisionEnv(const MoveitCollisionEnv& other,
                                       const collision_detection::WorldPtr& world)
    : CollisionEnv(other, world) {
  {
    const std::lock_guard<std::mutex> lock(other.mutex_);
    for (const auto& scenes : other.scenes_) scenes_.push_back(std::make_unique<Scenes>(*scenes));
    octrees_ = other.octrees_;
  }
  observe();
}

MoveitCollisionEnv::~MoveitCollisionEnv() { getWorld()->removeObserver(observer_); }

void MoveitCollisionEnv::observe() {
  observer_ = getWorld()->addObserver(
      [this](const World::ObjectConstPtr& object, World::Action) { noteChange(object->id_); });
  if (!scenes_.empty()) return;
  // Meshes are prepared now and not by the first check.
  scenes_.push_back(std::make_unique<Scenes>());
  makeScenes(*scenes_.back());
  for (const auto& [name, object] : *getWorld()) noteChange(name);
}

void MoveitCollisionEnv::setWorld(const collision_detection::WorldPtr& world) {
  if (world == getWorld()) return;
  getWorld()->removeObserver(observer_);
  CollisionEnv::setWorld(world);
  scenes_.clear();
  octrees_.clear();
  observe();
}

void MoveitCollisionEnv::updatedPaddingOrScaling(const std::vector<std::string>&) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto& scenes : scenes_) makeScenes(*scenes);
}

void MoveitCollisionEnv::noteChange(const std::string& name) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto& scenes : scenes_) scenes->changed.insert(name);
  octrees_.erase(name);
  const auto object = getWorld()->getObject(name);
  if (!object) return;
  for (const auto& shape : object->shapes_) {
    if (shape->type == shapes::OCTREE) octrees_.insert(name);
  }
}

std::vector<MoveitOctree> MoveitCollisionEnv::octreesOfWorld() const {
  std::vector<MoveitOctree> octrees;
  for (const std::string& name : octrees_) {
    const auto object = getWorld()->getObject(name);
    for (std::size_t i = 0; object && i < object->shapes_.size(); ++i) {
      if (object->shapes_[i]->type != shapes::OCTREE) continue;
      const auto& tree = static_cast<const shapes::OcTree&>(*object->shapes_[i]).octree;
      if (tree) octrees.push_back({name, tree, object->global_shape_poses_[i]});
    }
  }
  return octrees;
}

MovingBody MoveitCollisionEnv::movingLink(const moveit::core::LinkModel& link) const {
  const std::string& name = link.getName();
  return {{name, link.getLinkIndex(), false, {}},
          scaledElements(link.getShapes(), link.getCollisionOriginTransforms(), getLinkScale(name)),
          getLinkPadding(name)};
}

MovingBody MoveitCollisionEnv::movingBody(const Attached& attached) const {
  const std::string& link = attached.link->getName();
  return {{attached.name, attached.link->getLinkIndex(), true, attached.touch_links},
          scaledElements(attached.shapes, attached.X_OE, getLinkScale(link)),
          getLinkPadding(link)};
}

RigidObject MoveitCollisionEnv::rigidObject(const World::Object& object) const {
  RigidObject made;
  made.name = object.id_;
  for (std::size_t i = 0; i < object.shapes_.size(); ++i) {
    const auto& shape = object.shapes_[i];
    if (shape->type == shapes::OCTREE) continue;
    shared().shapes.append(shape, 1.0, object.global_shape_poses_[i], made.elements);
  }
  return made;
}

// The world is made when it is first needed.
void MoveitCollisionEnv::makeScenes(Scenes& scenes) const {
  scenes.self.reset();
  scenes.world.reset();
  scenes.self_problem.clear();
  scenes.moving.clear();
  for (Attached& attached : scenes.attached) attached.leaves = leavesOf(attached.shapes);
  try {
    for (const auto* link : getRobotModel()->getLinkModelsWithCollisionGeometry()) {
      scenes.moving.push_back(movingLink(*link));
    }
    for (const Attached& attached : scenes.attached) {
      MovingBody body = movingBody(attached);
      const bool has_any = !body.elements.empty();  // an octree may be empty
      if (has_any) scenes.moving.push_back(std::move(body));
    }
    const Scenes& of_links = *scenes_.front();
    if (!scenes.attached.empty() && of_links.self) {
      scenes.self = of_links.self->withAttached(scenes.moving, shared().scenes);
    }
    if (!scenes.self) scenes.self = MoveitScene::ofSelf(scenes.moving, shared().scenes);
  } catch (const std::exception& problem) {
    scenes.self_problem = problem.what();
  }
}

void MoveitCollisionEnv::updateWorld(Scenes& scenes) const {
  if (!scenes.self_problem.empty()) {
    scenes.world_problem = scenes.self_problem;
    return;
  }
  if (scenes.world && scenes.changed.empty() && scenes.world->areResolutionsKept()) return;
  const auto elementsOf = [&](const World::Object& object, std::vector<RigidObject>& objects) {
    RigidObject made = rigidObject(object);
    const bool has_any = !made.elements.empty();  // it may be an octree
    if (has_any) objects.push_back(std::move(made));
    return has_any;
  };
  try {
    if (!scenes.world && !scenes.attached.empty()) {
      Scenes& of_links = *scenes_.front();
      updateWorld(of_links);
      if (of_links.world)
        scenes.world = of_links.world->withAttached(scenes.moving, shared().scenes);
      if (scenes.world) scenes.changed.clear();
    }
    if (!scenes.world) {
      std::vector<RigidObject> objects;
      for (const auto& [name, object] : *getWorld()) elementsOf(*object, objects);
      scenes.world = MoveitScene::ofWorld(scenes.moving, std::move(objects), octreesOfWorld(),
                                          shared().scenes);
    } else {
      SceneChanges changes;
      for (const std::string& name : scenes.changed) {
        const auto object = getWorld()->getObject(name);
        const bool is_there = object && elementsOf(*object, changes.objects);
        if (!is_there && scenes.world->hasObject(name)) changes.removed.push_back(name);
      }
      scenes.world = scenes.world->with(changes, octreesOfWorld(), shared().scenes);
    }
    scenes.changed.clear();
    scenes.world_problem.clear();
  } catch (const std::exception& problem) {
    scenes.world.reset();  // the next change may be its repair
    scenes.world_problem = problem.what();
  }
}

MoveitCollisionEnv::Scenes& MoveitCollisionEnv::scenesOf(const State& state) const {
  std::vector<const moveit::core::AttachedBody*> bodies;
  state.getAttachedBodies(bodies);
  ++nb_uses_;
  for (auto& scenes : scenes_) {
    const auto& known = scenes->attached;
    const bool is_it =
        known.size() == bodies.size() &&
        std::equal(known.begin(), known.end(), bodies.begin(),
                   [](const Attached& a, const moveit::core::AttachedBody* b) { return a.is(*b); });
    if (!is_it) continue;
    scenes->last_used = nb_uses_;
    const bool is_as_was = std::all_of(known.begin(), known.end(), [](const Attached& attached) {
      return attached.leaves == leavesOf(attached.shapes);
    });
    if (!is_as_was) makeScenes(*scenes);
    return *scenes;
  }
  if (scenes_.size() == MAX_SCENES) {  // the first, without attached bodies, stays
    scenes_.erase(
        std::min_element(scenes_.begin() + 1, scenes_.end(),
                         [](const auto& a, const auto& b) { return a->last_used < b->last_used; }));
  }
  auto scenes = std::make_unique<Scenes>();
  for (const moveit::core::AttachedBody* body : bodies) {
    const auto& poses = body->getShapePoses();
    scenes->attached.push_back({body->getName(),
                                body->getAttachedLink(),
                                body->getShapes(),
                                {poses.begin(), poses.end()},
                                body->getTouchLinks(),
                                {}});
  }
  makeScenes(*scenes);
  scenes->last_used = nb_uses_;
  scenes_.push_back(std::move(scenes));
  return *scenes_.back();
}

std::shared_ptr<const MoveitScene> MoveitCollisionEnv::sceneFor(const State& state,
                                                                Among among) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Scenes& scenes = scenesOf(state);
  if (among == Among::WORLD) updateWorld(scenes);
  const std::string& problem = among == Among::SELF ? scenes.self_problem : scenes.world_problem;
  if (!problem.empty()) {
    warnOfProblem(problem);
    return nullptr;
  }
  return among == Among::SELF ? scenes.self : scenes.world;
}

std::shared_ptr<const MoveitMotions> MoveitCollisionEnv::motionsFor(const State& state) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Scenes& scenes = scenesOf(state);
  updateWorld(scenes);
  std::string problem = scenes.world_problem;
  std::vector<Eigen::Isometry3d> X_LO;
  for (const MovingBody& one : scenes.moving) {
    if (one.body.is_attached) X_LO.push_back(state.getAttachedBody(one.body.name)->getPose());
  }
  const bool has_them = scenes.motions && scenes.motions->areFor(scenes.world.get(), X_LO);
  if (problem.empty() && !has_them) {
    try {
      scenes.motions = std::make_shared<MoveitMotions>(*getRobotModel(), scenes.moving, X_LO,
                                                       scenes.world, shared().scenes);
    } catch (const std::exception& why) {
      problem = why.what();
    }
  }
  if (problem.empty()) return scenes.motions;
  warnOfProblem(problem);
  return nullptr;
}

void MoveitCollisionEnv::checkMotion(const CollisionRequest& req, CollisionResult& res,
                                     const State& state1, const State& state2,
                                     const Matrix* acm) const {
  if (req.distance) warnRarely("distances between two states are not computed");
  const auto motions = motionsFor(state1);
  const bool are_alike = motions && motions == motionsFor(state2);
  if (motions && !are_alike) {
    warnOfProblem("the two states of a motion differ in what is attached");
  }
  const bool is_checked =
      are_alike && isDone([&] { motions->check(state1, state2, limitsOf(req, acm), req, res); });
  if (!is_checked) res.collision = true;
  if (req.distance && res.collision) res.distance = std::min(res.distance, 0.0);
}

MoveitLimits MoveitCollisionEnv::limitsOf(const CollisionRequest& req, const Matrix* acm) const {
  const auto& robot = *getRobotModel();
  if (!robot.hasJointModelGroup(req.group_name)) return {acm, {}};
  const auto* group = robot.getJointModelGroup(req.group_name);
  return {acm, activeLinks(robot, &group->getUpdatedLinkModelsSet())};
}

void MoveitCollisionEnv::check(const CollisionRequest& req, CollisionResult& res,
                               const State& state, const Matrix* acm, Among among) const {
  const auto scene = sceneFor(state, among);
  const bool is_checked =
      scene && isDone([&] { addCollisions(*scene, state, limitsOf(req, acm), req, res); });
  if (!is_checked) res.collision = true;
  if (!req.distance) return;
  DistanceRequest distance;
  distance.group_name = req.group_name;
  distance.acm = acm;
  distance.enableGroup(getRobotModel());
  DistanceResult found;
  measure(distance, found, state, among);
  // That of another check with the same result may be smaller.
  if (found.minimum_distance.distance >= res.distance) return;
  res.distance = found.minimum_distance.distance;
  if (req.detailed_distance) res.distance_result = found;
}

void MoveitCollisionEnv::measure(const DistanceRequest& req, DistanceResult& res,
                                 const State& state, Among among) const {
  const auto scene = sceneFor(state, among);
  const bool is_checked = scene && isDone([&] {
                            const auto links =
                                activeLinks(*getRobotModel(), req.active_components_only);
                            addDistances(*scene, state, {req.acm, links}, req, res);
                          });
  if (is_checked) return;
  res.collision = true;
  res.minimum_distance.distance = std::min(res.minimum_distance.distance, 0.0);
}

}  // namespace collision_pairs
