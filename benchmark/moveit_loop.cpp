#include "moveit_loop.h"

#include <limits>
#include <set>

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

namespace collision_pairs {
namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

struct ToFcl {
  Geometry operator()(const Box& b) const { return std::make_shared<fcl::Boxd>(b.size); }
  Geometry operator()(const Sphere& s) const { return std::make_shared<fcl::Sphered>(s.radius); }
  Geometry operator()(const Cylinder& c) const {
    return std::make_shared<fcl::Cylinderd>(c.radius, c.length);
  }
  Geometry operator()(const Mesh& m) const {
    auto bvh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    std::vector<fcl::Triangle> triangles;
    for (const auto& t : m.mesh->triangles) triangles.emplace_back(t[0], t[1], t[2]);
    bvh->beginModel();
    bvh->addSubModel(m.mesh->vertices, triangles);
    bvh->endModel();
    return bvh;
  }
  template <class Other>
  Geometry operator()(const Other&) const {
    return nullptr;  // not in a URDF
  }
};

}  // namespace

struct MoveItLoop::Query {
  const AllowedCollisions* allowed;
  bool want_contacts = false;
  bool done = false;
  std::map<std::pair<std::string, std::string>, fcl::Contactd> contacts;
  fcl::DistanceResultd nearest;
};

std::vector<MoveItLoop::Object> MoveItLoop::makeObjects(const RobotModel& robot) {
  std::vector<Object> objects;
  for (const Link& link : robot.links()) {
    for (const Element& element : link.elements) {
      const Geometry geometry = std::visit(ToFcl{}, element.shape);
      objects.push_back({link.name, link.body, link.X_BL * element.X_LE,
                         std::make_shared<fcl::CollisionObjectd>(geometry)});
    }
  }
  // The elements do not move again, so the addresses in the user data stay good.
  for (Object& object : objects) object.object->setUserData(&object.link);
  return objects;
}

MoveItLoop::MoveItLoop(const BenchmarkRobot& source)
    : robot_(makeObjects(*source.robot)),
      world_(makeObjects(*source.world)),
      world_tree_(std::make_shared<fcl::DynamicAABBTreeCollisionManagerd>()) {
  readAllowed(source);
  Poses X_RB;
  source.world->forwardKinematics(source.world->zeroPositions(), X_RB);
  for (Object& object : world_) {
    object.object->setTransform(fcl::Transform3d((X_RB[object.body] * object.X_BE).matrix()));
    object.object->computeAABB();
  }
  registerWorld();
}

MoveItLoop::MoveItLoop(const BenchmarkRobot& source, Geometry world)
    : robot_(makeObjects(*source.robot)),
      world_tree_(std::make_shared<fcl::DynamicAABBTreeCollisionManagerd>()) {
  readAllowed(source);
  world_.push_back({"world", 0, Eigen::Isometry3d::Identity(),
                    std::make_shared<fcl::CollisionObjectd>(std::move(world))});
  world_[0].object->setUserData(&world_[0].link);
  registerWorld();
}

void MoveItLoop::registerWorld() {
  for (Object& object : world_) world_tree_->registerObject(object.object.get());
  world_tree_->setup();
}

void MoveItLoop::readAllowed(const BenchmarkRobot& source) {
  std::vector<std::string> links;
  for (const Link& link : source.robot->links()) links.push_back(link.name);
  for (const auto& [a, b] : source.srdf.switchedOff(links)) {
    allowed_[a][b] = true;
    allowed_[b][a] = true;
  }
}

MoveItLoop::Objects MoveItLoop::copiesAt(const Poses& X_RB) const {
  Objects copies;
  copies.reserve(robot_.size());
  for (const Object& object : robot_) {
    auto copy = std::make_shared<fcl::CollisionObjectd>(*object.object);
    copy->setTransform(fcl::Transform3d((X_RB[object.body] * object.X_BE).matrix()));
    copy->computeAABB();
    copies.push_back(std::move(copy));
  }
  return copies;
}

bool MoveItLoop::onPair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
  Query& query = *static_cast<Query*>(data);
  if (query.done) return true;
  const auto& link_a = *static_cast<const std::string*>(a->getUserData());
  const auto& link_b = *static_cast<const std::string*>(b->getUserData());
  if (link_a == link_b) return false;
  const auto row = query.allowed->find(link_a);
  if (row != query.allowed->end() && row->second.count(link_b)) return false;
  const fcl::CollisionRequestd request(1, query.want_contacts);
  fcl::CollisionResultd result;
  if (fcl::collide(a, b, request, result) == 0) return false;
  if (!query.want_contacts) return query.done = true;
  query.contacts.emplace(std::minmax(link_a, link_b), result.getContact(0));
  return false;
}

bool MoveItLoop::onDistance(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data,
                            double& bound) {
  Query& query = *static_cast<Query*>(data);
  const auto& link_a = *static_cast<const std::string*>(a->getUserData());
  const auto& link_b = *static_cast<const std::string*>(b->getUserData());
  if (link_a == link_b) return false;
  const auto row = query.allowed->find(link_a);
  if (row != query.allowed->end() && row->second.count(link_b)) return false;
  fcl::DistanceResultd result;
  result.min_distance = query.nearest.min_distance;
  if (fcl::distance(a, b, fcl::DistanceRequestd(true), result) < query.nearest.min_distance) {
    query.nearest = result;
  }
  bound = query.nearest.min_distance;
  return bound <= 0.0;
}

void MoveItLoop::querySelf(const Poses& X_RB, Query& query) const {
  const Objects copies = copiesAt(X_RB);
  fcl::DynamicAABBTreeCollisionManagerd tree;
  std::vector<fcl::CollisionObjectd*> objects;
  for (const auto& copy : copies) objects.push_back(copy.get());
  tree.registerObjects(objects);
  tree.setup();
  if (query.nearest.min_distance < std::numeric_limits<double>::max()) {
    tree.distance(&query, &onDistance);
  } else {
    tree.collide(&query, &onPair);
  }
}

void MoveItLoop::queryWorld(const Poses& X_RB, Query& query) const {
  const bool distance = query.nearest.min_distance < std::numeric_limits<double>::max();
  for (const auto& copy : copiesAt(X_RB)) {
    if (query.done) return;
    if (distance) {
      world_tree_->distance(copy.get(), &query, &onDistance);
    } else {
      world_tree_->collide(copy.get(), &query, &onPair);
    }
  }
}

namespace {
constexpr double FAR = 1e300;  // less than the maximum, which stands for "no distance asked"
}

bool MoveItLoop::selfCollides(const Poses& X_RB) const {
  Query query{&allowed_, false, false, {}, {}};
  querySelf(X_RB, query);
  return query.done;
}

std::size_t MoveItLoop::selfContacts(const Poses& X_RB) const {
  Query query{&allowed_, true, false, {}, {}};
  querySelf(X_RB, query);
  return query.contacts.size();
}

double MoveItLoop::selfDistance(const Poses& X_RB) const {
  Query query{&allowed_, false, false, {}, {}};
  query.nearest.min_distance = FAR;
  querySelf(X_RB, query);
  return query.nearest.min_distance;
}

bool MoveItLoop::collides(const Poses& X_RB) const {
  Query query{&allowed_, false, false, {}, {}};
  querySelf(X_RB, query);
  if (!query.done) queryWorld(X_RB, query);
  return query.done;
}

bool MoveItLoop::worldCollides(const Poses& X_RB) const {
  Query query{&allowed_, false, false, {}, {}};
  queryWorld(X_RB, query);
  return query.done;
}

double MoveItLoop::worldDistance(const Poses& X_RB) const {
  Query query{&allowed_, false, false, {}, {}};
  query.nearest.min_distance = FAR;
  queryWorld(X_RB, query);
  return query.nearest.min_distance;
}

}  // namespace collision_pairs
