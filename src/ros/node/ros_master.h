// Questions to the ROS master that tell "no" from no answer, and to other nodes.
#pragma once

#include <string>

#include <xmlrpcpp/XmlRpcValue.h>

namespace collision_pairs {

/// Calls a method of the master's API (http://wiki.ros.org/ROS/Master_API) with two arguments, of
/// which the first is a name. False: it answers that there is no such thing. Throws InputError if
/// it does not answer; it does not wait. Functions of roscpp say false for both.
bool askMaster(const std::string& method, const std::string& first, const std::string& second,
               XmlRpc::XmlRpcValue& answer);

/// True, with an error in the log, if the master knows a node of this name that is alive. A new one
/// would make the master end it, and where a launch file starts it again, it would end the new one,
/// and so on. Takes at most some seconds. Call it after ros::init() and before the first
/// NodeHandle, which registers the node.
bool isSecondNode();

}  // namespace collision_pairs
