// The service update_scene.
#pragma once

#include <memory>

#include <collision_pairs/UpdateScene.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>

#include "scene_store.h"

namespace collision_pairs {

/// Answers on a thread of its own: a large mesh that is prepared does not hold up the cycle, nor
/// queries but the first with a restriction. What is wrong with a request is said in its reply.
class UpdateService {
 public:
  UpdateService(const ros::NodeHandle& private_node, SceneStore& scenes);

  /// Lets go of it on the service's thread: to free a large scene takes longer than a cycle may.
  void release(std::shared_ptr<const void> what);

 private:
  bool onUpdate(UpdateScene::Request& request, UpdateScene::Response& response);

  SceneStore& scenes_;
  ros::CallbackQueue queue_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;  // last: stops before what it calls into goes
};

}  // namespace collision_pairs
