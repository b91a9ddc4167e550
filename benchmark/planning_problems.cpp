#include "planning_problems.h"

#include <algorithm>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "collision_pairs/mesh_loader.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

using Numbers = std::vector<double>;

std::string originOf(const YAML::Node& object) {
  const Numbers xyz = object["xyz"].as<Numbers>(), q = object["quat_xyzw"].as<Numbers>();
  const Eigen::Matrix3d R = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().matrix();
  const Eigen::Vector3d ypr = R.eulerAngles(2, 1, 0);
  std::ostringstream origin;
  origin.precision(17);
  origin << "<origin xyz=\"" << xyz[0] << ' ' << xyz[1] << ' ' << xyz[2] << "\" rpy=\"" << ypr[2]
         << ' ' << ypr[1] << ' ' << ypr[0] << "\"/>";
  return origin.str();
}

std::string shapeOf(const YAML::Node& object) {
  const std::string type = object["type"].as<std::string>();
  if (type == "box") {
    const Numbers size = object["size"].as<Numbers>();
    std::ostringstream box;
    box.precision(17);
    box << "<box size=\"" << size[0] << ' ' << size[1] << ' ' << size[2] << "\"/>";
    return box.str();
  }
  const std::string radius = " radius=\"" + object["radius"].as<std::string>() + "\"";
  if (type == "sphere") return "<sphere" + radius + "/>";
  return "<cylinder" + radius + " length=\"" + object["height"].as<std::string>() + "\"/>";
}

std::shared_ptr<const RobotModel> worldOf(const YAML::Node& objects) {
  std::string urdf = "<robot name=\"world\"><link name=\"world_root\"/>";
  for (const YAML::Node& object : objects) {
    const std::string name = "object_" + object["id"].as<std::string>();
    urdf += "<link name=\"" + name + "\"><collision><geometry>" + shapeOf(object) +
            "</geometry></collision></link><joint name=\"to_" + name + "\" type=\"fixed\">" +
            originOf(object) + "<parent link=\"world_root\"/><child link=\"" + name +
            "\"/></joint>";
  }
  return RobotModel::fromUrdf(urdf + "</robot>", makeMeshLoader());
}

}  // namespace

PlanningProblems readPlanningProblems(const std::string& data, const std::string& robot,
                                      std::size_t nb_problems) {
  const YAML::Node file = YAML::Load(readTextFile(data + "/problems/" + robot + ".json"));
  const std::string model = data + "/robots/" + (robot == "ur5" ? "ur" : robot) + "_model";
  PlanningProblems read;
  read.robot.name = robot;
  read.robot.robot =
      RobotModel::fromUrdf(readTextFile(model + "/urdf/" + robot + ".urdf"), makeMeshLoader());
  read.robot.srdf = Srdf::fromXml(readTextFile(model + "/srdf/" + robot + ".srdf"));
  for (const YAML::Node& pair : file["permanent_pairs"]) {  // halves of one link
    read.robot.srdf.disabled_pairs.emplace_back(pair[0].as<std::string>(),
                                                pair[1].as<std::string>());
  }
  read.joints = file["joints"].as<std::vector<std::string>>();
  read.positions = read.robot.robot->zeroPositions();
  for (const auto& other : file["other_joints"]) {
    const int joint = read.robot.robot->findJoint(other.first.as<std::string>());
    if (joint >= 0) read.positions[joint] = other.second.as<double>();
  }
  read.robot.robot->applyMimics(read.positions);
  const YAML::Node problems = file["problems"];
  nb_problems = std::min(nb_problems, problems.size());
  for (std::size_t i = 0; i < nb_problems; ++i) {
    const YAML::Node problem = problems[i * problems.size() / nb_problems];
    read.problems.push_back({problem["set"].as<std::string>(), problem["start"].as<Numbers>(),
                             problem["goal"].as<Numbers>(), worldOf(problem["objects"])});
  }
  return read;
}

}  // namespace collision_pairs
