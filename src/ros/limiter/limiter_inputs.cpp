#include "limiter_inputs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double CLOCK_SET = 0.003;  // s, by which the computer's clock was set, at least

/// A joint that follows another is placed by that, so it has to be there.
void requireFollowers(const LimiterInputs::Moment& moment, const RobotModel& robot,
                      std::vector<double> positions, const std::vector<char>& is_measured,
                      std::vector<std::string>& reasons) {
  robot.applyMimics(positions);
  for (const auto& measured : moment.positions) {
    int leader = robot.findJoint(measured.joint);
    const auto id = static_cast<std::size_t>(leader);
    if (leader < 0 || !robot.joints()[leader].mimic || measured.age > moment.young) continue;
    while (robot.joints()[leader].mimic) leader = robot.joints()[leader].mimic->joint;
    const double off = std::abs(measured.value - positions[id]);
    if (!is_measured[static_cast<std::size_t>(leader)] || off <= moment.tolerance) continue;
    reasons.push_back("joint '" + measured.joint + "' is " + formatted("%.3f", off) +
                      " (rad or m) off where joint '" + robot.joints()[leader].name +
                      "' has it, which it follows (<mimic>)");
  }
}

}  // namespace

LimiterInputs::LimiterInputs(Settings settings)
    : settings_(std::move(settings)),
      clock_(settings_.is_simulated),
      taken_stamps_(settings_.joints.size(), -1.0) {}

CommandOutlet::Time LimiterInputs::follow(const Clocks& clocks) {
  if (clock_.follow(clocks.ros, clocks.steady, clocks.nb_jumps)) {
    positions_.clear();
    has_jumped_ = true;
  }
  return {clock_.law(), clock_.lawLatest(), clocks.steady};
}

LimiterInputs::Taken LimiterInputs::take(const sensor_msgs::JointState& message,
                                         const Clocks& clocks) {
  follow(clocks);
  positions_.take(message, clock_.clock(), settings_.max_joint_state_age);
  clock_.receive(positions_.newestStampOf(settings_.joints));
  Taken taken{std::exchange(has_jumped_, false), {}};
  if (!settings_.is_simulated) {  // stamps are brought to the time of the law by their difference
    const double offset = clocks.ros - clocks.steady;
    taken.has_jumped = taken.has_jumped || std::abs(offset - offset_) > CLOCK_SET;
    offset_ = offset;
  }
  for (std::size_t joint = 0; joint < settings_.joints.size(); ++joint) {
    const auto found = positions_.all().find(settings_.joints[joint]);
    if (found == positions_.all().end() || found->second.stamp == taken_stamps_[joint]) continue;
    const JointPositions::Position& position = found->second;
    taken_stamps_[joint] = position.stamp;
    taken.positions.push_back(
        {joint, clock_.lawAt(position.stamp, position.measured), position.value});
  }
  return taken;
}

LimiterInputs::Moment LimiterInputs::at(const Clocks& clocks, double later) {
  Moment moment;
  const CommandOutlet::Time time = follow(clocks);
  moment.nb_jumps = clocks.nb_jumps;
  moment.now = clock_.upper() + later;
  moment.input.now = time.latest + later;
  const double stands = clock_.standsFor(time.steady);
  if (!settings_.allow_paused && stands > settings_.command_timeout) {
    moment.unknown_because.push_back(
        "/clock stands still since " + inWords(stands) +
        " of wall time, and no joint state is later; if it may pause, set "
        "allow_paused");
  }
  const double most_age = settings_.max_joint_state_age;
  try {
    const double oldest = positions_.oldestOf(settings_.joints, clock_.clock(), most_age);
    moment.input.stamp = moment.input.now - (moment.now - oldest);
    for (const std::string& joint : settings_.joints) {
      moment.input.later.push_back(positions_.all().at(joint).measured - oldest);
    }
  } catch (const InputError& error) {
    moment.unknown_because.push_back(error.what());
  }
  // Of the command's joints none may be older than `most_age`; the others stand.
  const double of_others = settings_.max_pose_age;
  const double oldest = of_others > 0.0 ? std::max(most_age, of_others) : HUGE_VAL;
  for (const auto& [name, position] : positions_.all()) {
    const double age = moment.now - position.measured;
    if (age <= oldest) moment.positions.push_back({name, position.value, age});
  }
  moment.moved = settings_.joints;
  moment.young = most_age;
  moment.tolerance = settings_.tracking_tolerance;
  return moment;
}

Snapshot snapshotAt(const LimiterInputs::Moment& moment, const Monitor& monitor,
                    LimiterInput& input, RobotState& state) {
  const TransformInput& transforms = monitor.transforms();
  std::vector<std::string> reasons;
  const std::string still = transforms.clockProblem();  // nothing is seen to age
  if (transforms.now().stamp.isZero()) reasons.push_back(NO_CLOCK);
  if (!still.empty()) reasons.push_back(still);
  reasons.insert(reasons.end(), moment.unknown_because.begin(), moment.unknown_because.end());
  if (!reasons.empty()) {
    Snapshot unusable;
    unusable.poses.unknown_because = std::move(reasons);
    return unusable;
  }
  const ActiveScenePtr active = monitor.scenes().active();
  if (!active) throw InputError("there is no robot yet");
  const RobotModel& robot = active->scene->robot();
  std::vector<std::string> names;
  std::vector<double> values;
  std::vector<char> is_measured(robot.joints().size(), 0);
  for (const auto& measured : moment.positions) {
    const int id = robot.findJoint(measured.joint);
    if (id < 0 || !robot.joints()[id].hasPosition() || robot.joints()[id].mimic) continue;
    names.push_back(measured.joint);
    values.push_back(measured.value);
    is_measured[static_cast<std::size_t>(id)] = 1;
  }
  Snapshot snapshot = monitor.withMeasured(active, names, moment.moved);
  if (transforms.nbClockJumps() != moment.nb_jumps) {
    snapshot.poses.unknown_because.push_back("the clock went back meanwhile");
  }
  input.now = moment.input.now;
  input.stamp = moment.input.stamp;
  input.later = moment.input.later;
  state.positions = snapshot.joints->jointPositionsAt(values);
  requireFollowers(moment, robot, state.positions, is_measured, snapshot.poses.unknown_because);
  state.placed = snapshot.joints->placedBodies();
  state.voxels = snapshot.poses.voxels;
  if (!active->scene->clouds().empty()) {
    input.obstacles_age = std::max(0.0, moment.now - snapshot.oldest_cloud);
  }
  return snapshot;
}

}  // namespace collision_pairs
