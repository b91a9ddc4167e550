// A robot with mass in real time, for a velocity limiter in another process, with random commands
// for it: publishes command, joint_states and /clock, follows limited_command, adds its obstacles
// to the scene of collision_pairs_node, and judges by the exact check what it did. Prints CSV.
//
// Private parameters: robot, servo, seconds, seed; factor (of simulated time; 0: wall time), pauses
// and steps (of /clock). test/dynamics/limiter_over_ros.py starts it.
#include <chrono>
#include <cmath>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <collision_pairs/UpdateScene.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64MultiArray.h>

#include "dynamic_robots.h"
#include "motion_scenes.h"

namespace collision_pairs {
namespace {

using Clock = std::chrono::steady_clock;
using std_msgs::Float64MultiArray;

constexpr double START = 1000.0;    // s of simulated time
constexpr int LONGEST_START = 600;  // 0.1 s
// Of /clock, in s of simulated time: how often it pauses and steps back, and for how long or far.
constexpr double PAUSE_EVERY = 7.0, PAUSE = 0.7, STEP_EVERY = 11.0, STEP_BACK = 0.5;

double lengthOf(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

geometry_msgs::Pose poseOf(const Eigen::Isometry3d& X) {
  geometry_msgs::Pose pose;
  const Eigen::Quaterniond q(X.linear());
  pose.position.x = X.translation().x();
  pose.position.y = X.translation().y();
  pose.position.z = X.translation().z();
  pose.orientation.w = q.w();
  pose.orientation.x = q.x();
  pose.orientation.y = q.y();
  pose.orientation.z = q.z();
  return pose;
}

SceneObject messageOf(const RigidObject& object) {
  SceneObject message;
  message.name = object.name;
  message.pose = poseOf(object.X_PO);
  for (const Element& element : object.elements) {
    if (const auto* box = std::get_if<Box>(&element.shape)) {
      message.primitives.emplace_back();
      message.primitives.back().type = shape_msgs::SolidPrimitive::BOX;
      message.primitives.back().dimensions.assign(box->size.data(), box->size.data() + 3);
      message.primitive_poses.push_back(poseOf(element.X_LE));
    } else if (const auto* mesh = std::get_if<Mesh>(&element.shape)) {
      message.meshes.emplace_back();
      for (const auto& vertex : mesh->mesh->vertices) {
        message.meshes.back().vertices.push_back(
            poseOf(Eigen::Isometry3d(Eigen::Translation3d(vertex))).position);
      }
      for (const auto& corners : mesh->mesh->triangles) {
        message.meshes.back().triangles.emplace_back();
        std::copy(corners.begin(), corners.end(),
                  message.meshes.back().triangles.back().vertex_indices.begin());
      }
      message.mesh_poses.push_back(poseOf(element.X_LE));
    } else {
      throw std::logic_error("an obstacle has an unexpected shape");
    }
  }
  return message;
}

class RealTimeRobot {
 public:
  RealTimeRobot() : seed_(static_cast<unsigned>(parameter("seed", 1))), random_(seed_) {
    if (factor_ > 0.0) clock_ = node_.advertise<rosgraph_msgs::Clock>("/clock", 10);
    states_ = node_.advertise<sensor_msgs::JointState>("joint_states", 10);
    commands_ = node_.advertise<Float64MultiArray>("command", 1);
    limited_ = node_.subscribe<Float64MultiArray>(
        "limited_command", 10, [this](const auto& message) { take(message->data); },
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  }

  void run(const std::vector<BenchmarkRobot>& robots) {
    const auto name = private_.param<std::string>("robot", "demo");
    const Servo servo =
        private_.param<std::string>("servo", "ramp") == "PI" ? Servo::PI : Servo::RAMP;
    for (const BenchmarkRobot& robot : robots) {
      if (robot.name == name) run(DynamicRobot(robot, servo));
    }
  }

 private:
  double parameter(const std::string& name, double by_default) const {
    return private_.param<double>(name, by_default);
  }

  void run(const DynamicRobot& robot) {
    SimulationOptions options = robot.options(false);
    options.state_late = {0.012, 0.015};  // so that they come in order, as a robot's
    const double seconds = parameter("seconds", 60.0);
    options.pace = [this](double now, SimulatedRobot& of) { pace(now, of); };
    options.watch = [&](double, double stamp, const std::vector<double>& q) {
      publish(robot, *scene_, stamp, q);
      return false;
    };
    scene_ = std::make_unique<LimiterScene>(robot.robot, robot.joints, seed_, options);
    addObjects(clutter(robot.robot, seed_, options.nb_things));
    begin_ = Clock::now();
    const SimulationResult found = scene_->run(
        [this](const LimiterView& view) -> std::optional<Passed> {
          if (!view.command.empty()) ask(view.command);
          return std::nullopt;
        },
        random_, seconds);
    std::cout << robot.robot.name << ',' << servoName(robot.servo) << ',' << found.seconds << ','
              << found.nb_contacts << ',' << found.nearest << ',' << found.nearest_links << ','
              << given_ / asked_ << std::endl;
  }

  void addObjects(const std::vector<RigidObject>& objects) {
    UpdateScene update;
    for (const RigidObject& object : objects) {
      update.request.changes.emplace_back();
      update.request.changes.back().operation = SceneChange::ADD;
      update.request.changes.back().object = messageOf(object);
    }
    const std::string service = "collision_pairs_node/update_scene";
    for (int i = 0; ros::ok() && i < LONGEST_START; ++i) {  // the node may not have its robot yet
      if (factor_ > 0.0) tellTime(0.0);
      const bool is_called =
          ros::service::exists(service, false) && ros::service::call(service, update);
      if (is_called && update.response.success) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    throw std::runtime_error("no objects could be added: " + update.response.message);
  }

  double wallFactor() const { return factor_ > 0.0 ? factor_ : 1.0; }
  /// Seconds since the simulation began, by the wall.
  double elapsed() const {
    return wallFactor() * std::chrono::duration<double>(Clock::now() - begin_).count();
  }
  ros::Time stampAt(double time) const {
    if (factor_ > 0.0) return ros::Time(START + time - back_);
    const double ago = elapsed() - time;
    return ros::Time(ros::WallTime::now().toSec() - ago);
  }
  void tellTime(double now) {
    rosgraph_msgs::Clock message;
    message.clock = stampAt(now);
    clock_.publish(message);
  }

  void pace(double now, SimulatedRobot& robot) {
    std::this_thread::sleep_until(begin_ + std::chrono::duration_cast<Clock::duration>(
                                               std::chrono::duration<double>(now / wallFactor())));
    if (!ros::ok()) throw std::runtime_error("ended");
    if (private_steps_ && now >= next_step_) {
      next_step_ += STEP_EVERY;
      back_ += STEP_BACK;
    }
    const bool pauses = private_pauses_ && std::fmod(now, PAUSE_EVERY) > PAUSE_EVERY - PAUSE;
    if (factor_ > 0.0 && !pauses) tellTime(now);
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto& [arrival, command] : received_) {
      given_ += lengthOf(command);
      const double dead_time = random_.uniform(0.008, 0.02);
      robot.command(std::max(now, arrival) + dead_time, std::move(command));
    }
    received_.clear();
  }

  void publish(const DynamicRobot& robot, const LimiterScene& scene, double stamp,
               const std::vector<double>& q) {
    sensor_msgs::JointState message;
    message.header.stamp = stampAt(stamp);
    const std::vector<double> all = scene.allPositions(q);
    const auto& joints = robot.robot.robot->joints();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (!joints[i].hasPosition() || joints[i].mimic) continue;
      message.name.push_back(joints[i].name);
      message.position.push_back(all[i]);
    }
    states_.publish(message);
  }

  void ask(const std::vector<double>& command) {
    asked_ += lengthOf(command);
    Float64MultiArray message;
    message.data = command;
    commands_.publish(message);
  }
  void take(const std::vector<double>& command) {
    const std::lock_guard<std::mutex> lock(mutex_);
    received_.emplace_back(elapsed(), command);
  }

  ros::NodeHandle node_, private_{"~"};
  const double factor_ = parameter("factor", 0.0);
  const bool private_pauses_ = private_.param("pauses", false);
  const bool private_steps_ = private_.param("steps", false);
  const unsigned seed_;
  RandomInputs random_;
  ros::Publisher clock_, states_, commands_;
  ros::Subscriber limited_;
  std::unique_ptr<LimiterScene> scene_;
  Clock::time_point begin_;
  double back_ = 0.0, next_step_ = STEP_EVERY;  // s
  double asked_ = 0.0, given_ = 0.0;
  std::mutex mutex_;  // guards what follows
  std::vector<std::pair<double, std::vector<double>>> received_;
};

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  ros::init(argc, argv, "dynamic_robot");
  const auto robots = collision_pairs::dynamicRobots();  // also says where their meshes are
  ros::AsyncSpinner spinner(1);
  collision_pairs::RealTimeRobot robot;
  spinner.start();
  robot.run(robots);
  return 0;
}
