// The broad phase of as few boxes as a robot has, for each instruction set of this machine:
//   few_boxes OUT.csv
//   few_boxes SCENE BOXES KERNEL METHOD CYCLES     to count instructions
// "each": each box against all that follow, as SweepAndPrune tests up to 160 (BroadPhase::AUTO).
// "ranks": a sorted sweep by RankSort. "bins": the sorted sweep of more boxes, without columns, and
// of any number with BroadPhase::SWEEP. All three give the
// same pairs, sorted; a number is the median of rounds in which the methods take turns.
// scripts/benchmark_broad_phase --few makes a table of it.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>

#include "benchmark_robots.h"
#include "broad_phase_scenes.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/mesh_loader.h"
#include "column_sweep.h"
#include "joint_sampler.h"
#include "rank_sort.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

constexpr double ALARM = 0.05;  // metres, the default
constexpr int ROUNDS = 301;
constexpr std::size_t SIZES[] = {8, 16, 32, 54, 80, 100, 120, 140, 160, 180, 200};

struct Scene {
  std::string name;
  std::vector<std::vector<Aabb>> frames;
  std::vector<std::uint32_t> models;
  std::size_t nb_boxes() const { return models.size(); }
};

Scene uniform(const std::string& name, std::size_t nb_boxes) {
  Scene scene{name, makeScene(name, nb_boxes).frames, {}};
  for (std::uint32_t i = 0; i < nb_boxes; ++i) scene.models.push_back(i);
  return scene;
}

Scene ofRobot(const BenchmarkRobot& robot) {
  CollisionDetector detector(CollisionScene::build(robot.robot, robot.srdf, nullptr));
  Scene scene{robot.name, {}, {}};
  for (const SceneElement& element : detector.scene().elements()) {
    scene.models.push_back(element.model);
  }
  CheckSettings settings;
  settings.list_boxes = true;
  BodyPoses poses;
  for (const auto& state : robot.states) {
    detector.scene().gatherPoses(state, poses);
    scene.frames.push_back(detector.detect(poses, settings).boxes);
  }
  return scene;
}

class FewBoxes {
 public:
  FewBoxes(const Scene& scene, const SweepKernel* kernel)
      : scene_(scene), kernel_(kernel), bins_(kernel), ranks_(lanesOf(*kernel)) {
    test_.models = scene.models.data();
    test_.squared_reach = squaredReach(ALARM);
    records_.resize(scene.nb_boxes());
  }

  const std::vector<BoxPair>& cycle(const std::string& method, std::size_t frame) {
    const std::vector<Aabb>& boxes = scene_.frames[frame % scene_.frames.size()];
    const auto count = static_cast<std::uint32_t>(boxes.size());
    test_.boxes = boxes.data();
    pairs_.clear();
    narrowBoxes(*kernel_, makeNarrowMap(sceneOrigin(boxes), 0.5 * axisReach(ALARM)), boxes,
                test_.models, records_.data());
    if (method == "bins") {
      bins_.begin(SweepTuning(), test_, UNSURE);
      bins_.sweep(records_.data(), count);
      pairs_.swap(bins_.pairs());
      sorter_.sort(*kernel_, count, &pairs_);
      return pairs_;
    }
    if (method == "ranks") {
      ranks_.sort(records_, count, &packed_, &row_end_);
    } else {
      packed_.resize(count);
      const PackedStorage::Writer write = packed_.writer();
      for (std::size_t i = 0; i < count; ++i) write(i, records_[i]);
      row_end_.assign(count, count);
    }
    Candidates* found = candidates_.clear();
    kernel_->sweep(packed_.view(), row_end_.data(), count, UNSURE, found);
    appendMovingPairs(*found, test_, &pairs_);
    if (method == "ranks") sorter_.sort(*kernel_, count, &pairs_);
    return pairs_;
  }

 private:
  static std::size_t lanesOf(const SweepKernel& kernel) {
    const std::string name = kernel.name;
    return name == "avx512" ? 16 : name == "avx2" ? 8 : 4;
  }

  const Scene& scene_;
  const SweepKernel* kernel_;
  ColumnSweep bins_;
  RankSort ranks_;
  PairTest test_;
  std::vector<Record> records_;
  PackedStorage packed_;
  CandidateStorage candidates_;
  std::vector<std::uint32_t> row_end_;
  std::vector<BoxPair> pairs_;
  PairSorter sorter_;
};

const std::vector<std::string> METHODS = {"each", "ranks", "bins"};

void measure(const Scene& scene, const SweepKernel& kernel, std::ostream& csv) {
  using Clock = std::chrono::steady_clock;
  FewBoxes few(scene, &kernel);
  const std::vector<BoxPair> expected = few.cycle("each", 0);
  const std::size_t cycles = 20000 / scene.nb_boxes() + 1;
  std::vector<std::vector<double>> ns(METHODS.size());
  for (int round = 0; round < ROUNDS; ++round) {
    for (std::size_t m = 0; m < METHODS.size(); ++m) {
      if (few.cycle(METHODS[m], 0) != expected) throw std::runtime_error("other pairs");
      const Clock::time_point start = Clock::now();
      for (std::size_t i = 0; i < cycles; ++i) few.cycle(METHODS[m], i);
      const double spent = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
      ns[m].push_back(spent / static_cast<double>(cycles));
    }
  }
  csv << scene.name << ',' << scene.nb_boxes() << ',' << kernel.name << ',' << expected.size();
  for (std::vector<double>& of : ns) {
    std::nth_element(of.begin(), of.begin() + ROUNDS / 2, of.end());
    csv << ',' << of[ROUNDS / 2];
  }
  csv << std::endl;
}

/// No states of it were recorded: these are drawn at random.
BenchmarkRobot baxter(const std::string& data) {
  const std::string model = data + "/robots/baxter_model";
  BenchmarkRobot loaded;
  loaded.name = "baxter";
  loaded.robot = RobotModel::fromUrdf(readTextFile(model + "/urdf/baxter.urdf"), makeMeshLoader());
  loaded.srdf = Srdf::fromXml(readTextFile(model + "/srdf/baxter.srdf"));
  const JointSampler sampler(loaded.robot, 1);
  std::vector<double> positions;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    sampler.draw(i, positions);
    loaded.states.emplace_back();
    loaded.robot->forwardKinematics(positions, loaded.states.back());
  }
  return loaded;
}

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (const BenchmarkRobot& robot : benchmarkRobots()) all.push_back(ofRobot(robot));
  const std::string data = sharedData();
  if (!data.empty()) all.push_back(ofRobot(baxter(data)));
  for (const char* name : {"uniform2", "uniform10"}) {
    for (const std::size_t size : SIZES) all.push_back(uniform(name, size));
  }
  return all;
}

const SweepKernel& kernelCalled(const std::string& name) {
  for (const SweepKernel* kernel : sweepKernels()) {
    if (name == kernel->name) return *kernel;
  }
  throw std::invalid_argument("this machine has no kernel " + name);
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1) {
    std::ofstream csv(arguments[0]);
    csv << "scene,boxes,kernel,pairs,each_ns,ranks_ns,bins_ns\n";
    for (const Scene& scene : scenes()) {
      for (const SweepKernel* kernel : sweepKernels()) measure(scene, *kernel, csv);
    }
    return 0;
  }
  if (arguments.size() != 5) throw std::invalid_argument("see the head of few_boxes.cpp");
  for (const Scene& scene : scenes()) {
    if (scene.name != arguments[0] || std::to_string(scene.nb_boxes()) != arguments[1]) continue;
    FewBoxes few(scene, &kernelCalled(arguments[2]));
    const int cycles = std::stoi(arguments[4]);
    for (int i = 0; i < cycles; ++i) few.cycle(arguments[3], static_cast<std::size_t>(i));
  }
  return 0;
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  return collision_pairs::run(std::vector<std::string>(argv + 1, argv + argc));
}
