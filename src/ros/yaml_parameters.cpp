#include "yaml_parameters.h"

namespace collision_pairs {
namespace {

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

}  // namespace

YAML::Node yamlParameters(const ros::NodeHandle& node, const std::vector<std::string>& keys) {
  YAML::Node map(YAML::NodeType::Map);
  for (const std::string& key : keys) {
    XmlRpc::XmlRpcValue value;
    if (node.getParam(key, value)) map[key] = toYaml(value);
  }
  return map;
}

}  // namespace collision_pairs
