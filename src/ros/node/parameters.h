// The node's parameters: meaning, unit and default in one place; read once at the start.
#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include "collision_pairs/collision_detector.h"
#include "stamps.h"

namespace collision_pairs {

/// The parameter ~configured says that the others are those that the node was started with: on a
/// master that was restarted they are gone, since roslaunch does not load them again, and absent
/// ones are not defaults. Throws InputError without it.
void requireConfigured(const ros::NodeHandle& private_node);
/// Before anything else of a node. With --configured among its arguments its launch file has set
/// the parameter: throws InputError where it is missing. Otherwise sets it.
void beginConfigured(const ros::NodeHandle& private_node,
                     const std::vector<std::string>& arguments);

/// The value of a parameter; false if it is not set. Throws InputError if the ROS master does not
/// answer, unlike NodeHandle::getParam(): what is not known is not a default.
bool readParameter(const ros::NodeHandle& node, const std::string& name,
                   XmlRpc::XmlRpcValue& value);
/// The nearest parameter of that name, from the node's namespace upwards, as
/// NodeHandle::searchParam() finds it; empty: there is none. Throws InputError like
/// readParameter().
std::string findParameter(const ros::NodeHandle& node, const std::string& name);

/// A map with those of `keys` that are set below the node's namespace, so that one reader serves
/// parameters and files. Throws InputError like readParameter().
YAML::Node yamlParameters(const ros::NodeHandle& node, const std::vector<std::string>& keys);

/// One of ~robots: the names of the parameters with its URDF and SRDF, and its TF prefix.
struct RobotParameters {
  std::string description = "robot_description";
  std::string semantic = "robot_description_semantic";
  std::string prefix;
  bool needs_semantic = false;  // it is named in ~robots
};

/// ~robots, or the one robot whose parameters have the usual names. Throws InputError.
std::vector<RobotParameters> readRobots(const ros::NodeHandle& private_node);

/// ~fixed_frame, without a leading slash; empty: none is set. One that is not text is treated as in
/// NodeParameters::read().
std::string readFixedFrame(const ros::NodeHandle& private_node);

struct NodeParameters {
  NodeParameters() { check.stage_times = check.list_boxes = true; }  // messages and markers do

  /// ~alarm_distance [m], ~fidelity, ~tolerance [m], ~time_budget [s], ~verdict_only and
  /// ~min_distance. The default is the core's. May change while running.
  CheckSettings check;
  /// ~rate [Hz]: cycles per second of wall time; see ~trigger. May change while running.
  double rate = 50.0;
  /// ~show_only_investigated_boxes: no markers for boxes that no candidate pair involves. May
  /// change while running.
  bool show_only_investigated_boxes = false;
  /// ~max_pose_age, ~max_transform_age and ~clock_tolerance [s]. A link with an older pose is left
  /// out and listed, and the verdict is not FREE.
  PoseLimits pose_limits;
  /// ~allow_paused: under use_sim_time, the clock may stand still.
  bool allow_paused = false;

  /// ~trigger: when a cycle begins. `rate`: at the rate. `tf`: as soon as transforms have arrived,
  /// at most at the rate, and without any each 0.05 s.
  std::string trigger = "rate";
  static constexpr const char* TF = "tf";

  /// ~reload: `manual`, or `auto`: a description that changes is read again within seconds, as by
  /// ~reset.
  std::string reload = "manual";
  static constexpr const char* AUTO = "auto";

  /// An invalid value is reported as an error, and the default is used and written back, so that
  /// the parameter server shows the values in use.
  static NodeParameters read(const ros::NodeHandle& private_node);
};

}  // namespace collision_pairs
