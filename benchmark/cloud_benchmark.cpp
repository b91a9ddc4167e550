// Clouds of points: from 640 x 480 points to voxels, and checks against voxels beside FCL's OcTree
// of the same voxels, in turns. Lines robot,case,quantity,value; scripts/measure_clouds makes
// tables of them.
//
//   COLLISION_PAIRS_SHARED=DATA cloud_benchmark [STATES [ROBOT [followed|clouds|checks|growth]]]
#include <algorithm>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <string>

#include <fcl/geometry/octree/octree.h>
#include <octomap/octomap.h>
#include <time.h>

#include "benchmark_robots.h"
#include "cloud_processor.h"
#include "cloud_scenes.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/self_filter.h"
#include "collision_pairs/voxel_grid.h"
#include "demo_motion.h"
#include "moveit_loop.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Voxels = std::shared_ptr<const OccupiedVoxels>;

constexpr double PADDING = 0.02;           // metres, of the self filter
constexpr double CLOUD_VOXEL_SIZE = 0.01;  // metres, of the camera's cloud
constexpr double CHECK_VOXEL_SIZE = 0.02;  // metres
// More than the diagonal of a voxel, so that no voxel of a point that is kept reaches the robot.
constexpr double CHECK_PADDING = 0.04;  // metres
constexpr std::uint32_t NB_VOXELS = 100'000;
constexpr double ALARM_DISTANCE = 0.05;  // metres
constexpr int PASSES = 5;
constexpr std::size_t NB_FOLLOWED = 8;  // clouds

/// Of this thread: what other programs do meanwhile is not counted.
double microseconds(const std::function<void()>& work) {
  const auto now = [] {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e6 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * values.size()))];
}

void print(const std::string& robot, const char* what, const char* quantity, double value) {
  std::printf("%s,%s,%s,%.6g\n", robot.c_str(), what, quantity, value);
}

/// Metres by which the robot is raised so that it stands on the floor.
double heightOf(const BenchmarkRobot& robot) { return robot.name == "panda" ? 0.7 : 0.0; }

std::vector<Isometry3d> raised(const std::vector<Isometry3d>& X_RB, double height) {
  std::vector<Isometry3d> X_WB = X_RB;
  for (Isometry3d& X : X_WB) X.translation().z() += height;
  return X_WB;
}

BodyPoses posesFor(const std::vector<SceneBody>& bodies, const std::vector<Isometry3d>& X_WB) {
  BodyPoses poses;
  poses.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) poses.X_WB[i] = X_WB[bodies[i].body];
  return poses;
}

/// The links that stand on the floor or next to it.
std::vector<std::string> linksOnFloor(const BenchmarkRobot& robot) {
  std::vector<std::string> links;
  for (const Link& link : robot.robot->links()) {
    const bool is_on_floor = link.name == "base_link" || link.name == "panda_link0" ||
                             link.name.find("caster") != std::string::npos;
    if (is_on_floor) links.push_back(link.name);
  }
  return links;
}

SceneDescription described(const BenchmarkRobot& robot, bool check_self, bool with_cloud,
                           std::vector<std::string> touch_links = {}) {
  SceneDescription description;
  description.robots.push_back({robot.robot, robot.srdf, ""});
  description.check_self = check_self;
  if (with_cloud)
    description.clouds.push_back(cloudOf("cloud", CHECK_VOXEL_SIZE, std::move(touch_links)));
  return description;
}

void measureClouds(const BenchmarkRobot& robot, const Room& room, std::size_t nb_states) {
  SelfFilter filter(described(robot, true, false), PADDING);
  VoxelSettings settings;
  settings.voxel_size = CLOUD_VOXEL_SIZE;
  VoxelGrid grid(settings);
  std::vector<double> whole, first, own_share, nb_voxels, filtering, gathering;
  for (std::size_t i = 0; i < nb_states; ++i) {
    const auto X_WB = raised(robot.states[i * robot.states.size() / nb_states], heightOf(robot));
    const Vector3d camera(1.9, 0.7, 1.6);
    const Points points = room.seenFrom(camera, {0.0, 0.0, 0.8}, *robot.robot, X_WB);
    const BodyPoses poses = posesFor(filter.bodies(), X_WB);
    Voxels voxels;
    std::size_t nb_own = 0;
    const auto gather = [&] {
      nb_own = 0;
      filter.begin(poses);
      grid.begin(0.0, camera);
      for (const Vector3d& p : points) {
        if (filter.isOwn(p)) {
          ++nb_own;
        } else {
          grid.add(p);
        }
      }
      voxels = grid.end();
    };
    first.push_back(microseconds(gather));
    double least = std::numeric_limits<double>::infinity(), filter_only = least, grid_only = least;
    for (int pass = 0; pass < PASSES; ++pass) {
      least = std::min(least, microseconds(gather));
      filter_only = std::min(filter_only, microseconds([&] {
                               filter.begin(poses);
                               std::size_t nb = 0;
                               for (const Vector3d& p : points) nb += filter.isOwn(p) ? 1 : 0;
                               if (nb != nb_own) std::abort();
                             }));
      grid_only = std::min(grid_only, microseconds([&] {
                             grid.begin(0.0, camera);
                             for (const Vector3d& p : points) grid.add(p);
                             grid.end();
                           }));
    }
    whole.push_back(least);
    filtering.push_back(filter_only);
    gathering.push_back(grid_only);
    own_share.push_back(static_cast<double>(nb_own) / static_cast<double>(points.size()));
    nb_voxels.push_back(static_cast<double>(voxels->size()));
  }
  print(robot.name, "cloud", "ms", 1e-3 * quantile(whole, 0.5));
  print(robot.name, "cloud", "ms_most", 1e-3 * quantile(whole, 1.0));
  print(robot.name, "cloud", "ms_first_seen", 1e-3 * quantile(first, 0.5));
  print(robot.name, "cloud", "ms_filter_alone", 1e-3 * quantile(filtering, 0.5));
  print(robot.name, "cloud", "ms_grid_alone", 1e-3 * quantile(gathering, 0.5));
  print(robot.name, "cloud", "own_share", quantile(own_share, 0.5));
  print(robot.name, "cloud", "voxels", quantile(nb_voxels, 0.5));
}

/// Clouds of a robot in motion, 15 a second, with what is followed from one to the next.
void measureFollowing(const BenchmarkRobot& robot, const Room& room) {
  const Vector3d camera(1.9, 0.7, 1.6);
  Isometry3d X_WS = Isometry3d::Identity();
  X_WS.translation() = camera;
  std::vector<std::vector<Isometry3d>> X_WB(NB_FOLLOWED);
  std::vector<Points> clouds(NB_FOLLOWED);
  for (std::size_t i = 0; i < NB_FOLLOWED; ++i) {
    std::vector<double> positions = robot.positions[robot.positions.size() / 3];
    for (double& joint : positions) joint += 0.02 * static_cast<double>(i);  // 0.3 rad/s
    robot.robot->forwardKinematics(positions, X_WB[i]);
    X_WB[i] = raised(X_WB[i], heightOf(robot));
    for (const Vector3d& p_W :
         room.seenFrom(camera, {0.0, 0.0, 0.8}, *robot.robot, X_WB[i], static_cast<unsigned>(i))) {
      if (p_W.allFinite()) clouds[i].push_back(p_W - camera);
    }
  }
  for (const double voxel_size : {0.01, 0.02}) {
    CloudConfig config;
    config.topic = "camera";
    config.voxel_size = voxel_size;
    SceneDescription description = described(robot, false, false);
    description.clouds.push_back(obstacleOf(config));
    const auto scene = CollisionScene::build(description);
    std::vector<double> whole(NB_FOLLOWED, std::numeric_limits<double>::infinity());
    std::vector<double> plain = whole;
    RobotFilter filter(description, *scene, config);
    for (int pass = 0; pass < PASSES; ++pass) {
      CloudProcessor processor(config);
      VoxelGrid grid(VoxelSettings{voxel_size, 1, config.decay});
      Points kept;
      for (std::size_t i = 0; i < NB_FOLLOWED; ++i) {
        const double stamp = static_cast<double>(i) / 15.0;
        const BodyPoses poses = posesFor(filter.own.bodies(), X_WB[i]);
        whole[i] = std::min(
            whole[i], microseconds([&] { processor.add(clouds[i], X_WS, poses, stamp, filter); }));
        plain[i] = std::min(plain[i], microseconds([&] {
                              filter.own.begin(poses);
                              grid.begin(stamp, camera);
                              kept.clear();
                              for (const Vector3d& p_S : clouds[i]) {
                                if (p_S.norm() > config.max_range) continue;
                                const Vector3d p_W = X_WS * p_S;
                                if (filter.own.isOwn(p_W)) continue;
                                grid.add(p_W);
                                kept.push_back(p_S);
                              }
                              grid.end();
                            }));
      }
    }
    const std::string name = "followed " + std::to_string(std::lround(100.0 * voxel_size)) + " cm";
    print(robot.name, name.c_str(), "ms", 1e-3 * quantile(whole, 0.5));
    print(robot.name, name.c_str(), "ms_most", 1e-3 * quantile(whole, 1.0));
    print(robot.name, name.c_str(), "ms_without", 1e-3 * quantile(plain, 0.5));
  }
}

/// Voxels of the room about the robot, without what its self filter takes, nearest first.
Voxels voxelsAbout(const Points& points, SelfFilter& filter, const std::vector<Isometry3d>& X_WB,
                   std::uint32_t nb_voxels) {
  VoxelSettings settings;
  settings.voxel_size = CHECK_VOXEL_SIZE;
  settings.max_voxels = nb_voxels;
  VoxelGrid grid(settings);
  filter.begin(posesFor(filter.bodies(), X_WB));
  grid.begin(0.0, {0.0, 0.0, 0.5});
  for (const Vector3d& p : points) {
    if (!filter.isOwn(p)) grid.add(p);
  }
  std::vector<VoxelCell> cells;
  grid.end()->forEach([&](const VoxelCell& cell) { cells.push_back(cell); });
  return std::make_shared<const OccupiedVoxels>(CHECK_VOXEL_SIZE, cells);
}

std::shared_ptr<fcl::CollisionGeometryd> asOcTree(const OccupiedVoxels& voxels) {
  auto tree = std::make_shared<octomap::OcTree>(CHECK_VOXEL_SIZE);
  voxels.forEach([&](const VoxelCell& cell) {
    const Vector3d p = CHECK_VOXEL_SIZE * (cell.cast<double>() + Vector3d::Constant(0.5));
    tree->updateNode(octomap::point3d(static_cast<float>(p[0]), static_cast<float>(p[1]),
                                      static_cast<float>(p[2])),
                     true, true);
  });
  tree->updateInnerOccupancy();
  auto geometry = std::make_shared<fcl::OcTreed>(tree);
  geometry->computeLocalAABB();
  return geometry;
}

class Cases {
 public:
  void add(const char* name, std::function<void()> work) {
    cases_.push_back({name, std::move(work)});
  }

  /// The least of PASSES, in turns, each time after a run that is not counted.
  void measure() {
    for (Case& one : cases_) one.least = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < PASSES; ++pass) {
      for (Case& one : cases_) {
        one.work();  // finds its memory cold
        one.least = std::min(one.least, microseconds(one.work));
      }
    }
  }

  template <class Take>
  void forEach(const Take& take) const {
    for (const Case& one : cases_) take(one.name, one.least);
  }

 private:
  struct Case {
    const char* name;
    std::function<void()> work;
    double least = 0.0;
  };
  std::vector<Case> cases_;
};

void measureChecks(const BenchmarkRobot& robot, const Room& room, std::size_t nb_states) {
  const Points points = room.points(0.5 * CHECK_VOXEL_SIZE);
  SelfFilter filter(described(robot, true, false), CHECK_PADDING);
  CollisionDetector cloud_alone(CollisionScene::build(described(robot, false, true)));
  SceneDescription with_padding = described(robot, false, true);
  with_padding.clouds[0].padding = CHECK_PADDING;  // as by default: self filter and a voxel
  CollisionDetector padded(CollisionScene::build(with_padding));
  CollisionDetector whole(CollisionScene::build(described(robot, true, true)));
  CollisionDetector off_floor(
      CollisionScene::build(described(robot, false, true, linksOnFloor(robot))));
  std::map<std::string, std::vector<double>> times;
  double nb_near = 0.0, nb_contacts = 0.0, sum = 0.0, furthest = 0.0;
  for (std::size_t i = 0; i < nb_states; ++i) {
    const auto X_WB = raised(robot.states[i * robot.states.size() / nb_states], heightOf(robot));
    const Voxels voxels = voxelsAbout(points, filter, X_WB, NB_VOXELS);
    const MoveItLoop fcl(robot, asOcTree(*voxels));
    BodyPoses alone = posesFor(cloud_alone.scene().bodies(), X_WB);
    BodyPoses both = posesFor(whole.scene().bodies(), X_WB);
    BodyPoses lifted = posesFor(off_floor.scene().bodies(), X_WB);
    alone.voxels = both.voxels = lifted.voxels = {voxels};
    CheckSettings report, verdict, distance;
    report.alarm_distance = ALARM_DISTANCE;
    verdict.verdict_only = true;
    distance.alarm_distance = 0.0;
    distance.min_distance = true;
    Cases cases;
    cases.add("cloud alarm 0.05", [&] { cloud_alone.detect(alone, report); });
    cases.add("cloud padded alarm 0.05", [&] { padded.detect(alone, report); });
    cases.add("cloud verdict", [&] { cloud_alone.detect(alone, verdict); });
    cases.add("cloud distance", [&] { cloud_alone.detect(alone, distance); });
    cases.add("cloud and self alarm 0.05", [&] { whole.detect(both, report); });
    cases.add("cloud but for links on the floor alarm 0.05",
              [&] { off_floor.detect(lifted, report); });
    cases.add("fcl collide", [&] { sum += fcl.worldCollides(X_WB); });
    cases.add("fcl distance", [&] { sum += fcl.worldDistance(X_WB); });
    cases.measure();
    cases.forEach([&](const char* name, double us) { times[name].push_back(us); });
    const CollisionReport& found = cloud_alone.detect(alone, report);
    nb_near += static_cast<double>(found.pairs.size()) / nb_states;
    nb_contacts += (found.verdict == Verdict::COLLISION ? 1.0 : 0.0) / nb_states;
    const bool same = (found.verdict == Verdict::COLLISION) == fcl.worldCollides(X_WB);
    if (!same) std::fprintf(stderr, "%s: state %zu: FCL says otherwise\n", robot.name.c_str(), i);
    const CollisionReport& nearest = cloud_alone.detect(alone, distance);
    if (nearest.min_distance > 0.0) {
      furthest = std::max(furthest, std::abs(nearest.min_distance - fcl.worldDistance(X_WB)));
    }
  }
  for (const auto& [name, all] : times) {
    print(robot.name, name.c_str(), "us", quantile(all, 0.5));
    print(robot.name, name.c_str(), "us_p99", quantile(all, 0.99));
  }
  print(robot.name, "check", "pairs_in_reach", nb_near);
  print(robot.name, "check", "share_in_collision", nb_contacts);
  print(robot.name, "check", "fcl_distance_differs_by", furthest);
  std::fprintf(stderr, "%g\n", sum);
}

/// The nearest 10,000 voxels, and more of them out of reach.
void measureGrowth(const BenchmarkRobot& robot, const Room& room, std::size_t nb_states) {
  const Points points = room.points(0.5 * CHECK_VOXEL_SIZE);
  SelfFilter filter(described(robot, true, false), CHECK_PADDING);
  CollisionDetector detector(CollisionScene::build(described(robot, false, true)));
  std::map<std::size_t, std::vector<double>> times;
  for (std::size_t i = 0; i < nb_states; ++i) {
    const auto X_WB = raised(robot.states[i * robot.states.size() / nb_states], heightOf(robot));
    const Voxels near = voxelsAbout(points, filter, X_WB, 10'000);
    std::vector<BodyPoses> poses;
    std::vector<VoxelCell> cells;
    near->forEach([&](const VoxelCell& cell) { cells.push_back(cell); });
    const std::size_t nb_near = cells.size();
    for (const std::size_t nb_wanted :
         {std::size_t{10'000}, std::size_t{100'000}, std::size_t{1'000'000}}) {
      for (int k = static_cast<int>(cells.size() - nb_near); cells.size() < nb_wanted; ++k) {
        cells.emplace_back(200 + k / 40'000, k % 200 - 100, k / 200 % 200 - 100);  // x from 4 m on
      }
      poses.push_back(posesFor(detector.scene().bodies(), X_WB));
      poses.back().voxels = {std::make_shared<const OccupiedVoxels>(CHECK_VOXEL_SIZE, cells)};
    }
    CheckSettings settings;
    settings.alarm_distance = ALARM_DISTANCE;
    std::vector<double> least(poses.size(), std::numeric_limits<double>::infinity());
    for (int pass = 0; pass < 4 * PASSES; ++pass) {
      for (std::size_t k = 0; k < poses.size(); ++k) {
        least[k] = std::min(least[k], microseconds([&] { detector.detect(poses[k], settings); }));
      }
    }
    for (std::size_t k = 0; k < poses.size(); ++k)
      times[poses[k].voxels[0]->size()].push_back(least[k]);
  }
  for (const auto& [nb_voxels, all] : times) {
    print(robot.name, ("growth " + std::to_string(nb_voxels)).c_str(), "us", quantile(all, 0.5));
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  const std::size_t nb_states = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 30;
  const Room room(25);
  const std::string only = argc > 3 ? argv[3] : "";
  std::printf("robot,case,quantity,value\n");
  if (argc <= 2 || argv[2] == std::string("demo")) measureFollowing(demoRobot(), room);
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    if (robot.name != "panda" && robot.name != "pr2") continue;
    if (argc > 2 && robot.name != argv[2]) continue;
    if (only.empty() || only == "followed") measureFollowing(robot, room);
    if (only.empty() || only == "clouds") {
      measureClouds(robot, room, std::min<std::size_t>(nb_states, 6));
    }
    if (only.empty() || only == "checks") measureChecks(robot, room, nb_states);
    if (only.empty() || only == "growth") measureGrowth(robot, room, nb_states);
  }
}
