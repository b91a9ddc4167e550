#include "motion_pairs.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace collision_pairs {
namespace {

bool isStatic(const CollisionScene& scene, std::uint32_t model) {
  const CollisionModel& of_scene = scene.models()[model];
  return of_scene.body < 0 && scene.cloudOf(of_scene.first_element) < 0;
}

// The filter without pairs of two moving models, and without clouds. O(models + classes that move,
// squared): the objects of a large world share a class.
PairFilter withStaticOnly(const CollisionScene& scene) {
  PairFilter filter = scene.filter();
  std::map<std::uint32_t, int> moving;  // how many models of each class
  for (std::uint32_t model = 0; model < scene.models().size(); ++model) {
    if (!isStatic(scene, model)) ++moving[filter.classOf(model)];
  }
  for (auto a = moving.begin(); a != moving.end(); ++a) {
    if (a->second > 1) filter.setClassPair(a->first, a->first, false);
    for (auto b = std::next(a); b != moving.end(); ++b) {
      filter.setClassPair(a->first, b->first, false);
    }
  }
  return filter;
}

}  // namespace

MotionPairs::MotionPairs(const CollisionScene& scene) : static_pairs(withStaticOnly(scene)) {
  const auto& bodies = scene.robot().bodies();
  for (const Body& body : bodies) {
    depth_of.push_back(body.parent < 0 ? 0 : depth_of[body.parent] + 1);
    max_depth = std::max(max_depth, depth_of.back());
  }
  const auto& elements = scene.elements();
  for (const SceneElement& element : elements) {
    body_of.push_back(element.body < 0 ? -1 : scene.bodies()[element.body].body);
  }
  const auto& models = scene.models();
  for (std::uint32_t i = scene.nbStaticElements(); i < scene.endOfMovingElements(); ++i) {
    const std::uint32_t model = elements[i].model;
    for (std::uint32_t j = i + 1; j < elements.size(); ++j) {
      if (!scene.filter().allowed(model, elements[j].model)) continue;
      const bool in_order = model < elements[j].model;
      pairs.push_back({in_order ? i : j, in_order ? j : i, frameOf(scene.robot(), {i, j})});
    }
    for (std::uint32_t m = 0; m < models.size(); ++m) {
      if (!isStatic(scene, m) || !scene.filter().allowed(model, m)) continue;
      beside_static.push_back(i);
      break;
    }
  }
}

int MotionPairs::frameOf(const RobotModel& robot, const BoxPair& pair) const {
  int a = body_of[pair.first], b = body_of[pair.second];
  while (a != b) {  // a parent always comes before its children
    int& later = a > b ? a : b;
    later = robot.bodies()[later].parent;
  }
  return a;
}

}  // namespace collision_pairs
