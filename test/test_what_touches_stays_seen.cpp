// Obstacles come from everywhere, touch a link, are held there and go, before simulated depth
// cameras: from contact on the verdict is not FREE, and it is FREE once they are gone.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>

#include <gtest/gtest.h>

#include "benchmark/demo_motion.h"
#include "demo_scene.h"
#include "simulated_cameras.h"
#include "touched_robots.h"

namespace collision_pairs::test_what_touches_stays_seen {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double GONE = 0.30;  // m

bool isLong() { return std::getenv("COLLISION_PAIRS_LONG") != nullptr; }

/// How the obstacle and the robot move.
enum class Motion { OBSTACLE, CARRIED, BASE };

Motion randomMotion(RandomInputs& random) { return static_cast<Motion>(random.integer(0, 2)); }

struct Counts {
  int cases = 0, followed = 0, gone = 0;
  int held = 0, free = 0, free_without = 0;  ///< clouds
};

/// An obstacle comes, touches, is held and goes. The seed gives all but what the constructor takes.
class Case {
 public:
  Case(Setting& setting, unsigned seed, std::vector<double> positions, Motion motion,
       Obstacle obstacle, double step)
      : setting_(setting),
        seed_(seed),
        random_(seed),
        positions_(std::move(positions)),
        motion_(motion),
        obstacle_(std::move(obstacle)),
        step_(step),
        is_followed_(setting.configs.size(), true),
        has_seen_(setting.configs.size(), false) {
    swing_.resize(positions_.size());
    for (double& joint : swing_) joint = random_.uniform(-0.15, 0.15);
  }

  /// False if there is no way for it. `link`: the one to be touched; empty: any.
  bool findPlace(const std::string& link = "") {
    X_WB_ = posesAt(0);
    const Vector3d target = setting_.placeInLink(random_, X_WB_, link, body_);
    X_WO_ = random_.pose(0.0);
    away_ = X_WO_.linear() *
            (random_.integer(0, 1) ? Vector3d::UnitZ() : Vector3d(random_.vector(-1, 1)));
    away_.normalize();
    X_WO_.linear() = random_.integer(0, 1) ? X_WO_.linear() : random_.rotation().toRotationMatrix();
    X_WO_.translation() = target + 0.8 * away_;
    for (int i = 0; i < 200; ++i) {
      const double gap = setting_.distance(X_WB_, obstacle_, X_WO_, 1.0, &place_);
      if (gap < 1e-5) {
        place_W_ = place_;
        place_ = X_WO_.inverse() * place_;
        // Gone on a straight way, without another link beside it.
        const Isometry3d X_WO = moved(0.4 * away_) * X_WO_;
        if (setting_.distance(X_WB_, obstacle_, X_WO, 0.5) <= GONE + 0.02) return false;
        placeStill();
        return true;
      }
      X_WO_.translation() -= gap * away_;
    }
    return false;
  }

  /// `compares`: counts also what is free without the rules.
  void run(bool compares, Counts& counts) {
    ++counts.cases;
    counts_ = &counts;
    cameras_ = std::make_unique<Cameras>(setting_, random_, X_WO_.translation(), still_, compares);
    const double from = step_ < 0.005 ? 0.06 + 20.0 * step_ : 0.3;
    bool goes_on = true;
    for (int i = 0; i < 5 && goes_on; ++i) {
      const Seen seen =
          cameras_->see(robotAt(from, 0.1 * nb_shown_++), nullptr, X_WO_, place_, random_);
      goes_on = require(seen.free, "the robot alone is not FREE", seen.why);
    }
    for (double gap = from; gap > PRESSED && goes_on; gap -= step_) goes_on = show(gap);
    const int nb_clouds = random_.integer(5, 25);
    for (int i = 0; i < nb_clouds && goes_on; ++i) goes_on = show(PRESSED);
    for (double gap = PRESSED; gap < 0.4 && goes_on;
         gap += gap < 0.05 ? step_ : std::max(step_, 0.02)) {
      goes_on = show(gap);
    }
    for (int i = 0; i < 17 && goes_on; ++i) goes_on = show(0.4);
    if (nb_held_ > 0) ++counts.followed;
  }

  /// Where the obstacle touches, in W.
  const Vector3d& place() const { return place_W_; }
  /// A cloud that saw it come was a collision before it touched.
  bool wasCollision() const { return was_collision_; }
  std::string description() const {
    const char* const names[] = {"the obstacle moves", "it moves with the link", "the base moves"};
    const auto body = static_cast<std::size_t>(body_);
    return ": " + obstacle_.name +
           (still_.parts.empty() ? ", " : ", with something else in sight, ") +
           names[static_cast<int>(motion_)] + ", " + std::to_string(1000.0 * step_) +
           " mm a cloud, link " +
           setting_.robot().links()[setting_.robot().bodies()[body].link].name +
           " (COLLISION_PAIRS_CASE=" + std::to_string(seed_) + " repeats this case alone); ";
  }

 private:
  static constexpr double PRESSED = -0.001;  // m: the gap while it is held

  /// One cloud; false after a failure.
  bool show(double gap) {
    const Poses X_WB = robotAt(gap, 0.1 * nb_shown_++);
    const Isometry3d X_WO = obstacleAt(gap, X_WB);
    const double distance = setting_.distance(X_WB, obstacle_, X_WO, 0.5);
    const Seen seen = cameras_->see(X_WB, &obstacle_, X_WO, place_, random_);
    trace_ +=
        "\n  gap " + std::to_string(gap) + ", distance " + std::to_string(distance) + ", seen by ";
    for (const bool by : seen.by) trace_ += by ? '1' : '0';
    trace_ += seen.free ? ": FREE" : ": not FREE " + seen.why;
    for (std::size_t i = 0; i < seen.by.size(); ++i) {
      if (!was_touched_ && distance < 0.2) is_followed_[i] = is_followed_[i] && seen.place[i];
      has_seen_[i] = has_seen_[i] || seen.by[i];
    }
    if (!was_touched_ && distance > 0.0) was_collision_ = was_collision_ || seen.collides;
    was_touched_ = was_touched_ || distance <= 0.0;
    const bool is_followed = std::count(is_followed_.begin(), is_followed_.end(), true) > 0;
    if (distance <= 0.0 && is_followed) {
      ++nb_held_;
      ++counts_->held;
      counts_->free += seen.free ? 1 : 0;
      counts_->free_without += seen.free_without ? 1 : 0;
      require(!seen.free, "it touches and is FREE", trace_);
    }
    if (was_touched_ && distance > 0.0 && distance < GONE) {
      for (std::size_t i = 0; i < seen.by.size(); ++i) {
        all_see_it_go_ = all_see_it_go_ && !seen.in_part && (seen.by[i] || !has_seen_[i]);
      }
    }
    nb_apart_ = distance >= GONE ? nb_apart_ + 1 : 0;
    if (was_touched_ && all_see_it_go_ && nb_apart_ * PERIOD > 1.0) {
      ++counts_->gone;
      require(seen.free, "it is gone and not FREE", trace_);
    }
    return !has_failed_;
  }

  bool require(bool holds, const std::string& what, const std::string& why) {
    if (!holds) ADD_FAILURE() << what << description() << why;
    has_failed_ = has_failed_ || !holds;
    return holds;
  }

  /// In three of four cases something else that the cameras see, as near as it may be: within this
  /// distance it would be taken for a part of the obstacle, or be followed itself.
  void placeStill() {
    constexpr double APART = 0.14;
    RandomInputs random(seed_ + 2);
    for (int i = 0; i < 40 && random.integer(0, 3) > 0; ++i) {
      Obstacle still;
      still.parts = {partOf(Box{random.vector(0.03, 0.3)}, random.pose(0.0))};
      still.parts[0].X.translation() =
          place_W_ + random.uniform(0.15, 0.4) * random.rotation().toRotationMatrix().col(0);
      bool is_apart = true;
      for (int k = 0; k < 24 && is_apart; ++k) {
        const double phase = 0.27 * k, gap = k % 8 * 0.05;
        const Poses X_WB = robotAt(gap, phase);
        const Isometry3d X_WO = obstacleAt(gap, X_WB);
        is_apart = setting_.distance(X_WB, still, Isometry3d::Identity(), APART) >= APART &&
                   distance(obstacle_, X_WO, still, APART) >= APART;
      }
      if (!is_apart) continue;
      still_ = still;
      return;
    }
  }

  Poses posesAt(double phase) const {
    std::vector<double> positions = positions_;
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += swing_[i] * std::sin(phase);
    Poses X_WB;
    setting_.robot().forwardKinematics(positions, X_WB);
    return X_WB;
  }

  Poses robotAt(double gap, double phase) const {
    if (motion_ == Motion::CARRIED) return posesAt(phase);
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

  Setting& setting_;
  const unsigned seed_;
  RandomInputs random_;
  const std::vector<double> positions_;
  const Motion motion_;
  const Obstacle obstacle_;
  Obstacle still_;     ///< in W
  const double step_;  ///< metres that the obstacle comes nearer from cloud to cloud
  std::vector<double> swing_;
  Poses X_WB_;
  Isometry3d X_WO_ = Isometry3d::Identity();
  Vector3d away_ = Vector3d::UnitZ(), place_ = Vector3d::Zero(), place_W_ = place_;
  int body_ = 0, nb_shown_ = 0;

  std::unique_ptr<Cameras> cameras_;
  Counts* counts_ = nullptr;
  std::vector<bool> is_followed_, has_seen_;  ///< by camera: until it touches, ever
  std::string trace_;
  int nb_apart_ = 0, nb_held_ = 0;
  bool was_touched_ = false, was_collision_ = false, all_see_it_go_ = true, has_failed_ = false;
};

/// The seed of the next case; false: another one is to be repeated alone.
bool takesCase(RandomInputs& random, unsigned& seed) {
  seed = static_cast<unsigned>(random.engine()());
  const char* only = std::getenv("COLLISION_PAIRS_CASE");
  return !only || seed == std::strtoul(only, nullptr, 10);
}

void expectStaysSeen(const BenchmarkRobot& robot, int nb_cases) {
  RandomInputs random;
  Setting one(robot, 1), two(robot, 2);
  Counts counts;
  for (int i = 0; i < 3 * nb_cases && counts.cases < nb_cases; ++i) {
    unsigned seed;
    if (!takesCase(random, seed)) continue;
    RandomInputs of_case(seed + 1);
    const int state = of_case.integer(0, static_cast<int>(robot.positions.size()) - 1);
    const double step = 0.001 * std::pow(50.0, of_case.uniform(0.0, 1.0));
    Setting& setting = of_case.integer(0, 1) ? two : one;
    Case one_case(setting, seed, robot.positions[static_cast<std::size_t>(state)],
                  randomMotion(of_case), randomObstacle(of_case), step);
    if (one_case.findPlace()) one_case.run(false, counts);
  }
  std::cout << robot.name << ": " << counts.cases << " obstacles, " << counts.followed
            << " followed into contact, " << counts.gone << " clouds after they had gone\n";
  if (std::getenv("COLLISION_PAIRS_CASE")) return;
  EXPECT_GT(counts.followed, nb_cases < 100 ? nb_cases / 10 : nb_cases / 3);
  EXPECT_TRUE(counts.gone > 0 || nb_cases < 10);
}

TEST(WhatTouches, StaysSeenOnTheDemoRobot) { expectStaysSeen(demoRobot(), isLong() ? 1000 : 15); }

constexpr double HALF_WIDTH = 0.05, HALF_LENGTH = 0.3;  // m, of the box

const char* placeOnBox(const Vector3d& p) {
  const Eigen::Array3d inside =
      Eigen::Array3d(HALF_WIDTH, HALF_WIDTH, HALF_LENGTH) - p.array().abs();
  const auto nb_near = (inside < 0.01).count();
  return nb_near > 2 ? "corner" : nb_near == 2 ? "edge" : "face";
}

/// scripts/measure_touching makes docs/data/touching.csv and the table of docs/clouds.md of the
/// lines of the long run: a box of 10 x 10 x 60 cm, and one camera.
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
  std::map<std::string, Counts> found;  // by obstacle, speed and place
  int nb_free_without = 0;
  for (const auto& [kind, size] : all) {
    for (const double step : {0.001, 0.005, 0.02, 0.05}) {
      if (!isLong() && step < 0.005) continue;
      Counts of_kind;
      RandomInputs of_row(static_cast<unsigned>(random.engine()()));
      for (int i = 0; i < 20 * nb_each && of_kind.followed < nb_each; ++i) {
        unsigned seed;
        if (!takesCase(of_row, seed)) continue;
        RandomInputs of_case(seed + 1);
        const Motion motion = randomMotion(of_case);
        const Obstacle obstacle = obstacleOf(kind, size, of_case);
        Case one(setting, seed, {0.0}, motion, obstacle, step);
        if (!one.findPlace()) continue;
        Counts counts;
        one.run(true, counts);
        of_kind.followed += counts.followed;
        Counts& row = found[obstacle.name + ',' + std::to_string(std::lround(1000.0 * step)) + ',' +
                            placeOnBox(one.place())];
        row.held += counts.held;
        row.free += counts.free;
        row.free_without += counts.free_without;
        nb_free_without += counts.free_without;
      }
    }
  }
  for (const auto& [key, row] : found) {
    if (row.held == 0) continue;
    std::cout << key << ',' << row.held << ',' << row.free_without << ',' << row.free << '\n';
  }
  EXPECT_GT(nb_free_without, 0);
}

TEST(WhatTouches, StaysSeenOnRealRobots) {
  if (benchmarkRobots().empty()) GTEST_SKIP() << "skipped: no COLLISION_PAIRS_SHARED";
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    if (robot.name != "ur5") expectStaysSeen(robot, isLong() ? 150 : 2);
  }
}

/// Where voxel and padding of the self filter are both 2 cm, the voxel of a kept point may end
/// before the link, and a step later all its points are the robot's.
TEST(WhatTouches, AFingertipThatComesSlowlyIsACollisionBeforeItTouches) {
  if (benchmarkRobots().empty()) GTEST_SKIP() << "skipped: no COLLISION_PAIRS_SHARED";
  const auto& robots = benchmarkRobots();
  const auto panda = std::find_if(robots.begin(), robots.end(),
                                  [](const auto& robot) { return robot.name == "panda"; });
  Setting setting(*panda, 1);
  RandomInputs random;
  Counts counts;
  const int nb_wanted = isLong() ? 40 : 2;
  for (int i = 0; i < 20 * nb_wanted && counts.followed < nb_wanted; ++i) {
    unsigned seed;
    if (!takesCase(random, seed)) continue;
    Case one(setting, seed, panda->positions[0], Motion::OBSTACLE, obstacleOf(FINGERTIP, 0, random),
             0.001);
    if (!one.findPlace("panda_link3")) continue;
    const int followed_before = counts.followed;
    one.run(false, counts);
    const bool was_followed = counts.followed > followed_before;
    EXPECT_TRUE(one.wasCollision() || !was_followed) << one.description();
  }
  EXPECT_EQ(counts.followed, nb_wanted);
}

}  // namespace collision_pairs::test_what_touches_stays_seen
