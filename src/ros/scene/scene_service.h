// The services update_scene and reset, and the first scene.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <collision_pairs/UpdateScene.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>

#include "scene_builder.h"

namespace collision_pairs {

/// Builds scenes on threads of their own: preparing a large mesh delays neither the cycle nor
/// queries, except the first with a restriction. What nobody waits for (the first scene, reloads,
/// freeing) is done by one of low priority; requests have the priority of the node, since a thread
/// that lowers its own cannot raise it again. Errors in a request are returned in its reply.
class SceneService {
 public:
  SceneService(const ros::NodeHandle& private_node, LiveMonitor& monitor, SceneBuilder& scenes);

  /// Call it once per cycle while there is no scene. Loads one, and retries every two seconds on
  /// failure. Returns why there is none yet.
  std::string loadFirst();

  /// Looks every few seconds whether a description has changed since it was read, and reads it
  /// again if `reload`. Returns what to tell people; empty: none has. Never waits.
  std::string watchDescriptions(bool reload);

  /// Frees it on the thread of low priority, since freeing a large scene takes longer than a cycle.
  void release(std::shared_ptr<const void> what);

 private:
  void load();
  void watch(bool reload);
  bool onUpdate(UpdateScene::Request& request, UpdateScene::Response& response);
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onClearClouds(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  LiveMonitor& monitor_;
  SceneBuilder& scenes_;
  std::mutex mutex_;  // guards what follows
  bool is_loading_ = false, is_watching_ = false;
  std::string problem_, changed_;
  ros::SteadyTime next_load_, next_watch_;

  ros::CallbackQueue requests_, tasks_;
  ros::ServiceServer update_server_, reset_server_, clear_server_;
  ros::AsyncSpinner answering_, working_;  // last: stop before the others
};

}  // namespace collision_pairs
