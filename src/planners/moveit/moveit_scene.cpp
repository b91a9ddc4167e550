#include "moveit_scene.h"

#include <algorithm>
#include <map>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

constexpr char PLACEHOLDER[] = "placeholder of collision_pairs";
constexpr std::size_t MAX_SELECTIONS = 16;  // more groups than that take turns
constexpr std::size_t NB_ANCHORS = 8;

// Each body is a robot of one link. Names of objects are MoveIt's: one that is called as a body
// here is refused. The first robot has anchors besides: empty links, each with a pose of its own,
// for attached bodies that come and go as objects attached to them.
std::string prefixOf(const MoveitBody& body) {
  return (body.is_attached ? "attached body: " : "link of the robot: ") + body.name;
}

std::string modelName(const MoveitBody& body) { return withPrefix(prefixOf(body), "body"); }

std::string anchorName(std::size_t i) { return "anchor " + std::to_string(i); }

std::shared_ptr<const RobotModel> robotWith(std::size_t nb_anchors) {
  std::vector<Link> links(1 + nb_anchors);
  links[0].name = "body";
  std::vector<Joint> joints(nb_anchors);
  for (std::size_t i = 0; i < nb_anchors; ++i) {
    joints[i].name = links[1 + i].name = anchorName(i);
    joints[i].type = JointType::FLOATING;
    joints[i].parent_link = 0;
    joints[i].child_link = static_cast<int>(1 + i);
  }
  return RobotModel::fromParts("robot", std::move(links), std::move(joints));
}

SceneRobot robotOf(const MovingBody& moving, bool is_first) {
  static const auto robot = robotWith(0), with_anchors = robotWith(NB_ANCHORS);
  const auto elementsOf = [&](const Link& link) {
    return link.name == "body" ? moving.elements : std::vector<Element>();
  };
  return {(is_first ? with_anchors : robot)->withElements(elementsOf), Srdf{},
          prefixOf(moving.body)};
}

SceneDescription descriptionOf(const std::vector<MovingBody>& moving) {
  SceneDescription description;
  for (const MovingBody& one : moving) {
    description.robots.push_back(robotOf(one, description.robots.empty()));
    if (one.padding > 0.0) description.settings.link_padding[modelName(one.body)] = one.padding;
  }
  description.settings.allow_empty_scene = true;  // as MoveIt: nothing to collide with is free
  return description;
}

std::string whyRefused(const std::string& object) {
  return "an object may not be called '" + object + "': the name is taken, as by an attached body";
}

RigidObject placeholder() {
  RigidObject object;
  object.name = PLACEHOLDER;
  object.elements.push_back({Sphere{0.0}, Eigen::Isometry3d::Identity()});
  object.X_PO.translation().z() = -100.0;  // where no box of a robot is
  return object;
}

}  // namespace

MoveitScene::Ptr MoveitScene::ofSelf(const std::vector<MovingBody>& moving, SceneCache& cache) {
  std::shared_ptr<MoveitScene> made(
      new MoveitScene(CollisionScene::build(descriptionOf(moving), &cache), 0, false));
  made->setMoving(moving);
  return made;
}

MoveitScene::Ptr MoveitScene::ofWorld(const std::vector<MovingBody>& moving,
                                      std::vector<RigidObject> objects,
                                      const std::vector<MoveitOctree>& octrees, SceneCache& cache) {
  SceneDescription description = descriptionOf(moving);
  description.check_self = false;
  const std::size_t nb_objects = objects.size();
  description.objects = std::move(objects);
  description.objects.push_back(placeholder());
  std::shared_ptr<MoveitScene> made(
      new MoveitScene(CollisionScene::build(std::move(description), &cache), nb_objects, true));
  made->setMoving(moving);
  made->setOctrees(octrees, {}, cache);
  return made;
}

MoveitScene::Ptr MoveitScene::with(const SceneChanges& changes,
                                   const std::vector<MoveitOctree>& octrees,
                                   SceneCache& cache) const {
  for (const RigidObject& object : changes.objects) refuseTakenName(object.name);
  auto scene = scene_->with(changes, &cache);
  const std::size_t nb_objects = nb_objects_ + scene->objects().size() - scene_->objects().size();
  std::shared_ptr<MoveitScene> made(new MoveitScene(std::move(scene), nb_objects, true));
  made->moving_ = moving_;  // its order is that of the names
  made->setOctrees(octrees, octrees_, cache);
  return made;
}

MoveitScene::Ptr MoveitScene::withAttached(const std::vector<MovingBody>& moving,
                                           SceneCache& cache) const {
  if (moving.empty() || moving[0].body.is_attached) return nullptr;
  SceneChanges changes;
  for (const MovingBody& one : moving) {
    if (!one.body.is_attached) continue;
    RigidObject object;
    object.name = modelName(one.body);
    object.elements = one.elements;
    object.attached_link = withPrefix(prefixOf(moving[0].body), anchorName(changes.objects.size()));
    object.padding = one.padding;
    if (hasObject(object.name)) throw InputError(whyRefused(object.name));
    changes.objects.push_back(std::move(object));
  }
  if (changes.objects.size() > NB_ANCHORS) return nullptr;
  std::shared_ptr<MoveitScene> made(
      new MoveitScene(scene_->with(changes, &cache), nb_objects_, is_world_));
  made->setMoving(moving);
  std::vector<MoveitOctree> octrees;
  for (const Ptr& of_links : octrees_) octrees.push_back(*of_links->octree_);
  made->setOctrees(octrees, {}, cache);
  return made;
}

void MoveitScene::setMoving(const std::vector<MovingBody>& moving) {
  std::map<std::string, const MovingBody*> by_link;
  std::size_t nb_attached = 0;
  for (const MovingBody& one : moving) {
    by_link[modelName(one.body)] = &one;
    if (!one.body.is_attached) continue;
    by_link[withPrefix(prefixOf(moving[0].body), anchorName(nb_attached++))] = &one;
  }
  auto bodies = std::make_shared<std::vector<MoveitBody>>();
  for (const SceneBody& body : scene_->bodies()) bodies->push_back(by_link.at(body.link)->body);
  moving_ = std::move(bodies);
}

void MoveitScene::setOctrees(const std::vector<MoveitOctree>& wanted,
                             const std::vector<Ptr>& before, SceneCache& cache) {
  if (scene_->bodies().empty()) return;
  std::map<double, std::shared_ptr<const CollisionScene>> scenes;  // by resolution
  for (const Ptr& known : before) scenes[known->resolution_] = known->scene_;
  for (const MoveitOctree& octree : wanted) {
    const double resolution = octree.tree->getResolution();
    const auto same = std::find_if(before.begin(), before.end(), [&](const Ptr& known) {
      return known->resolution_ == resolution && known->octree_->object == octree.object &&
             known->octree_->tree == octree.tree &&
             known->octree_->X_WO.matrix() == octree.X_WO.matrix();
    });
    if (same != before.end()) {
      octrees_.push_back(*same);
      continue;
    }
    auto& scene = scenes[resolution];
    if (!scene) scene = sceneOfLeaves(resolution, cache);
    std::shared_ptr<MoveitScene> made(new MoveitScene(scene, 1, true));
    made->moving_ = moving_;
    made->octree_ = octree;
    made->resolution_ = resolution;
    made->X_WO_ = octree.X_WO;
    auto R_WO = made->X_WO_.linear();
    R_WO = Eigen::Quaterniond(octree.X_WO.linear()).normalized().toRotationMatrix();
    if (!R_WO.isApprox(octree.X_WO.linear(), 1e-6)) {  // true for NaN
      throw InputError("the octree of object '" + octree.object + "' has no rotation as its pose");
    }
    octrees_.push_back(std::move(made));
  }
}

std::shared_ptr<const CollisionScene> MoveitScene::sceneOfLeaves(double resolution,
                                                                 SceneCache& cache) const {
  SceneDescription description = scene_->description();
  for (const auto& object : scene_->objects()) {
    if (!isOfWorld(*object)) description.objects.push_back(*object);
  }
  for (int level = 0; level < NB_OCTREE_LEVELS; ++level) {
    const std::string name = "leaves of level " + std::string(1, static_cast<char>('a' + level));
    description.clouds.push_back(cloudOf(name, edgeOfLeaf(resolution, level), {}));
  }
  return CollisionScene::build(std::move(description), &cache);
}

MoveitScene::Ptr MoveitScene::ofBoxes(const std::vector<OctreeLeaf>& leaves) const {
  RigidObject object;
  object.name = "leaves";
  appendBoxes(resolution_, leaves, Eigen::Isometry3d::Identity(), object.elements);
  std::shared_ptr<MoveitScene> made(
      new MoveitScene(scene_->with({{std::move(object)}, {}}), nb_objects_, true));
  made->moving_ = moving_;
  made->octree_ = octree_;
  made->is_of_boxes_ = true;
  made->resolution_ = resolution_;
  made->X_WO_ = X_WO_;
  return made;
}

bool MoveitScene::areResolutionsKept() const {
  return std::all_of(octrees_.begin(), octrees_.end(), [](const Ptr& octree) {
    return octree->octree_->tree->getResolution() == octree->resolution_;
  });
}

void MoveitScene::toOctree(BodyPoses& poses_W) const {
  const Eigen::Isometry3d X_OW = X_WO_.inverse();
  for (Eigen::Isometry3d& X : poses_W.X_WB) X = X_OW * X;
  poses_W.voxels = voxelsOf(resolution_, {});
}

void MoveitScene::toWorld(Contact& contact_O) const {
  contact_O.p_WFirst = X_WO_ * contact_O.p_WFirst;
  contact_O.p_WSecond = X_WO_ * contact_O.p_WSecond;
  contact_O.nhat_W = X_WO_.linear() * contact_O.nhat_W;
}

std::vector<OctreeLeaf> MoveitScene::leavesWithin(double reach,
                                                  std::shared_ptr<const PairSelection> selection,
                                                  Worker& worker) const {
  worker.poses.voxels = voxelsOf(resolution_, {});  // unless they are known it is UNKNOWN
  CheckSettings settings;
  settings.verdict_only = true;
  settings.selection = std::move(selection);
  settings.list_boxes = true;
  settings.ignore_revision = worker.revision;  // so that the next check has its answers still
  const CollisionReport& report = worker.detector.detect(worker.poses, settings);
  return collision_pairs::leavesWithin(*octree_->tree, report.boxes, reach);
}

bool MoveitScene::hasPairs() const {
  if (octree_ && !octree_->tree->getRoot()) return false;
  return !scene_->models().empty() && (!is_world_ || nb_objects_ > 0);
}

const RigidObject* MoveitScene::findObject(const std::string& name) const {
  const auto& objects = scene_->objects();
  const auto found = std::lower_bound(
      objects.begin(), objects.end(), name,
      [](const auto& object, const std::string& wanted) { return object->name < wanted; });
  return found != objects.end() && (*found)->name == name ? found->get() : nullptr;
}

bool MoveitScene::hasObject(const std::string& name) const {
  const RigidObject* object = findObject(name);
  return object && isOfWorld(*object);
}

void MoveitScene::refuseTakenName(const std::string& name) const {
  const RigidObject* object = findObject(name);
  if (object && !isOfWorld(*object)) throw InputError(whyRefused(name));
}

bool MoveitScene::isOfWorld(const RigidObject& object) {
  return object.attached_link.empty() && !isPlaceholder(object.name);
}

bool MoveitScene::isAsked(const CollisionModel& a, const CollisionModel& b) const {
  if (a.body >= 0 && b.body >= 0) return !is_world_;
  return !(a.body < 0 && isPlaceholder(a.name)) && !(b.body < 0 && isPlaceholder(b.name));
}

bool MoveitScene::isPlaceholder(const std::string& object) { return object == PLACEHOLDER; }

std::shared_ptr<const PairSelection> MoveitScene::selectionOf(
    const std::vector<char>& is_active) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [links, selection] : selections_) {
    if (links == is_active) return selection;
  }
  Restriction restriction;
  for (std::size_t i = 0; i < moving_->size(); ++i) {
    const MoveitBody& body = (*moving_)[i];
    if (is_active[static_cast<std::size_t>(body.link)]) {
      restriction.names.push_back(modelName(body));
    }
  }
  if (restriction.names.empty()) return nullptr;  // nothing that the restriction could name
  if (selections_.size() == MAX_SELECTIONS) selections_.erase(selections_.begin());
  selections_.emplace_back(is_active, std::make_shared<PairSelection>(scene_, restriction));
  return selections_.back().second;
}

MoveitScene::Lease MoveitScene::lease() const {
  std::unique_ptr<Worker> worker;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!idle_.empty()) {
      worker = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!worker) worker = std::make_unique<Worker>(scene_);
  return {worker.release(), [this](Worker* used) {
            const std::lock_guard<std::mutex> lock(mutex_);
            idle_.emplace_back(used);
          }};
}

}  // namespace collision_pairs
