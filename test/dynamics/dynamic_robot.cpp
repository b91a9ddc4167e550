// A robot with mass in real time, for a velocity limiter in another process, with random commands
// for it: publishes command, joint_states and /clock, follows limited_command, adds its obstacles
// to the scene of collision_pairs_node, and judges by the exact check what it did. Prints CSV.
//
// What moves the robot asks for real-time scheduling, as a robot has a computer of its own; what
// commands it has not, and what judges it is nice and may be late.
//
// Private parameters: robot, servo, seconds, seed; factor (of simulated time; 0: wall time), pauses
// and steps (of /clock). test/dynamics/limiter_over_ros.py starts it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <future>
#include <iostream>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <collision_pairs/SpeedLimit.h>
#include <collision_pairs/UpdateScene.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64MultiArray.h>
#include <sys/resource.h>

#include "dynamic_robots.h"
#include "motion_scenes.h"
#include "motion_trace.h"
#include "src/ros/node/thread_priority.h"

namespace collision_pairs {
namespace {

using Clock = std::chrono::steady_clock;
using std_msgs::Float64MultiArray;

constexpr double STEP = 0.001;  // s
constexpr std::size_t NB_STEPS = 20000;
constexpr double RUN = NB_STEPS * STEP;  // s in one scene
constexpr double PAST = 1.2;             // s between two: what was measured then is not compared
constexpr double REST = 0.5;             // s before commands
constexpr double START = 1000.0;         // s of simulated time
constexpr int PRIORITY = 60;             // above the limiter's
constexpr int LONGEST_START = 600;       // 0.1 s
// Of /clock, in s of simulated time: how often it is told, pauses and steps back, and for how long
// or far. Told at each step, at factor 3 it would take a core to send.
constexpr double CLOCK_EVERY = 0.004, PAUSE_EVERY = 7.0, PAUSE = 0.7, STEP_EVERY = 11.0,
                 STEP_BACK = 0.5;

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
  RealTimeRobot() : seed_(static_cast<unsigned>(parameter("seed", 1))) {
    if (factor_ > 0.0) clock_ = node_.advertise<rosgraph_msgs::Clock>("/clock", 10);
    states_ = node_.advertise<sensor_msgs::JointState>("joint_states", 10);
    commands_ = node_.advertise<Float64MultiArray>("command", 1);
    const auto hints = ros::TransportHints().tcpNoDelay();
    limited_ = node_.subscribe<Float64MultiArray>(
        "limited_command", 10, [this](const auto& message) { take(message->data); },
        ros::VoidConstPtr(), hints);
    limits_ = node_.subscribe<SpeedLimit>(
        "collision_pairs_node/speed_limit", 100,
        [this](const auto& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          ++nb_said_[reasonOf(*message)];
        },
        ros::VoidConstPtr(), hints);
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
  static std::string reasonOf(const SpeedLimit& limit) {
    return (limit.scale > 0.0 ? "passed: " : "stopped: ") +
           limit.reason.substr(0, limit.reason.find_first_of("0123456789"));
  }

  void run(const DynamicRobot& robot) {
    SimulationResult all;
    std::vector<std::future<SimulationResult>> judged;
    const int nb_scenes = static_cast<int>(std::ceil(parameter("seconds", 60.0) / RUN));
    for (int i = 0; i < nb_scenes && ros::ok(); ++i) judged.push_back(run(robot, seed_ + i));
    for (auto& one : judged) all.add(one.get());
    const std::lock_guard<std::mutex> lock(mutex_);
    std::cerr << "the robot was late by at most " << latest_ << " s\n";
    for (const auto& [words, number] : nb_said_)
      std::cerr << "  " << number << ' ' << words << '\n';
    std::cout << robot.robot.name << ',' << servoName(robot.servo) << ',' << all.seconds << ','
              << all.nb_contacts << ',' << all.nearest << ',' << all.nearest_links << ','
              << given_ / asked_ << std::endl;
  }

  /// In one scene; what the judge will have found of it.
  std::future<SimulationResult> run(const DynamicRobot& robot, unsigned seed) {
    const auto trace = std::make_shared<MotionTrace>(robot.joints.size(), NB_STEPS);
    SimulationOptions options = robot.options(false);
    const auto body = std::exchange(options.robot, [trace](std::vector<double> q) {
      return std::make_unique<TracedRobot>(std::move(q), trace);
    });
    SimulationOptions silent = options;
    silent.commands = [](double, const std::vector<double>& q) {
      return std::vector<double>(q.size(), 0.0);
    };
    const auto judge = std::make_shared<LimiterScene>(robot.robot, robot.joints, seed, silent);
    RandomInputs random(seed);
    options.check_every = 1e9;  // never
    options.max_speed = random.uniform(0.3, 1.0);
    LimiterScene scene(robot.robot, robot.joints, seed, options);
    const std::vector<double> from = scene.freeState(random, 0.0135);
    if (from.empty()) return std::async(std::launch::deferred, [] { return SimulationResult(); });
    start_ += RUN + PAST;
    replaceObjects(clutter(robot.robot, seed, options.nb_things));
    std::this_thread::sleep_for(std::chrono::duration<double>(PAST));
    begin();
    const auto mover = std::async(std::launch::async, [&] {
      askForRealTime(PRIORITY);
      move(robot, scene, *body(from), seed, *trace);
    });
    auto judged = std::async(std::launch::async, [judge, trace, from, seed] {
      setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 19);
      RandomInputs of_judge(seed);
      return judge->run([](const LimiterView&) { return std::nullopt; }, of_judge, RUN, from);
    });
    scene.run(
        [this](const LimiterView& view) -> std::optional<Passed> {
          if (!view.command.empty() && view.now > REST) ask(view.command);
          return std::nullopt;
        },
        random, RUN, from);
    return judged;
  }

  void replaceObjects(const std::vector<RigidObject>& objects) {
    UpdateScene update;
    update.request.changes.emplace_back();
    update.request.changes.back().operation = SceneChange::CLEAR;
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
    if (factor_ > 0.0) return ros::Time(start_ + time - back_);
    const double ago = elapsed() - time;
    return ros::Time(ros::WallTime::now().toSec() - ago);
  }
  void tellTime(double now) {
    rosgraph_msgs::Clock message;
    message.clock = stampAt(now);
    clock_.publish(message);
  }

  void move(const DynamicRobot& of, const LimiterScene& scene, SimulatedRobot& robot,
            std::uint64_t seed, MotionTrace& trace) {
    struct Measured {
      double arrival, stamp;
      std::vector<double> positions;
    };
    RandomInputs random(seed);
    const Between late{0.012, 0.015}, dead_time = *scene.options().dead_time;
    const double period = 1.0 / scene.options().state_rate.draw(random);
    const double noise = scene.options().state_noise * random.uniform(0.0, 1.0);
    std::deque<Measured> coming;  // in order, as a robot's
    double next_state = 0.0;
    for (std::size_t i = 0; i < NB_STEPS && ros::ok(); ++i) {
      const double now = static_cast<double>(i) * STEP;
      pace(now);
      for (auto& [arrival, command] : received()) {
        given_ += lengthOf(command);
        robot.command(std::max(now, arrival) + dead_time.draw(random), std::move(command));
      }
      if (now >= next_state) {
        next_state = now + period;
        coming.push_back({now + late.draw(random), now, robot.positions()});
        for (double& x : coming.back().positions) x += random.uniform(-noise, noise);
      }
      for (; !coming.empty() && coming.front().arrival <= now; coming.pop_front()) {
        publish(of, scene, coming.front().stamp, coming.front().positions);
      }
      robot.step(now, STEP);
      trace.add(robot.positions());
    }
    trace.end();
  }

  void pace(double now) {
    std::this_thread::sleep_until(begin_ + std::chrono::duration_cast<Clock::duration>(
                                               std::chrono::duration<double>(now / wallFactor())));
    latest_ = std::max(latest_, elapsed() - now);
    const auto isDue = [&](double period) { return std::fmod(now + 0.5 * STEP, period) < STEP; };
    if (private_steps_ && isDue(STEP_EVERY) && now > STEP) back_ += STEP_BACK;
    const bool pauses = private_pauses_ && std::fmod(now, PAUSE_EVERY) > PAUSE_EVERY - PAUSE;
    if (factor_ > 0.0 && !pauses && isDue(CLOCK_EVERY)) tellTime(now);
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
  void begin() {
    const std::lock_guard<std::mutex> lock(mutex_);
    begin_ = Clock::now();
    received_.clear();
  }
  void take(const std::vector<double>& command) {
    const std::lock_guard<std::mutex> lock(mutex_);
    received_.emplace_back(elapsed(), command);
  }
  std::vector<std::pair<double, std::vector<double>>> received() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(received_, {});
  }

  ros::NodeHandle node_, private_{"~"};
  const double factor_ = parameter("factor", 0.0);
  const bool private_pauses_ = private_.param("pauses", false);
  const bool private_steps_ = private_.param("steps", false);
  const unsigned seed_;
  ros::Publisher clock_, states_, commands_;
  ros::Subscriber limited_, limits_;
  Clock::time_point begin_;            // of the present scene
  double start_ = START, back_ = 0.0;  // s
  double latest_ = 0.0;                // s
  double asked_ = 0.0, given_ = 0.0;
  std::mutex mutex_;                    // guards what follows
  std::map<std::string, int> nb_said_;  // of ~speed_limit, by what it says
  std::vector<std::pair<double, std::vector<double>>> received_;
};

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  // Before roscpp starts its threads, which inherit it: they receive and send.
  const std::string no_real_time = collision_pairs::askForRealTime(collision_pairs::PRIORITY);
  if (!no_real_time.empty()) std::cerr << no_real_time << '\n';
  ros::init(argc, argv, "dynamic_robot");
  ros::AsyncSpinner spinner(1);
  collision_pairs::RealTimeRobot robot;
  spinner.start();
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);
  robot.run(collision_pairs::dynamicRobots());  // also says where their meshes are
  return 0;
}
