// Random robots with every type of joint, and scenes with every kind of rule.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "collision_pairs/scene_description.h"
#include "mixed_robot.h"

namespace collision_pairs {

inline std::string threeNumbers(const Eigen::Vector3d& v) {
  return std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]);
}

/// A tree of `nb_links` links and a root without geometry; meshes are those of testMesh().
inline std::string randomUrdf(RandomInputs& random, int nb_links) {
  const std::string shapes[] = {
      "<box size='0.3 0.1 0.2'/>", "<cylinder radius='0.07' length='0.3'/>",
      "<sphere radius='0.1'/>",    "<mesh filename='l'/>",
      "<mesh filename='ball'/>",   "<mesh filename='slab'/>"};
  const std::string types[] = {"revolute", "continuous", "prismatic", "revolute",
                               "fixed",    "floating",   "planar"};
  std::string xml = emptyLink("root"), leader;
  for (int i = 0; i < nb_links; ++i) {
    const std::string name = "link_" + std::to_string(i), type = types[random.integer(0, 6)];
    const std::string origin = "<origin xyz='" + threeNumbers(random.vector(-0.1, 0.1)) +
                               "' rpy='" + threeNumbers(random.vector(-3, 3)) + "'/>";
    xml += linkWith(name, shapes[random.integer(0, 5)], origin);
    const std::string parent =
        i == 0 ? "root" : "link_" + std::to_string(random.integer(std::max(0, i - 2), i - 1));
    std::string extra = "<axis xyz='" + threeNumbers(random.rotation() * Eigen::Vector3d::UnitX()) +
                        "'/><limit lower='-1.5' upper='1.5'/>";
    const bool moves = type == "revolute" || type == "continuous" || type == "prismatic";
    if (moves && !leader.empty() && random.integer(0, 3) == 0) {
      extra += "<mimic joint='" + leader + "' multiplier='-0.7' offset='0.1'/>";
    } else if (moves) {
      leader = "joint_" + std::to_string(i);
    }
    xml += "<joint name='joint_" + std::to_string(i) + "' type='" + type + "'><parent link='" +
           parent + "'/><child link='" + name + "'/><origin xyz='" +
           threeNumbers(random.vector(-0.35, 0.35)) + "' rpy='" +
           threeNumbers(random.vector(-3, 3)) + "'/>" + extra + "</joint>";
  }
  return "<robot name='random'>" + xml + "</robot>";
}

inline std::shared_ptr<const RobotModel> randomRobot(RandomInputs& random, int nb_links) {
  return RobotModel::fromUrdf(randomUrdf(random, nb_links), testMesh);
}

/// Positions of all joints; of those that turn, now and then many turns.
inline std::vector<double> randomPositions(RandomInputs& random, const RobotModel& robot) {
  std::vector<double> positions = robot.zeroPositions();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Joint& joint = robot.joints()[i];
    if (!joint.hasPosition()) continue;
    const bool turns = joint.type != JointType::PRISMATIC;
    positions[i] = random.uniform(-1.5, 1.5) * (turns && random.integer(0, 9) == 0 ? 5e3 : 1.0);
  }
  robot.applyMimics(positions);
  return positions;
}

/// Two robots, a world, static and attached objects, paddings, rules.
inline SceneDescription randomScene(RandomInputs& random) {
  SceneDescription description;
  description.robots.push_back({randomRobot(random, random.integer(2, 9)), std::nullopt, "left"});
  description.robots.push_back({randomRobot(random, random.integer(1, 5)), std::nullopt, "right"});
  description.robots.back().X_WR = random.pose(0.8);
  const auto object = [&](const std::string& name, const std::string& attached_to) {
    RigidObject made;
    made.name = name;
    const Shape shapes[] = {Box{{0.2, 0.2, 0.1}}, Cylinder{0.1, 0.2}, Capsule{0.05, 0.3},
                            Sphere{0.1}, meshShape(LShape().mesh())};
    made.elements.push_back({shapes[random.integer(0, 4)], random.pose(0.1)});
    made.attached_link = attached_to;
    made.X_PO = random.pose(attached_to.empty() ? 1.2 : 0.2);
    if (random.integer(0, 3) == 0) made.padding = 0.02;
    return made;
  };
  for (int i = random.integer(0, 5); i > 0; --i) {
    description.objects.push_back(object("thing_" + std::to_string(i), ""));
  }
  if (random.integer(0, 1)) description.objects.push_back(object("tool", "left/link_1"));
  if (random.integer(0, 2) == 0) description.objects.push_back(floorAt(-0.8, {"left/link_0"}));
  SceneSettings& settings = description.settings;
  if (random.integer(0, 2) == 0) settings.padding = 0.03;
  if (random.integer(0, 2) == 0) settings.link_padding["left/link_0"] = 0.1;
  if (random.integer(0, 2) == 0) settings.pair_padding.push_back({"left/*", "right/*", 0.05});
  if (random.integer(0, 2) == 0) {
    settings.pair_rules.push_back({PairRule::Verdict::DENY, "left/link_0", "*"});
  }
  if (random.integer(0, 2) == 0) settings.ignored_links.push_back("right/link_0");
  if (random.integer(0, 2) == 0) settings.cylinder_as_capsule.push_back("*");
  if (random.integer(0, 3) == 0) description.restriction.names.push_back("left/*");
  if (random.integer(0, 5) == 0) description.check_self = false;
  return description;
}

}  // namespace collision_pairs
