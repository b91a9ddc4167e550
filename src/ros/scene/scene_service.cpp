#include "scene_service.h"

#include <exception>
#include <functional>
#include <utility>

#include <boost/make_shared.hpp>
#include <ros/console.h>

#include "thread_priority.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

const ros::WallDuration WATCH_PERIOD(3.0);  // between looks at the descriptions
const ros::WallDuration LOAD_PERIOD(2.0);   // between attempts to find a robot_description

class Task : public ros::CallbackInterface {
 public:
  explicit Task(std::function<void()> task) : task_(std::move(task)) {}
  CallResult call() override {
    lowerThreadPriority();
    task_();
    return Success;
  }

 private:
  std::function<void()> task_;
};

}  // namespace

SceneService::SceneService(const ros::NodeHandle& private_node, LiveMonitor& monitor,
                           SceneBuilder& scenes)
    : monitor_(monitor), scenes_(scenes), answering_(1, &requests_), working_(1, &tasks_) {
  ros::NodeHandle node(private_node);
  node.setCallbackQueue(&requests_);
  update_server_ = node.advertiseService("update_scene", &SceneService::onUpdate, this);
  reset_server_ = node.advertiseService("reset", &SceneService::onReset, this);
  clear_server_ = node.advertiseService("clear_clouds", &SceneService::onClearClouds, this);
  answering_.start();
  working_.start();
}

std::string SceneService::loadFirst() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (!is_loading_ && now >= next_load_) {
    is_loading_ = true;
    next_load_ = now + LOAD_PERIOD;
    tasks_.addCallback(boost::make_shared<Task>([this] { load(); }));
  }
  if (!is_loading_) return problem_;
  return "the robot is being loaded" +
         (problem_.empty() ? std::string() : "; the last attempt failed: " + problem_);
}

void SceneService::load() {
  std::string problem;
  try {
    if (!monitor_.activeScene()) scenes_.load();
  } catch (const std::exception& error) {
    problem = error.what();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!problem.empty() && problem != problem_) ROS_ERROR_STREAM(problem);
  is_loading_ = false;
  problem_ = problem;
}

std::string SceneService::watchDescriptions(bool reload) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (!is_watching_ && now >= next_watch_) {  // a master that hangs must not fill the queue
    is_watching_ = true;
    next_watch_ = now + WATCH_PERIOD;
    tasks_.addCallback(boost::make_shared<Task>([this, reload] { watch(reload); }));
  }
  return changed_;
}

void SceneService::watch(bool reload) {
  std::string told;
  try {
    const std::vector<std::string> changed = scenes_.changedDescriptions();
    if (!changed.empty()) {
      told = joined(changed) + (changed.size() == 1 ? " has" : " have") +
             " changed since the robot was loaded: the old one is checked until ~reset is called";
    }
    if (reload && !changed.empty()) {
      scenes_.load();
      ROS_INFO_STREAM(joined(changed) << " changed: the robot was reloaded");
      told.clear();
    }
  } catch (const std::exception& error) {
    told += std::string(told.empty() ? "" : "; ") + "it cannot be reloaded: " + error.what();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!told.empty() && told != changed_) ROS_WARN_STREAM(told);
  is_watching_ = false;
  changed_ = told;
}

void SceneService::release(std::shared_ptr<const void> what) {
  tasks_.addCallback(
      boost::make_shared<Task>([what = std::move(what)]() mutable { what.reset(); }));
}

bool SceneService::onUpdate(UpdateScene::Request& request, UpdateScene::Response& response) {
  try {
    scenes_.update(request.changes);
    response.success = true;
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  if (!request.no_list) {
    const auto [objects, scene] = monitor_.with([](const Monitor& monitor) {
      return std::pair(monitor.scenes().objects(), monitor.scenes().active());
    });
    response.objects = listed(*objects, scene ? scene->frame : std::string());
  }
  return true;  // false would hide the message from the caller
}

bool SceneService::onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  try {
    scenes_.load();
    response.success = true;
    response.message = "the robot was reloaded";
    const ActiveScenePtr scene = monitor_.activeScene();
    for (const std::string& line : scene->missing()) response.message += "; " + line;
    const std::string& unchecked = scene->scene->unchecked();
    if (!unchecked.empty()) response.message += "; " + unchecked;
  } catch (const std::exception& error) {
    response.message =
        std::string(monitor_.activeScene() ? "the old scene is kept: " : "there is no scene: ") +
        error.what();
  }
  return true;
}

bool SceneService::onClearClouds(std_srvs::Trigger::Request&,
                                 std_srvs::Trigger::Response& response) {
  response.success = monitor_.with([](Monitor& monitor) {
    monitor.clearClouds();
    const ActiveScenePtr scene = monitor.scenes().active();
    return scene && !scene->clouds.empty();
  });
  if (response.success) {
    response.message =
        "all voxels were discarded: UNKNOWN until a new cloud has arrived from each source";
  } else {
    response.message = "there are no clouds";
  }
  return true;
}

}  // namespace collision_pairs
