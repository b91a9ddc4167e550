#include "ros_master.h"

#include <cstdint>
#include <string>

#include <ros/console.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpc.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

constexpr double PATIENCE = 1.0;  // s, for a node that hangs

/// A node that was killed is still known to the master, but no longer listens.
bool isAlive(const std::string& uri) {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) return false;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue question, answer;
  question[0] = ros::this_node::getName();
  if (!client.executeNonBlock("getPid", question)) return false;
  XmlRpc::XmlRpcDispatch dispatch;
  using XmlRpc::XmlRpcDispatch;
  dispatch.addSource(&client, XmlRpcDispatch::WritableEvent | XmlRpcDispatch::Exception);
  dispatch.work(PATIENCE);
  client.executeCheckDone(answer);  // true, and no answer, after a connection that was refused
  return answer.getType() == XmlRpc::XmlRpcValue::TypeArray;
}

}  // namespace

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

bool isSecondNode() {
  const std::string& name = ros::this_node::getName();
  XmlRpc::XmlRpcValue uri;
  try {
    if (!askMaster("lookupNode", name, name, uri)) return false;
  } catch (const InputError&) {  // there is none yet: NodeHandle waits for it
    return false;
  }
  if (uri.getType() != XmlRpc::XmlRpcValue::TypeString) return false;
  if (!isAlive(static_cast<std::string&>(uri))) return false;
  ROS_FATAL_STREAM("cannot start: there is a node "
                   << name << " already, at " << static_cast<std::string&>(uri)
                   << "; end it, or start this one with another name");
  return true;
}

}  // namespace collision_pairs
