// Questions to the ROS master that tell "no" from no answer.
#pragma once

#include <string>

#include <xmlrpcpp/XmlRpcValue.h>

namespace collision_pairs {

/// Calls a method of the master's API (http://wiki.ros.org/ROS/Master_API) with two arguments, of
/// which the first is a name. False: it answers that there is no such thing. Throws InputError if
/// it does not answer; it does not wait. Functions of roscpp say false for both.
bool askMaster(const std::string& method, const std::string& first, const std::string& second,
               XmlRpc::XmlRpcValue& answer);

}  // namespace collision_pairs
