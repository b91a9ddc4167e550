// What a scene costs that models more or less of the robot, and of a world that stands still.
//
//   COLLISION_PAIRS_SHARED=DATA scene_cost table CYCLES.csv UPDATES.csv
//   COLLISION_PAIRS_SHARED=DATA scene_cost cycles COUNT      cycles of pr2 beside so many far
//   boxes,
//                                                            for a profiler
//
// A state's time is the least of its repetitions, forward kinematics not counted; the scenes take
// turns, so that what else the machine does meets all of them.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>

#include "collision_pairs/collision_detector.h"
#include "scene_cases.h"

namespace collision_pairs {
namespace {

constexpr int PASSES = 11, UPDATES = 9;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// µs of each stage, by state.
struct Times {
  std::vector<double> boxes, sweep, narrow, total;

  explicit Times(std::size_t nb_states) {
    for (auto* stage : {&boxes, &sweep, &narrow, &total}) {
      stage->assign(nb_states, std::numeric_limits<double>::infinity());
    }
  }
  void note(std::size_t state, const StageTimes& took) {
    boxes[state] = std::min(boxes[state], 1e6 * took.boxes);
    sweep[state] = std::min(sweep[state], 1e6 * took.broad_phase);
    narrow[state] = std::min(narrow[state], 1e6 * took.narrow_phase);
    total[state] = std::min(total[state], 1e6 * took.total);
  }
};

/// One scene with all that its cycles need.
class Runner {
 public:
  Runner(BuiltCase built, const BenchmarkRobot& robot)
      : built_(std::move(built)), detector_(built_.scene), times_(robot.states.size()) {
    settings_.stage_times = true;
    for (const auto& X_RB : robot.states) {
      poses_.emplace_back();
      built_.scene->gatherPoses(X_RB, poses_.back());
    }
  }

  void pass() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      times_.note(i, detector_.detect(poses_[i], settings_).times);
    }
  }

  void write(std::ostream& out) const {
    const CollisionScene& scene = *built_.scene;
    const auto nb_links = std::count_if(scene.models().begin(), scene.models().end(),
                                        [](const CollisionModel& m) { return m.body >= 0; });
    out << built_.what.robot << ',' << (built_.what.srdf ? "SRDF" : "adjacent links") << ','
        << built_.what.world << ',' << built_.what.nb_boxes << ',' << nb_links << ','
        << scene.bodies().size() << ',' << nbAllowedPairs() << ',' << built_.nb_meshes << ','
        << built_.nb_triangles << ',' << built_.heap_bytes << ',' << median(times_.boxes) << ','
        << median(times_.sweep) << ',' << median(times_.narrow) << ',' << median(times_.total)
        << std::endl;
  }

 private:
  std::uint64_t nbAllowedPairs() const {
    const PairFilter& filter = built_.scene->filter();
    std::vector<std::uint64_t> members(filter.nbClasses(), 0);
    for (std::uint32_t m = 0; m < filter.nbModels(); ++m) ++members[filter.classOf(m)];
    std::uint64_t pairs = 0;
    for (std::uint32_t a = 0; a < members.size(); ++a) {
      for (std::uint32_t b = a + 1; b < members.size(); ++b) {
        if (filter.classPairAllowed(a, b)) pairs += members[a] * members[b];
      }
    }
    return pairs;
  }

  BuiltCase built_;
  CollisionDetector detector_;
  CheckSettings settings_;
  std::vector<BodyPoses> poses_;
  Times times_;
};

std::vector<SceneCase> allCases() {
  std::vector<SceneCase> cases;
  for (const bool srdf : {false, true}) {
    cases.push_back({"whole", "none", srdf, "", false, 0});
    cases.push_back({"arms", "none", srdf, "arms", false, 0});
    cases.push_back({"right arm", "none", srdf, "right_arm", false, 0});
    cases.push_back({"arms alone", "none", srdf, "arms", true, 0});
  }
  for (const std::string world : {"far", "near"}) {
    for (const std::size_t count : {10u, 1000u, 100000u}) {
      cases.push_back({"whole", world, true, "", false, count});
    }
  }
  return cases;
}

void writeCycles(const BenchmarkRobot& robot, std::ostream& out) {
  const auto near = nearBoxes(robot, 100000), far = farBoxes(100000);
  std::vector<Runner> runners;
  for (const SceneCase& what : allCases()) {
    const auto& boxes = what.world == "near" ? near : far;
    const auto end = boxes.begin() + static_cast<std::ptrdiff_t>(what.nb_boxes);
    runners.emplace_back(buildCase(robot, what, {boxes.begin(), end}), robot);
  }
  for (int pass = 0; pass < PASSES; ++pass) {
    for (Runner& runner : runners) runner.pass();
  }
  out << "robot,switched_off,world,nb_boxes,nb_links,nb_bodies,nb_allowed_pairs,nb_meshes,"
         "nb_triangles,heap_bytes,boxes_us,sweep_us,narrow_us,total_us\n";
  for (const Runner& runner : runners) runner.write(out);
}

double millisecondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// Milliseconds.
struct UpdateTimes {
  std::vector<double> build, first_cycle, free;
};

/// Builds the scene with what earlier ones prepared, checks it once and gives it back.
void rebuild(const SceneDescription& description, const std::vector<Eigen::Isometry3d>& X_RB,
             SceneCache& cache, UpdateTimes& times) {
  std::shared_ptr<const CollisionScene> scene;
  times.build.push_back(
      millisecondsOf([&] { scene = CollisionScene::build(description, &cache); }));
  BodyPoses poses;
  scene->gatherPoses(X_RB, poses);
  auto detector = std::make_unique<CollisionDetector>(std::move(scene));
  times.first_cycle.push_back(millisecondsOf([&] { detector->detect(poses, CheckSettings()); }));
  times.free.push_back(millisecondsOf([&] { detector.reset(); }));
}

/// One box more and one less, by turns.
void writeUpdates(const BenchmarkRobot& robot, std::ostream& out) {
  out << "nb_objects,build_ms,first_cycle_ms,free_ms\n";
  for (const std::size_t count : {10u, 1000u, 100000u}) {
    SceneCache cache;
    SceneDescription description = describe(robot, farBoxes(count + 1));
    CollisionScene::build(description, &cache);
    UpdateTimes times;
    for (int i = 0; i < UPDATES; ++i) {
      const RigidObject last = description.objects.back();
      description.objects.pop_back();
      rebuild(description, robot.states[static_cast<std::size_t>(i)], cache, times);
      description.objects.push_back(last);
      rebuild(description, robot.states[static_cast<std::size_t>(i)], cache, times);
    }
    out << count << ',' << median(times.build) << ',' << median(times.first_cycle) << ','
        << median(times.free) << std::endl;
  }
}

/// Microseconds of changes of a scene, the release of the one before included.
void printChanges(const BenchmarkRobot& robot) {
  std::cout << "nb_objects,add_us,remove_us,move_us,attach_us\n";
  for (const std::size_t count : {20u, 1000u, 100000u}) {
    SceneCache cache;
    std::vector<RigidObject> boxes = farBoxes(count + UPDATES);
    const std::vector<RigidObject> more(boxes.end() - UPDATES, boxes.end());
    boxes.resize(count);
    auto scene = CollisionScene::build(describe(robot, boxes), &cache);
    const auto medianOf = [&](const auto& changes_of) {
      std::vector<double> times;
      for (int i = 0; i < UPDATES; ++i) {
        const SceneChanges changes = changes_of(static_cast<std::size_t>(i));
        times.push_back(1e3 * millisecondsOf([&] { scene = scene->with(changes, &cache); }));
      }
      return median(times);
    };
    std::cout << count << ','
              << medianOf([&](std::size_t i) { return SceneChanges{{more[i]}, {}}; }) << ','
              << medianOf([&](std::size_t i) { return SceneChanges{{}, {more[i].name}}; }) << ','
              << medianOf([&](std::size_t i) {
                   RigidObject moved = boxes[i];
                   moved.X_PO.translation().x() += 1.0;
                   return SceneChanges{{moved}, {}};
                 })
              << ',' << medianOf([&](std::size_t i) {
                   RigidObject attached = boxes[i];
                   attached.attached_link = robot.robot->links().back().name;
                   return SceneChanges{{attached}, {}};
                 })
              << std::endl;
  }
}

int runCycles(const BenchmarkRobot& robot, std::size_t count) {
  Runner runner(buildCase(robot, {"whole", "far", true, "", false, count}, farBoxes(count)), robot);
  runner.pass();
  return 0;
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  const std::string mode = argc > 1 ? argv[1] : "";
  const bool is_known = (mode == "table" && argc == 4) || (mode == "cycles" && argc == 3) ||
                        (mode == "changes" && argc == 2);
  if (!is_known) {
    std::cerr << "usage: scene_cost table CYCLES.csv UPDATES.csv | cycles COUNT | changes\n";
    return 2;
  }
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    if (robot.name != "pr2") continue;
    if (mode == "changes") {
      printChanges(robot);
      return 0;
    }
    if (mode == "cycles") return runCycles(robot, std::stoul(argv[2]));
    std::ofstream cycles(argv[2]), updates(argv[3]);
    writeCycles(robot, cycles);
    writeUpdates(robot, updates);
    return cycles && updates ? 0 : 1;
  }
  return 1;
}
