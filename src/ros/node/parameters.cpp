#include "parameters.h"

#include <algorithm>
#include <set>

#include <collision_pairs/CollisionPairsConfig.h>
#include <ros/console.h>
#include <ros/names.h>
#include <ros/this_node.h>

#include "collision_pairs/input_error.h"
#include "ros_master.h"
#include "user_text.h"
#include "yaml_values.h"

namespace collision_pairs {
namespace {

const std::string CONFIGURED = "configured";

YAML::Node toYaml(XmlRpc::XmlRpcValue& value) {
  using XmlRpc::XmlRpcValue;
  YAML::Node node;
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<bool&>(value));
    case XmlRpcValue::TypeInt:
      return YAML::Node(static_cast<int&>(value));
    case XmlRpcValue::TypeDouble:
      return YAML::Node(static_cast<double&>(value));
    case XmlRpcValue::TypeString:
      return YAML::Node(static_cast<std::string&>(value));
    case XmlRpcValue::TypeArray:
      node = YAML::Node(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) node.push_back(toYaml(value[i]));
      return node;
    case XmlRpcValue::TypeStruct:
      node = YAML::Node(YAML::NodeType::Map);
      for (auto& entry : value) node[entry.first] = toYaml(entry.second);
      return node;
    default:
      return YAML::Node(value.toXml());
  }
}

/// Reads parameters; those of another type or range are replaced by the current `value`.
class Reader {
 public:
  explicit Reader(const ros::NodeHandle& node) : node_(node) {}

  void number(const std::string& name, double lowest, double highest, double& value) const {
    const std::string rule =
        "a number from " + std::to_string(lowest) + " to " + std::to_string(highest);
    read(name, rule, {Value::TypeInt, Value::TypeDouble}, value,
         [&](const std::string& key, const YAML::Node& given) {
           return numberOf(key, given, rule, {lowest, highest});
         });
  }

  void flag(const std::string& name, bool& value) const {
    read(name, "true or false", {Value::TypeBoolean}, value, flagOf);
  }

  void word(const std::string& name, std::string& value) const {
    read(name, "text", {Value::TypeString}, value,
         [](const std::string&, const YAML::Node& given) { return given.Scalar(); });
  }

  void oneOf(const std::string& name, const std::vector<std::string>& words,
             std::string& value) const {
    const std::string rule = joined({words.begin(), words.end() - 1}) + " or " + words.back();
    read(name, rule, {Value::TypeString}, value,
         [&](const std::string& key, const YAML::Node& given) {
           if (!contains(words, given.Scalar())) refuseValue(key, given, rule);
           return given.Scalar();
         });
  }

 private:
  using Value = XmlRpc::XmlRpcValue;

  template <typename T, class Read>
  void read(const std::string& name, const std::string& rule, const std::set<Value::Type>& types,
            T& value, const Read& read_value) const {
    Value given;
    if (!readParameter(node_, name, given)) return;
    const std::string key = "parameter " + node_.resolveName(name);
    try {
      if (types.count(given.getType()) == 0) refuseValue(key, toYaml(given), rule);
      value = read_value(key, toYaml(given));
    } catch (const InputError& error) {
      ROS_ERROR_STREAM(error.what() << "; using " << std::boolalpha << value);
      node_.setParam(name, value);
    }
  }

  const ros::NodeHandle& node_;
};

}  // namespace

bool readParameter(const ros::NodeHandle& node, const std::string& name,
                   XmlRpc::XmlRpcValue& value) {
  return askMaster("getParam", ros::this_node::getName(), node.resolveName(name), value);
}

std::string findParameter(const ros::NodeHandle& node, const std::string& name) {
  const auto& remappings = ros::names::getUnresolvedRemappings();
  const auto remapped = remappings.find(name);
  XmlRpc::XmlRpcValue key;
  const bool is_found = askMaster("searchParam", node.getNamespace(),
                                  remapped == remappings.end() ? name : remapped->second, key);
  return is_found ? static_cast<std::string&>(key) : "";
}

void requireConfigured(const ros::NodeHandle& private_node) {
  if (private_node.hasParam(CONFIGURED)) return;
  throw InputError("the parameter " + private_node.resolveName(CONFIGURED) +
                   " is gone, and so are the others: the ROS master was restarted, or they were "
                   "deleted. Start the launch file again, which loads them");
}

void beginConfigured(const ros::NodeHandle& private_node,
                     const std::vector<std::string>& arguments) {
  if (std::count(arguments.begin(), arguments.end(), "--" + CONFIGURED) > 0) {
    requireConfigured(private_node);
  } else {
    private_node.setParam(CONFIGURED, true);
  }
}

YAML::Node yamlParameters(const ros::NodeHandle& node, const std::vector<std::string>& keys) {
  YAML::Node map(YAML::NodeType::Map);
  for (const std::string& key : keys) {
    XmlRpc::XmlRpcValue value;
    if (readParameter(node, key, value)) map[key] = toYaml(value);
  }
  return map;
}

std::vector<RobotParameters> readRobots(const ros::NodeHandle& private_node) {
  const std::string rule =
      " is not a list of {description: parameter, semantic: parameter, prefix: name}, "
      "where semantic is optional";
  const std::string key = private_node.resolveName("robots");
  const YAML::Node given = yamlParameters(private_node, {"robots"})["robots"];
  if (!given || (given.IsSequence() && given.size() == 0)) return {RobotParameters()};
  if (!given.IsSequence()) throw InputError("parameter " + key + rule);
  std::vector<RobotParameters> robots;
  for (const YAML::Node& entry : given) {
    if (!entry.IsMap()) throw InputError("parameter " + key + rule);
    RobotParameters robot;
    robot.semantic.clear();
    for (const auto& field : entry) {
      const std::string name = field.first.Scalar();
      std::string* value = name == "description" ? &robot.description
                           : name == "semantic"  ? &robot.semantic
                           : name == "prefix"    ? &robot.prefix
                                                 : nullptr;
      if (!value || !field.second.IsScalar()) throw InputError("parameter " + key + rule);
      *value = field.second.Scalar();
    }
    robot.needs_semantic = !robot.semantic.empty();
    while (!robot.prefix.empty() && robot.prefix.back() == '/') robot.prefix.pop_back();
    robot.prefix = withoutLeadingSlash(robot.prefix);
    robots.push_back(robot);
  }
  return robots;
}

std::string readFixedFrame(const ros::NodeHandle& private_node) {
  std::string frame;
  Reader(private_node).word("fixed_frame", frame);
  return withoutLeadingSlash(frame);
}

NodeParameters NodeParameters::read(const ros::NodeHandle& private_node) {
  NodeParameters parameters;
  const Reader reader(private_node);
  const auto least = CollisionPairsConfig::__getMin__(), most = CollisionPairsConfig::__getMax__();
  reader.number("alarm_distance", least.alarm_distance, most.alarm_distance,
                parameters.check.alarm_distance);
  reader.number("tolerance", least.tolerance, most.tolerance, parameters.check.tolerance);
  reader.number("time_budget", least.time_budget, most.time_budget, parameters.check.time_budget);
  reader.number("rate", least.rate, most.rate, parameters.rate);
  reader.flag("verdict_only", parameters.check.verdict_only);
  reader.flag("min_distance", parameters.check.min_distance);
  reader.number("max_pose_age", 0.0, 1e9, parameters.pose_limits.max_pose_age);
  reader.number("max_transform_age", 0.0, 1e9, parameters.pose_limits.max_transform_age);
  reader.number("clock_tolerance", 0.0, 1e9, parameters.pose_limits.clock_tolerance);
  reader.flag("allow_paused", parameters.allow_paused);
  reader.flag("show_only_investigated_boxes", parameters.show_only_investigated_boxes);
  reader.oneOf("reload", {"manual", AUTO}, parameters.reload);
  reader.oneOf("trigger", {"rate", TF}, parameters.trigger);
  std::string broad_phase = broadPhaseName(parameters.check.broad_phase);
  reader.oneOf("broad_phase", {"auto", "sweep"}, broad_phase);
  parameters.check.broad_phase = parseBroadPhase(broad_phase);
  std::string fidelity = fidelityName(parameters.check.fidelity);
  reader.oneOf("fidelity", {"aabb", "spheres", "obb", "convex", "mesh"}, fidelity);
  parameters.check.fidelity = parseFidelity(fidelity);
  return parameters;
}

}  // namespace collision_pairs
