// Obstacles come from everywhere, touch a link, are held there and go, before simulated depth
// cameras: from contact on the verdict is not FREE, and it is FREE once they are gone.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>

#include <gtest/gtest.h>

#include "benchmark/demo_motion.h"
#include "cloud_gatherer.h"
#include "cloud_view.h"
#include "collision_pairs/collision_detector.h"
#include "demo_scene.h"
#include "depth_image.h"
#include "random_inputs.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Poses = std::vector<Isometry3d>;

constexpr double PERIOD = 1.0 / 15.0;                         // s, between clouds
constexpr double NOISE = 0.005, MOST_NOISE = 3.0 * NOISE;     // m, of a depth
constexpr double GONE = 0.30;                                 // m
constexpr int WIDTH = 320, HEIGHT = 240, FOCAL_LENGTH = 450;  // pixels
constexpr double INF = std::numeric_limits<double>::infinity();

bool isLong() { return std::getenv("COLLISION_PAIRS_LONG") != nullptr; }

Isometry3d moved(const Vector3d& by) { return Isometry3d(Eigen::Translation3d(by)); }

struct Part {
  std::shared_ptr<const PreparedShape> shape;
  Isometry3d X;
  double radius;  ///< about X's origin
};

Part partOf(const Shape& shape, const Isometry3d& X) {
  const Aabb box = computeAabb(shape, Isometry3d::Identity());
  return {prepareShape(shape), X, box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).norm()};
}

struct Obstacle {
  std::string name;
  std::vector<Part> parts;  ///< in its own frame
};

enum Kind { BALL, FINGERTIP, SHEET, BAR, HAND, NB_KINDS };

/// `size` in metres: the diameter of a ball.
Obstacle obstacleOf(Kind kind, double size, RandomInputs& random) {
  Obstacle made;
  const auto add = [&](const Shape& shape, const Vector3d& at = Vector3d::Zero()) {
    made.parts.push_back(partOf(shape, moved(at)));
  };
  switch (kind) {
    case BALL:
      made.name = "ball of " + std::to_string(std::lround(1000.0 * size)) + " mm";
      add(Sphere{0.5 * size});
      break;
    case FINGERTIP:
      made.name = "fingertip";
      add(Capsule{0.004, 0.004});
      break;
    case SHEET:
      made.name = "sheet";
      add(Box{
          {random.uniform(0.03, 0.3), random.uniform(0.03, 0.3), random.uniform(0.001, 0.005)}});
      break;
    case BAR:
      made.name = "bar";
      add(Capsule{random.uniform(0.004, 0.02), random.uniform(0.1, 0.6)});
      break;
    default:
      made.name = "hand";
      add(Box{{0.085, 0.03, 0.09}});
      add(Capsule{0.03, 0.2}, {0.0, 0.0, -0.15});
      for (int finger = 0; finger < 4; ++finger) {
        add(Capsule{0.008, 0.06}, {-0.032 + 0.021 * finger, 0.0, 0.075});
      }
  }
  return made;
}

Obstacle randomObstacle(RandomInputs& random) {
  const auto kind = static_cast<Kind>(random.integer(0, NB_KINDS - 1));
  return obstacleOf(kind, 0.004 * std::pow(15.0, random.uniform(0.0, 1.0)), random);
}

/// A robot, the links it has, and the cloud of each camera.
class Setting {
 public:
  Setting(const BenchmarkRobot& robot, int nb_cameras) : robot_(robot.robot) {
    description_.robots.push_back({robot_, std::nullopt, ""});
    description_.check_self = false;
    for (int i = 0; i < nb_cameras; ++i) {
      CloudConfig config;
      config.topic = "camera_" + std::to_string(i);
      config.min_valid_points = 0;
      configs.push_back(config);
      description_.clouds.push_back(obstacleOf(config));
    }
    scene = CollisionScene::build(description_);
    SceneDescription bare = description_;
    for (RigidObject& cloud : bare.clouds) cloud.padding = 0.0;
    bare_scene = CollisionScene::build(bare);
    for (const CloudConfig& config : configs) filters.emplace_back(description_, *scene, config);
    for (const Link& link : robot_->links()) {
      for (const Element& element : link.elements) {
        parts_.push_back({link.body, partOf(element.shape, link.X_BL * element.X_LE)});
      }
    }
  }

  BodyPoses posesOf(const std::vector<SceneBody>& bodies, const Poses& X_WB) const {
    BodyPoses poses;
    poses.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      poses.X_WB[i] = X_WB[static_cast<std::size_t>(bodies[i].body)];
    }
    return poses;
  }

  /// Of the obstacle from the nearest link, no more than `most`; and its nearest point, in W.
  double distance(const Poses& X_WB, const Obstacle& obstacle, const Isometry3d& X_WO, double most,
                  Vector3d* nearest = nullptr) {
    for (const auto& [body, part] : parts_) {
      const Isometry3d X_WE = X_WB[static_cast<std::size_t>(body)] * part.X;
      for (const Part& other : obstacle.parts) {
        const Isometry3d X_EP = X_WE.inverse() * X_WO * other.X;
        if (X_EP.translation().norm() - part.radius - other.radius > most) continue;
        const PairDistance found = narrow_phase_.distance(*part.shape, *other.shape, X_EP, most);
        if (found.distance >= most) continue;
        most = found.distance;
        if (nearest) *nearest = X_WE * found.p_ACb;
      }
    }
    return most;
  }

  void draw(const Poses& X_WB, const Isometry3d& X_CW, DepthImage& image) const {
    for (const auto& [body, part] : parts_) {
      image.draw(part.shape->shape(), X_CW * X_WB[static_cast<std::size_t>(body)] * part.X);
    }
  }

  /// A random place in the box of a link that moves.
  Vector3d placeInLink(RandomInputs& random, const Poses& X_WB, int& body) const {
    do {
      const auto& [of, part] = parts_[random.integer(0, static_cast<int>(parts_.size()) - 1)];
      body = of;
      const Aabb box = computeAabb(part.shape->shape(), Isometry3d::Identity());
      const Vector3d at = box.min + random.vector(0, 1).cwiseProduct(box.max - box.min);
      if (body != 0) return X_WB[static_cast<std::size_t>(body)] * part.X * at;
    } while (true);
  }

  const RobotModel& robot() const { return *robot_; }

  std::vector<CloudConfig> configs;
  std::shared_ptr<const CollisionScene> scene, bare_scene;  ///< bare: without padding
  std::vector<RobotFilter> filters;                         ///< by camera

 private:
  std::shared_ptr<const RobotModel> robot_;
  SceneDescription description_;
  std::vector<std::pair<int, Part>> parts_;  ///< by body
  NarrowPhase narrow_phase_;
};

struct Seen {
  bool free;
  bool free_without = false;  ///< by the voxels of the last half second alone
  std::vector<bool> by;       ///< by camera: any of the obstacle
  std::vector<bool> place;    ///< by camera: some of it within the padding of where it will touch
  std::string why;
};

class Cameras {
 public:
  /// `compares`: whether Seen::free_without is wanted.
  Cameras(Setting& setting, RandomInputs& random, const Vector3d& looks_at, bool compares)
      : setting_(setting),
        detector_(setting.scene),
        bare_detector_(setting.bare_scene),
        is_ordered_(random.integer(0, 3) > 0),
        compares_(compares) {
    for (const CloudConfig& config : setting.configs) {
      one_.emplace_back(lookingAt(looks_at, random), config);
    }
  }

  /// `place`: where the obstacle touches, in its frame.
  Seen see(const Poses& X_WB, const Obstacle* obstacle, const Isometry3d& X_WO,
           const Vector3d& place, RandomInputs& random) {
    ++number_;
    Seen seen;
    std::map<std::string, CloudView> views;
    for (std::size_t i = 0; i < one_.size(); ++i) {
      const double nearest = take(i, X_WB, obstacle, X_WO, X_WO * place, random);
      seen.by.push_back(nearest < INF);
      seen.place.push_back(nearest < setting_.configs[i].padding());
      views[setting_.configs[i].name()] =
          viewOf(setting_.configs[i], one_[i].latest, one_[i].latest.stamp,
                 setting_.configs[i].topic);
    }
    BodyPoses poses = setting_.posesOf(setting_.scene->bodies(), X_WB);
    const auto doubts = addVoxels(views, *setting_.scene, poses);
    seen.free = detector_.detect(poses, CheckSettings()).verdict == Verdict::FREE && doubts.empty();
    for (const CloudDoubt& doubt : doubts) seen.why += doubt.why + "; ";
    if (!compares_) return seen;
    poses.voxels.clear();
    for (One& one : one_) poses.voxels.push_back(one.plain.end());
    seen.free_without = bare_detector_.detect(poses, CheckSettings()).verdict == Verdict::FREE;
    return seen;
  }

 private:
  struct One {
    One(const Isometry3d& X, const CloudConfig& config) : X_CW(X), gatherer(config) {}
    Isometry3d X_CW;
    CloudGatherer gatherer;
    VoxelGrid plain{plainSettings()};
    LatestCloud latest;
    Poses robot_drawn = {};
    DepthImage of_robot = DepthImage(WIDTH, HEIGHT, FOCAL_LENGTH);
  };

  static VoxelSettings plainSettings() {
    VoxelSettings settings;
    settings.decay = 0.5;
    return settings;
  }

  static Isometry3d lookingAt(const Vector3d& place, RandomInputs& random) {
    const Eigen::Matrix3d R = random.rotation().toRotationMatrix();
    Isometry3d X_WC = Isometry3d::Identity();
    X_WC.linear() = R;
    X_WC.translation() = place - random.uniform(0.7, 1.2) * R.col(2);
    return X_WC.inverse();
  }

  /// How near to the place the camera sees the obstacle; infinite: nowhere.
  double take(std::size_t i, const Poses& X_WB, const Obstacle* obstacle, const Isometry3d& X_WO,
              const Vector3d& place_W, RandomInputs& random) {
    One& one = one_[i];
    const auto isSame = [](const Isometry3d& a, const Isometry3d& b) {
      return a.matrix() == b.matrix();
    };
    if (!std::equal(X_WB.begin(), X_WB.end(), one.robot_drawn.begin(), one.robot_drawn.end(),
                    isSame)) {
      one.of_robot.clear();
      setting_.draw(X_WB, one.X_CW, one.of_robot);
      one.robot_drawn = X_WB;
    }
    DepthImage image = one.of_robot;
    if (obstacle) {
      for (const Part& part : obstacle->parts) {
        image.draw(part.shape->shape(), one.X_CW * X_WO * part.X);
      }
    }
    double nearest = INF;
    std::vector<Vector3d> points;
    std::normal_distribution<double> normal(0.0, NOISE);
    for (int v = 0; v < HEIGHT; ++v) {
      for (int u = 0; u < WIDTH; ++u) {
        const double depth = image.depth(u, v);
        if (!std::isfinite(depth)) continue;
        if (image.depth(u, v) < one.of_robot.depth(u, v)) {
          nearest = std::min(nearest, (depth * image.ray(u, v) - one.X_CW * place_W).norm());
        }
        const double noise = std::clamp(normal(random.engine()), -MOST_NOISE, MOST_NOISE);
        points.push_back(
            ((1.0 + noise / (depth * image.ray(u, v).norm())) * depth * image.ray(u, v)));
      }
    }
    if (!is_ordered_) std::shuffle(points.begin(), points.end(), random.engine());
    RobotFilter& filter = setting_.filters[i];
    const double stamp = PERIOD * number_;
    const BodyPoses robot = setting_.posesOf(filter.own.bodies(), X_WB);
    const auto voxels = one.gatherer.add(points, one.X_CW.inverse(), robot, stamp, filter);
    one.latest = {voxels, stamp, "", "", one.gatherer.vanished()};
    if (compares_) {
      one.plain.begin(stamp, one.X_CW.inverse().translation());
      for (const Vector3d& p_C : points) {
        const Vector3d p_W = one.X_CW.inverse() * p_C;
        if (!filter.own.isOwn(p_W)) one.plain.add(p_W);
      }
    }
    return nearest;
  }

  Setting& setting_;
  CollisionDetector detector_, bare_detector_;
  std::vector<One> one_;
  bool is_ordered_, compares_;
  int number_ = 0;
};

/// How the obstacle and the robot move.
enum class Motion { OBSTACLE, CARRIED, BASE };

struct Counts {
  int cases = 0, followed = 0, gone = 0;
  int held = 0, free_without = 0;  ///< clouds
};

class Case {
 public:
  Case(Setting& setting, RandomInputs& random, std::vector<double> positions, Motion motion,
       Obstacle obstacle)
      : setting_(setting),
        random_(random),
        positions_(std::move(positions)),
        motion_(motion),
        obstacle_(std::move(obstacle)) {
    swing_.resize(positions_.size());
    for (double& joint : swing_) joint = random_.uniform(-0.15, 0.15);
  }

  /// `step`: metres that the obstacle comes nearer from cloud to cloud.
  void run(double step, bool compares, Counts& counts) {
    if (!place()) return;
    ++counts.cases;
    Cameras cameras(setting_, random_, X_WO_.translation(), compares);
    const double from = step < 0.005 ? 0.06 + 20.0 * step : 0.3;
    std::string trace;
    std::vector<bool> is_followed(setting_.configs.size(), true),
        has_seen(is_followed.size(), false);
    int nb_apart = 0, nb_held = 0;
    bool was_touched = false, all_see_it_go = true;
    const auto show = [&](double gap) {
      const Poses X_WB = robotAt(gap);
      const Isometry3d X_WO = obstacleAt(gap, X_WB);
      const double distance = setting_.distance(X_WB, obstacle_, X_WO, 0.5);
      const Seen seen = cameras.see(X_WB, &obstacle_, X_WO, place_, random_);
      trace +=
          "\n  gap " + std::to_string(gap) + ", distance " + std::to_string(distance) + ", seen ";
      for (const bool by : seen.by) trace += by ? '1' : '0';
      trace += seen.free ? " FREE" : " not FREE " + seen.why;
      for (std::size_t i = 0; i < seen.by.size(); ++i) {
        if (!was_touched && distance < 0.2) is_followed[i] = is_followed[i] && seen.place[i];
        has_seen[i] = has_seen[i] || seen.by[i];
      }
      was_touched = was_touched || gap <= 0.0;
      const bool is_followed_by_one =
          std::any_of(is_followed.begin(), is_followed.end(), [](bool is) { return is; });
      if (gap <= 0.0 && is_followed_by_one) {
        ++nb_held;
        counts.free_without += seen.free_without ? 1 : 0;
        EXPECT_FALSE(seen.free) << "touches" << description(step) << trace;
      }
      if (was_touched && distance > 0.0 && distance < GONE) {
        for (std::size_t i = 0; i < seen.by.size(); ++i) {
          all_see_it_go = all_see_it_go && (seen.by[i] || !has_seen[i]);
        }
      }
      nb_apart = distance >= GONE ? nb_apart + 1 : 0;
      const bool is_gone = was_touched && all_see_it_go && nb_apart * PERIOD > 1.0;
      if (is_gone) {
        ++counts.gone;
        EXPECT_TRUE(seen.free) << "is gone" << description(step) << trace;
      }
      return !::testing::Test::HasFailure();
    };
    bool goes_on = true;
    for (int i = 0; i < 5 && goes_on; ++i) {
      const Seen seen = cameras.see(robotAt(from), nullptr, X_WO_, place_, random_);
      goes_on = seen.free;
      EXPECT_TRUE(seen.free) << "the robot alone" << description(step) << seen.why;
    }
    for (double gap = from; gap > PRESSED && goes_on; gap -= step) goes_on = show(gap);
    const int nb_clouds = random_.integer(5, 25);
    for (int i = 0; i < nb_clouds && goes_on; ++i) goes_on = show(PRESSED);
    for (double gap = PRESSED; gap < 0.4 && goes_on;
         gap += gap < 0.05 ? step : std::max(step, 0.02)) {
      goes_on = show(gap);
    }
    for (int i = 0; i < 17 && goes_on; ++i) goes_on = show(0.4);
    counts.held += nb_held;
    if (nb_held > 0) ++counts.followed;
  }

 private:
  static constexpr double PRESSED = -0.001;  // m: the gap while it is held

  /// Finds where the obstacle touches, from a random side.
  bool place() {
    X_WB_ = posesAt(0);
    const Vector3d target = setting_.placeInLink(random_, X_WB_, body_);
    X_WO_ = random_.pose(0.0);
    away_ = X_WO_.linear() *
            (random_.integer(0, 1) ? Vector3d::UnitZ() : Vector3d(random_.vector(-1, 1)));
    away_.normalize();
    X_WO_.linear() = random_.integer(0, 1) ? X_WO_.linear() : random_.rotation().toRotationMatrix();
    X_WO_.translation() = target + 0.8 * away_;
    for (int i = 0; i < 200; ++i) {
      const double gap = setting_.distance(X_WB_, obstacle_, X_WO_, 1.0, &place_);
      if (gap < 1e-5) {
        place_ = X_WO_.inverse() * place_;
        // Gone on a straight way, without another link beside it.
        const Isometry3d X_WO = moved(0.4 * away_) * X_WO_;
        return setting_.distance(X_WB_, obstacle_, X_WO, 0.5) > GONE + 0.02;
      }
      X_WO_.translation() -= gap * away_;
    }
    return false;
  }

  Poses posesAt(double phase) const {
    std::vector<double> positions = positions_;
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += swing_[i] * std::sin(phase);
    Poses X_WB;
    setting_.robot().forwardKinematics(positions, X_WB);
    return X_WB;
  }

  Poses robotAt(double gap) {
    if (motion_ == Motion::CARRIED) return posesAt(0.1 * nb_shown_++);
    if (motion_ == Motion::OBSTACLE) return X_WB_;
    Poses X_WB = X_WB_;  // the base comes
    for (Isometry3d& X : X_WB) X = moved(-gap * away_) * X;
    return X_WB;
  }

  Isometry3d obstacleAt(double gap, const Poses& X_WB) const {
    if (motion_ == Motion::BASE) return X_WO_;
    const auto body = static_cast<std::size_t>(body_);
    const Isometry3d X_of_link = X_WB[body] * X_WB_[body].inverse();
    return X_of_link * moved(gap * away_) * X_WO_;
  }

  std::string description(double step) const {
    const char* const names[] = {"the obstacle moves", "it moves with the link", "the base moves"};
    return ": " + obstacle_.name + ", " + names[static_cast<int>(motion_)] + ", " +
           std::to_string(1000.0 * step) + " mm a cloud, link " +
           setting_.robot()
               .links()[setting_.robot().bodies()[static_cast<std::size_t>(body_)].link]
               .name +
           "; ";
  }

  Setting& setting_;
  RandomInputs& random_;
  const std::vector<double> positions_;
  std::vector<double> swing_;
  const Motion motion_;
  const Obstacle obstacle_;
  Poses X_WB_;
  Isometry3d X_WO_ = Isometry3d::Identity();
  Vector3d away_ = Vector3d::UnitZ(), place_ = Vector3d::Zero();
  int body_ = 0;
  int nb_shown_ = 0;
};

void expectStaysSeen(const BenchmarkRobot& robot, int nb_cases) {
  RandomInputs random;
  Setting one(robot, 1), two(robot, 2);
  Counts counts;
  while (counts.cases < nb_cases && !::testing::Test::HasFailure()) {
    const auto& positions =
        robot.positions[random.integer(0, static_cast<int>(robot.positions.size()) - 1)];
    const auto motion = static_cast<Motion>(random.integer(0, 2));
    const double step = 0.001 * std::pow(50.0, random.uniform(0.0, 1.0));
    Setting& setting = random.integer(0, 1) ? two : one;
    Case(setting, random, positions, motion, randomObstacle(random)).run(step, false, counts);
  }
  std::cout << robot.name << ": " << counts.cases << " obstacles, " << counts.followed
            << " followed into contact, " << counts.gone << " clouds after they had gone\n";
  EXPECT_GT(counts.followed, nb_cases / 3);
  EXPECT_GT(counts.gone, 0);
}

TEST(WhatTouches, StaysSeenOnTheDemoRobot) { expectStaysSeen(demoRobot(), isLong() ? 2000 : 15); }

/// The table of docs/clouds.md: a box of 10 x 10 x 60 cm, and one camera.
TEST(WhatTouches, StaysSeenWhateverItsSizeAndSpeed) {
  BenchmarkRobot box;
  box.name = "box";
  box.robot = robotFrom(emptyLink("root") + linkWith("box", "<box size='0.1 0.1 0.6'/>") +
                        joint("turns", "revolute", "root", "box"));
  Setting setting(box, 1);
  RandomInputs random;
  const int nb_each = isLong() ? 10 : 1;
  const std::vector<std::pair<Kind, double>> all = {{BALL, 0.004}, {BALL, 0.008}, {BALL, 0.015},
                                                    {BALL, 0.03},  {BALL, 0.06},  {FINGERTIP, 0},
                                                    {SHEET, 0},    {BAR, 0},      {HAND, 0}};
  int nb_free_without = 0;
  for (const auto& [kind, size] : all) {
    Counts of_kind;
    std::string name;
    for (const double step : {0.001, 0.005, 0.02, 0.05}) {
      if (!isLong() && step < 0.005) continue;
      const int wanted = of_kind.followed + nb_each;
      for (int i = 0; i < 20 * nb_each && of_kind.followed < wanted; ++i) {
        if (::testing::Test::HasFailure()) return;
        const auto motion = static_cast<Motion>(random.integer(0, 2));
        const Obstacle obstacle = obstacleOf(kind, size, random);
        Case(setting, random, {0.0}, motion, obstacle).run(step, true, of_kind);
        name = obstacle.name;
      }
    }
    std::cout << "| " << name << " | " << of_kind.held << " | " << of_kind.free_without
              << " | 0 |\n";
    nb_free_without += of_kind.free_without;
  }
  EXPECT_GT(nb_free_without, 0);
}

TEST(WhatTouches, StaysSeenOnRealRobots) {
  if (benchmarkRobots().empty()) GTEST_SKIP() << "skipped: no COLLISION_PAIRS_SHARED";
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    if (robot.name != "ur5") expectStaysSeen(robot, isLong() ? 300 : 2);
  }
}

}  // namespace
}  // namespace collision_pairs
