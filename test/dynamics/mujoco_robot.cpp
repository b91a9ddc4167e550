#include "mujoco_robot.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "collision_pairs/aabb.h"
#include "joint_sampler.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double DENSITY = 700.0;                      // kg/m^3 of the box around an element
constexpr double LEAST_SIZE = 0.02, LEAST_MASS = 0.2;  // m and kg of a link
constexpr double STEP = 0.001;                         // s
constexpr int POSTURES = 200;
constexpr double MORE_TORQUE = 1.5;      // times what gravity and ramps need at most
constexpr double ARMATURE = 0.3;         // of a motor, as a share of the mean inertia it moves
constexpr double LEAST_ARMATURE = 0.02;  // kg m^2
constexpr double FRICTION = 0.05;        // of the most torque: dry; the same at 1 rad/s: viscous
constexpr double RAMPS[] = {5.0, 4.0, 6.0};  // rad/s^2, of joints in turn
// 1/s. Of the ramp's tracking, critically damped; of the velocity loop and its integral.
constexpr double TRACKING = 80.0, VELOCITY_LOOP = 150.0, INTEGRAL = 40.0;
constexpr double MOST_PROPORTIONAL = 0.4;  // share of the torque: where the velocity loop saturates
constexpr double KNOWN_GRAVITY = 0.95;     // share of gravity that the ramp's feed-forward knows

std::string inXml(const Vector3d& p) {
  std::ostringstream text;
  text.precision(17);
  text << p[0] << ' ' << p[1] << ' ' << p[2];
  return text.str();
}

std::string placed(const Isometry3d& X) {
  const Eigen::Quaterniond q(X.linear());
  std::ostringstream text;
  text.precision(17);
  text << " pos='" << inXml(X.translation()) << "' quat='" << q.w() << ' ' << inXml(q.vec()) << "'";
  return text.str();
}

std::string massOf(const Element& element, const Isometry3d& X_BE) {
  const Aabb box = computeAabb(element.shape, Isometry3d::Identity());
  if (!(box.max - box.min).allFinite()) return "";  // a floor
  const Vector3d size = (box.max - box.min).cwiseMax(LEAST_SIZE);
  const Isometry3d X_BC = X_BE * Eigen::Translation3d(box.center());
  return "<geom type='box' size='" + inXml(0.5 * size) + "' mass='" +
         std::to_string(std::max(DENSITY * size.prod(), LEAST_MASS)) + "'" + placed(X_BC) + "/>";
}

class Mjcf {
 public:
  Mjcf(const RobotModel& robot, const std::vector<std::string>& joints,
       const std::vector<RigidObject>& attached)
      : robot_(robot), zero_(robot.zeroPositions()), inside_(robot.bodies().size()) {
    for (const std::string& name : joints) driven_.push_back(robot.findJoint(name));
    for (const Link& link : robot.links()) {
      for (const Element& element : link.elements) {
        inside_[link.body] += massOf(element, link.X_BL * element.X_LE);
      }
    }
    for (const RigidObject& object : attached) {
      const Link& link = robot.links()[robot.findLink(object.attached_link)];
      for (const Element& element : object.elements) {
        inside_[link.body] += massOf(element, link.X_BL * object.X_PO * element.X_LE);
      }
    }
  }

  std::string text() const {
    std::string bodies;
    for (std::size_t i = 0; i < robot_.bodies().size(); ++i) {
      if (robot_.bodies()[i].parent < 0) bodies += body(static_cast<int>(i));
    }
    return "<mujoco><compiler angle='radian'/><option timestep='" + std::to_string(STEP) +
           "' integrator='Euler'><flag contact='disable'/></option><default><geom contype='0' "
           "conaffinity='0'/></default><worldbody>" +
           bodies + "</worldbody></mujoco>";
  }

 private:
  std::string body(int i) const {
    const Body& body = robot_.bodies()[i];
    const bool is_driven = std::find(driven_.begin(), driven_.end(), body.joint) != driven_.end();
    Isometry3d X_PB = body.X_PJ;
    std::string inside = inside_[i];
    if (body.joint >= 0) {
      const Joint& joint = robot_.joints()[body.joint];
      if (is_driven) {
        inside += "<joint name='" + joint.name + "' axis='" + inXml(joint.axis) + "' type='" +
                  (joint.type == JointType::PRISMATIC ? "slide" : "hinge") + "'/>";
        if (inside_[i].empty()) {
          inside += "<geom type='sphere' size='" + std::to_string(LEAST_SIZE) + "' mass='" +
                    std::to_string(LEAST_MASS) + "'/>";
        }
      } else {
        X_PB = X_PB * joint.motion(zero_[body.joint]);
      }
    }
    for (std::size_t child = 0; child < robot_.bodies().size(); ++child) {
      if (robot_.bodies()[child].parent == i) inside += this->body(static_cast<int>(child));
    }
    return "<body" + placed(X_PB) + ">" + inside + "</body>";
  }

  const RobotModel& robot_;
  const std::vector<double> zero_;
  std::vector<std::string> inside_;  // by body: its boxes
  std::vector<int> driven_;
};

mjModel* loaded(const std::string& text) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  const char* const name = "robot.xml";
  mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(text.size()) + 1);
  std::memcpy(files->filedata[0], text.c_str(), text.size() + 1);
  char error[1000] = "";
  mjModel* model = mj_loadXML(name, files.get(), error, sizeof(error));
  mj_deleteVFS(files.get());
  if (model == nullptr) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

using Data = std::unique_ptr<mjData, void (*)(mjData*)>;

Data dataFor(const mjModel* model) { return {mj_makeData(model), mj_deleteData}; }

}  // namespace

const char* servoName(Servo servo) { return servo == Servo::RAMP ? "ramp" : "PI"; }

RobotWithMass::RobotWithMass(const RobotModel& robot, const std::vector<std::string>& joints,
                             const std::vector<RigidObject>& attached)
    : model_(loaded(Mjcf(robot, joints, attached).text()), mj_deleteModel) {
  findMotors(joints);
}

void RobotWithMass::findMotors(const std::vector<std::string>& joints) {
  mjModel& model = *model_;
  const auto nb = static_cast<std::size_t>(model.nv);
  std::vector<double> gravity(nb), coupled(nb), mean(nb), most(nb), full(nb * nb), ramp(nb);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int id = mj_name2id(&model, mjOBJ_JOINT, joints[i].c_str());
    heaviest_.emplace_back(joints.size(), 0.0);
    motors_.push_back({model.jnt_dofadr[id], RAMPS[i % 3], 0.0, 0.0});
    ramp[motors_.back().address] = motors_.back().ramp;
  }
  const Data data = dataFor(&model);
  RandomInputs random(1);
  // First for the links alone, then with the motors' inertia.
  for (int round = 0; round < 2; ++round) {
    std::fill(mean.begin(), mean.end(), 0.0);
    std::fill(most.begin(), most.end(), 0.0);
    for (int i = 0; i < POSTURES; ++i) {
      for (std::size_t j = 0; j < nb; ++j) data->qpos[j] = random.uniform(-2.0, 2.0);
      mj_forward(&model, data.get());
      mj_fullM(&model, full.data(), data->qM);
      for (std::size_t m = 0; m < motors_.size(); ++m) {
        const auto j = static_cast<std::size_t>(motors_[m].address);
        if (full[j * nb + j] <= most[j]) continue;
        for (std::size_t k = 0; k < motors_.size(); ++k) {
          heaviest_[m][k] = data->qpos[motors_[k].address];
        }
      }
      for (std::size_t j = 0; j < nb; ++j) {
        double sum = 0.0;
        for (std::size_t k = 0; k < nb; ++k) sum += std::abs(full[j * nb + k]) * ramp[k];
        gravity[j] = std::max(gravity[j], std::abs(data->qfrc_bias[j]));
        coupled[j] = std::max(coupled[j], sum);
        mean[j] += full[j * nb + j] / POSTURES;
        most[j] = std::max(most[j], full[j * nb + j]);
      }
    }
    for (std::size_t j = 0; j < nb && round == 0; ++j) {
      model.dof_armature[j] = std::max(ARMATURE * mean[j], LEAST_ARMATURE);
    }
  }
  for (Motor& motor : motors_) {
    const int j = motor.address;
    motor.inertia = mean[j];
    motor.most_torque = MORE_TORQUE * (gravity[j] + coupled[j]);
    model.dof_frictionloss[j] = FRICTION * motor.most_torque;
    model.dof_damping[j] = FRICTION * motor.most_torque;
  }
}

MujocoRobot::MujocoRobot(std::shared_ptr<const RobotWithMass> robot, Servo servo,
                         std::vector<double> positions, const RobotFault& fault)
    : SimulatedRobot(positions),
      robot_(std::move(robot)),
      servo_(servo),
      fault_(fault),
      data_(dataFor(robot_->model())),
      set_velocities_(positions.size(), 0.0),
      set_positions_(positions),
      integrals_(positions.size(), 0.0) {
  const auto& motors = robot_->motors();
  for (std::size_t j = 0; j < motors.size(); ++j) data_->qpos[motors[j].address] = positions[j];
  mj_forward(robot_->model(), data_.get());
  for (std::size_t j = 0; j < motors.size(); ++j) {
    integrals_[j] = data_->qfrc_bias[motors[j].address];
  }
}

double MujocoRobot::ramped(std::size_t joint, double wanted, double seconds) {
  const RobotWithMass::Motor& motor = robot_->motors()[joint];
  double& velocity = set_velocities_[joint];
  const double most = motor.ramp * seconds;
  const double change = std::clamp(wanted - velocity, -most, most);
  set_positions_[joint] += (velocity + 0.5 * change) * seconds;
  velocity += change;
  const double behind = set_positions_[joint] - data_->qpos[motor.address];
  const double slower = velocity - data_->qvel[motor.address];
  return KNOWN_GRAVITY * data_->qfrc_bias[motor.address] +
         motor.inertia *
             (TRACKING * TRACKING * behind + 2.0 * TRACKING * slower + change / seconds);
}

double MujocoRobot::proportional(std::size_t joint, double wanted, double seconds) {
  const RobotWithMass::Motor& motor = robot_->motors()[joint];
  const double slower = wanted - data_->qvel[motor.address];
  const double gain = VELOCITY_LOOP * motor.inertia;
  const double most = MOST_PROPORTIONAL * motor.most_torque;
  const bool is_saturated = std::abs(gain * slower) > most;
  if (!is_saturated) integrals_[joint] += gain * INTEGRAL * slower * seconds;
  return std::clamp(gain * slower, -most, most) + integrals_[joint];
}

void MujocoRobot::move(const std::vector<double>& wanted, double seconds) {
  const auto& motors = robot_->motors();
  const auto isZero = [](double x) { return x == 0.0; };
  const bool stands = std::all_of(wanted.begin(), wanted.end(), isZero);
  const bool is_pushed = !fault_.push.empty() && time_ >= fault_.push_from;
  std::vector<double> told = wanted;
  if (fault_.exchanges_joints) std::swap(told[1], told[2]);
  for (std::size_t j = 0; j < motors.size(); ++j) {
    const double most = motors[j].most_torque;
    double torque =
        servo_ == Servo::RAMP ? ramped(j, told[j], seconds) : proportional(j, told[j], seconds);
    if (stands && fault_.sags > 0.0) {
      torque = (1.0 - fault_.sags) * data_->qfrc_bias[motors[j].address];
    }
    data_->qfrc_applied[motors[j].address] =
        std::clamp(torque, -most, most) + (is_pushed ? fault_.push[j] * most : 0.0);
  }
  time_ += seconds;
  mj_step(robot_->model(), data_.get());
  for (std::size_t j = 0; j < motors.size(); ++j) {
    positions_[j] = data_->qpos[motors[j].address];
    if (!std::isfinite(positions_[j])) throw std::runtime_error("the simulation has diverged");
  }
}

}  // namespace collision_pairs
