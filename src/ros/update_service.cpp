#include "update_service.h"

#include <exception>
#include <utility>

#include <boost/make_shared.hpp>

namespace collision_pairs {
namespace {

class Release : public ros::CallbackInterface {
 public:
  explicit Release(std::shared_ptr<const void> what) : what_(std::move(what)) {}
  CallResult call() override {
    what_.reset();
    return Success;
  }

 private:
  std::shared_ptr<const void> what_;
};

}  // namespace

UpdateService::UpdateService(const ros::NodeHandle& private_node, SceneStore& scenes)
    : scenes_(scenes), spinner_(1, &queue_) {
  ros::NodeHandle node(private_node);
  node.setCallbackQueue(&queue_);
  server_ = node.advertiseService("update_scene", &UpdateService::onUpdate, this);
  spinner_.start();
}

void UpdateService::release(std::shared_ptr<const void> what) {
  if (what) queue_.addCallback(boost::make_shared<Release>(std::move(what)));
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
