#include "limiter_simulation.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "collision_pairs/aabb.h"
#include "collision_pairs/occupied_voxels.h"
#include "demo_scene.h"
#include "joint_sampler.h"
#include "limiter_commands.h"
#include "motion_scenes.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double STEP = 0.001;  // s of the robot
constexpr double MOVER_SIZE = 0.12, VOXEL_SIZE = 0.05;
constexpr double REACH = 2.0;  // m: no point of a robot is further from the axis of a joint
constexpr int MOST_DRAWS = 10000;
constexpr double VIEW_EVERY = 0.033;  // s between views of the moving box
const char* const CLOUD = "camera";

std::shared_ptr<const RobotModel> moverRobot() {
  std::string xml =
      emptyLink("start") + emptyLink("along_x") + emptyLink("along_y") + boxLink("box", MOVER_SIZE);
  const char* const links[] = {"start", "along_x", "along_y", "box"};
  const char* const axes[] = {"1 0 0", "0 1 0", "0 0 1"};
  for (int i = 0; i < 3; ++i) {
    xml += joint(std::string(1, "xyz"[i]), "prismatic", links[i], links[i + 1], "0 0 0",
                 std::string("<axis xyz='") + axes[i] + "'/><limit lower='-9' upper='9'/>");
  }
  return robotFrom(xml);
}

/// Every voxel that the box touches.
std::shared_ptr<const OccupiedVoxels> voxelsOf(const Vector3d& center) {
  std::vector<VoxelCell> cells;
  const Eigen::Array3d half = Eigen::Array3d::Constant(0.5 * MOVER_SIZE + 1e-9);
  const Eigen::Array3i low = ((center.array() - half) / VOXEL_SIZE).floor().cast<int>();
  const Eigen::Array3i high = ((center.array() + half) / VOXEL_SIZE).floor().cast<int>();
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) cells.emplace_back(x, y, z);
    }
  }
  return std::make_shared<const OccupiedVoxels>(VOXEL_SIZE, cells);
}

double lengthOf(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

}  // namespace

void SimulationResult::add(const SimulationResult& other) {
  RobotsPart::add(other);
  seconds += other.seconds;
  first_contact = std::min(first_contact, other.first_contact);
  nb_stops += other.nb_stops;
  nb_commands += other.nb_commands;
  passed += other.passed;
  asked += other.asked;
  nb_retreats += other.nb_retreats;
  nb_retreats_slowed += other.nb_retreats_slowed;
}

std::vector<std::string> limitedJoints(const BenchmarkRobot& robot) {
  const std::string suffix = "_joint";
  if (robot.name == "ur5") {
    return {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
            "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
  }
  std::vector<std::string> joints;
  if (robot.name == "panda") {
    for (int i = 1; i <= 7; ++i) joints.push_back("panda_joint" + std::to_string(i));
    return joints;
  }
  if (robot.name == "demo") {
    return {"shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex",
            "forearm_roll", "wrist_flex",    "wrist_roll"};
  }
  for (const std::string side : {"l_", "r_"}) {
    for (const char* name : {"shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex",
                             "forearm_roll", "wrist_flex", "wrist_roll"}) {
      joints.push_back(side + name + suffix);
    }
  }
  return joints;
}

RigidObject heldBox(const RobotModel& robot, const std::string& last_joint) {
  const int id = robot.findJoint(last_joint), first = robot.joints()[id].child_link;
  const auto& bodies = robot.bodies();
  std::vector<Eigen::Isometry3d> X_RB;
  robot.forwardKinematics(robot.zeroPositions(), X_RB);
  const int hand = robot.links()[first].body;
  const Vector3d axis = robot.joints()[id].axis;
  double along = 0.0, against = 0.0;  // m from the joint to where all it moves ends
  for (const Link& link : robot.links()) {
    int body = link.body;
    while (body > hand) body = bodies[body].parent;
    if (body != hand) continue;
    for (const Element& element : link.elements) {
      const Aabb box = computeAabb(
          element.shape, X_RB[hand].inverse() * X_RB[link.body] * link.X_BL * element.X_LE);
      const double middle = axis.dot(box.center());
      const double half = axis.cwiseAbs().dot(0.5 * (box.max - box.min));
      along = std::max(along, middle + half);
      against = std::min(against, middle - half);
    }
  }
  constexpr double SIZE = 0.08;
  RigidObject held;
  held.name = "held";
  held.attached_link = robot.links()[first].name;
  held.elements.push_back({Box{Vector3d::Constant(SIZE)}, Eigen::Isometry3d::Identity()});
  held.X_PO.translation() = axis * (along > -against ? along + SIZE : against - SIZE);
  return held;
}

/// A box that crosses the robot's surroundings at less than the obstacle speed, and turns back
/// where it would leave them or has run into a robot that stands.
class LimiterScene::Mover {
 public:
  Mover(double speed, RandomInputs& random) : random_(random), speed_(speed) {
    position_ = random.vector(-1.0, 1.0).normalized() * 1.3 + Vector3d(0, 0, 0.5);
    turn();
  }
  void step(double seconds) {
    if (speed_ == 0.0) return;
    position_ += seconds * velocity_;
    if ((position_ - Vector3d(0, 0, 0.5)).norm() > 1.5 || random_.uniform(0, 1) < 0.2 * seconds)
      turn();
  }
  void turnBack(double seconds) {
    position_ -= seconds * velocity_;
    turn();
  }
  const Vector3d& position() const { return position_; }

 private:
  void turn() {
    const Vector3d goal = random_.vector(-0.6, 0.6) + Vector3d(0, 0, 0.5);
    velocity_ = speed_ * random_.uniform(0.2, 0.99) * (goal - position_).normalized();
  }
  RandomInputs& random_;
  const double speed_;
  Vector3d position_, velocity_;
};

LimiterScene::LimiterScene(const BenchmarkRobot& robot, std::vector<std::string> joints,
                           std::uint64_t index, const SimulationOptions& options)
    : joints_(std::move(joints)), options_(options), zero_(robot.robot->zeroPositions()) {
  SceneDescription description;
  description.robots.push_back({robot.robot, robot.srdf, ""});
  description.objects = clutter(robot, index, options.nb_things);
  if (options.holds_box) description.objects.push_back(heldBox(*robot.robot, joints_.back()));
  if (options.obstacle_speed > 0.0) {
    description.clouds.push_back(cloudOf(CLOUD, VOXEL_SIZE, {}));
  }
  seen_ = CollisionScene::build(description, &sceneCache());
  description.clouds.clear();
  if (options.obstacle_speed > 0.0) {
    description.robots.push_back({moverRobot(), std::nullopt, LimiterJudge::MOVER});
  }
  judge_ =
      std::make_unique<LimiterJudge>(CollisionScene::build(description, &sceneCache()), joints_);
  const JointSampler sampler(robot.robot, 1);
  for (const std::string& name : joints_) {
    const auto& range = sampler.ranges()[robot.robot->findJoint(name)];
    lower_.push_back(std::max(range.lower, -3.0));
    upper_.push_back(std::min(range.upper, 3.0));
  }
}

LimiterSettings LimiterScene::settings() const {
  LimiterSettings settings;
  settings.deceleration = options_.decelerations;
  settings.deceleration.resize(joints_.size(), options_.deceleration);
  settings.reaction_time = options_.reaction_time;
  settings.command_timeout = options_.command_timeout;
  settings.obstacle_speed = options_.obstacle_speed;
  settings.tracking_tolerance = options_.tracking_tolerance;
  return settings;
}

std::vector<double> LimiterScene::allPositions(const std::vector<double>& q) const {
  std::vector<double> all = zero_;
  for (std::size_t i = 0; i < q.size(); ++i) all[seen_->robot().findJoint(joints_[i])] = q[i];
  seen_->robot().applyMimics(all);
  return all;
}

std::vector<double> LimiterScene::drawState(RandomInputs& random) const {
  std::vector<double> q(joints_.size());
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = random.uniform(lower_[i], upper_[i]);
  return q;
}

std::vector<double> LimiterScene::freeState(RandomInputs& random, double clearance,
                                            const Vector3d& mover) {
  for (int i = 0; i < MOST_DRAWS; ++i) {
    std::vector<double> q = drawState(random);
    if (judge_->distanceAt(q, mover, clearance) > clearance) return q;
  }
  return {};
}

std::unique_ptr<SimulatedRobot> LimiterScene::robotAt(std::vector<double> q,
                                                      RandomInputs& random) const {
  if (options_.robot) return options_.robot(std::move(q));
  std::vector<double> acceleration(joints_.size());
  for (double& a : acceleration) a = options_.deceleration * random.uniform(1.0, 4.0);
  const bool is_slowest = random.integer(0, 1) == 0;
  if (is_slowest) acceleration.assign(joints_.size(), options_.deceleration);
  return std::make_unique<SimulatedJoints>(std::move(q), std::move(acceleration));
}

SimulationResult LimiterScene::run(const Limiter& limiter, RandomInputs& random, double seconds,
                                   std::vector<double> from) {
  SimulationResult result;
  result.seconds = seconds;
  judge_->begin();
  Mover mover(options_.obstacle_speed, random);
  CertifiedSurroundings probe(seen_, joints_, Fidelity::MESH);
  Commands commands(*this, random, probe);
  if (from.empty()) from = freeState(random, 0.0135, mover.position());
  if (from.empty()) return {};
  const std::unique_ptr<SimulatedRobot> robot = robotAt(std::move(from), random);
  // Dead times change with every command, between a bound of this run and the reaction time.
  const double shortest = random.uniform(0.0, 1.0) * options_.reaction_time;
  const Between dead_time = options_.dead_time.value_or(
      Between{shortest, std::max(options_.reaction_time - STEP, shortest)});
  const double state_period = 1.0 / options_.state_rate.draw(random);
  const double command_period = 1.0 / random.uniform(30.0, 250.0);
  const double noise = options_.state_noise * random.uniform(0.0, 1.0);
  const auto measured = [&] {
    std::vector<double> q = robot->positions();
    for (double& x : q) x += noise > 0.0 ? random.uniform(-noise, noise) : 0.0;
    return q;
  };

  struct Measured {
    double known_from, stamp;
    std::vector<double> positions;
  };
  std::deque<Measured> coming;
  LimiterView view{0.0, 0.0, 0.0, {}, {}};
  std::vector<double> newest = robot->positions(), checked = robot->positions();
  double next_state = 0.0, next_command = 0.0, next_view = 0.0, next_check = 0.0, viewed = 0.0;
  double last_command = 0.0, view_stops_until = 0.0;
  bool has_passed_zeros = true;
  Vector3d seen_at = mover.position();
  const long nb_steps = std::lround(seconds / STEP);
  for (long i = 0; i < nb_steps; ++i) {
    const double now = static_cast<double>(i) * STEP;
    if (now >= next_state) {
      next_state = now + state_period;
      const bool is_lost = options_.disturbed && random.uniform(0, 1) < 0.2;
      Between late = options_.state_late;
      if (options_.disturbed && random.uniform(0, 1) < 0.1) late.high = 0.15;
      if (!is_lost) coming.push_back({now + late.draw(random), now, measured()});
    }
    bool stops = false;
    for (auto it = coming.begin(); it != coming.end();) {
      if (it->known_from > now) {
        ++it;
        continue;
      }
      stops = (options_.watch && options_.watch(now, it->stamp, it->positions)) || stops;
      if (it->stamp > view.stamp) {  // the newest, in whatever order they come
        view.stamp = it->stamp;
        newest = it->positions;
      }
      it = coming.erase(it);
    }
    if (now >= next_view && now >= view_stops_until) {
      next_view = now + VIEW_EVERY;
      if (options_.disturbed && random.uniform(0, 1) < 0.01) view_stops_until = now + 1.0;
      viewed = now;
      seen_at = mover.position();
    }
    std::optional<Passed> passed;
    view.now = now;
    if (now >= next_command) {
      next_command = now + command_period;
      const std::vector<double> wanted = commands.at(now, robot->positions());
      view.obstacles_age = options_.obstacle_speed > 0.0 ? now - viewed : 0.0;
      view.state.positions = allPositions(newest);
      view.state.voxels.clear();
      if (options_.obstacle_speed > 0.0) view.state.voxels = {voxelsOf(seen_at)};
      if (!commands.isSilent()) {
        last_command = now;
        view.command = wanted;
        if (options_.disturbed && random.uniform(0, 1) < 0.01) view.command[0] = NAN;
        // A cloud that is too old is not known: the node says so.
        if (options_.disturbed && view.obstacles_age > 0.5) view.state.voxels = {nullptr};
        passed = limiter(view);
        has_passed_zeros = false;
        if (passed) {
          next_command = std::max(next_command, now + passed->took);
          note(view, passed->command, probe, result);
        }
      }
    }
    if (!has_passed_zeros && (stops || now - last_command >= options_.command_timeout)) {
      has_passed_zeros = true;
      view.command.clear();
      passed = limiter(view);
    }
    if (passed) {
      passed->command.resize(joints_.size(), 0.0);
      robot->command(now + passed->took + dead_time.draw(random), std::move(passed->command));
    }
    if (options_.pace) options_.pace(now, *robot);
    robot->step(now, STEP);
    mover.step(STEP);
    double moved = 0.0;  // by any point, relative to any other, since the last check
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      moved += REACH * std::abs(robot->positions()[j] - checked[j]);
    }
    const bool may_be_nearer = options_.obstacle_speed > 0.0 || moved > judge_->room();
    if (now >= next_check && may_be_nearer) {
      next_check = now + options_.check_every - 0.5 * STEP;
      const bool touches = judge_->judge(checked, robot->positions(), mover.position(),
                                         settings().stop_distance, result);
      checked = robot->positions();
      if (result.nb_contacts > 0) result.first_contact = std::min(result.first_contact, now);
      if (touches && options_.obstacle_speed > 0.0) mover.turnBack(0.05);
    }
  }
  return result;
}

void LimiterScene::note(const LimiterView& view, const std::vector<double>& passed,
                        CertifiedSurroundings& probe, SimulationResult& result) {
  const double asked = lengthOf(view.command), given = lengthOf(passed);
  if (!(asked > 0.0)) return;
  ++result.nb_commands;
  result.asked += asked;
  result.passed += given;
  if (given == 0.0) ++result.nb_stops;
  std::vector<NearPair> near;
  std::string why;
  probe.setState(view.state);
  if (!probe.nearPairs(0.02, view.command, near, why) || near.empty()) return;
  for (const NearPair& pair : near) {
    if (!(pair.derivative > 0.0)) return;
  }
  ++result.nb_retreats;
  if (given < 0.99 * asked) ++result.nb_retreats_slowed;
}

}  // namespace collision_pairs
