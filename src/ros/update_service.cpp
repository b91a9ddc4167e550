#include "update_service.h"

#include <exception>

namespace collision_pairs {

UpdateService::UpdateService(const ros::NodeHandle& private_node, SceneStore& scenes)
    : scenes_(scenes), spinner_(1, &queue_) {
  ros::NodeHandle node(private_node);
  node.setCallbackQueue(&queue_);
  server_ = node.advertiseService("update_scene", &UpdateService::onUpdate, this);
  spinner_.start();
}

bool UpdateService::onUpdate(UpdateScene::Request& request, UpdateScene::Response& response) {
  try {
    response.objects = scenes_.update(request.changes);
    response.success = true;
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    response.objects = scenes_.list();
  }
  return true;  // false would hide the message from the caller
}

}  // namespace collision_pairs
