#include "ros_master.h"

#include <ros/master.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

bool askMaster(const std::string& method, const std::string& first, const std::string& second,
               XmlRpc::XmlRpcValue& answer) {
  XmlRpc::XmlRpcValue request, response;
  request[0] = first;
  request[1] = second;
  const bool waits_for_master = false;
  if (ros::master::execute(method, request, response, answer, waits_for_master)) return true;
  // Of what it does not know it answers [-1, message, value].
  if (response.valid() && response.getType() == XmlRpc::XmlRpcValue::TypeArray) return false;
  throw InputError("the ROS master does not answer " + method + "(" + second + "); try again");
}

}  // namespace collision_pairs
