// BM_<Who>/<scene>/<n>: one cycle with every box moved, from boxes to pairs.
// Choose with --benchmark_filter; without it everything runs, and that takes hours.
#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "broad_phase_peers.h"
#include "broad_phase_scenes.h"

namespace collision_pairs {
namespace {

constexpr std::size_t SIZES[] = {10, 50, 100, 1000, 10000, 100000, 1000000};

// The scene asked for last; benchmarks of one scene and size run one after the other.
const MovingScene& cachedScene(const std::string& name, std::size_t nb_boxes) {
  static std::string cached_name;
  static std::size_t cached_size = 0;
  static MovingScene scene;
  if (cached_name != name || cached_size != nb_boxes) {
    scene = MovingScene();
    scene = makeScene(name, nb_boxes);
    cached_name = name;
    cached_size = nb_boxes;
  }
  return scene;
}

// "Twice as many pairs" is not the same work: the pairs of one frame are counted by everyone and
// stand beside the time. Bullet keeps boxes in float and pairs until their boxes part.
void runCycles(benchmark::State& state, const std::string& who, const std::string& scene_name,
               std::size_t nb_boxes) {
  const MovingScene& scene = cachedScene(scene_name, nb_boxes);
  const std::unique_ptr<BroadPhasePeer> peer = makePeer(who, scene);
  constexpr int WARM_UP = 2;
  std::size_t frame = 0;
  const auto cycle = [&] { return peer->cycle(scene.frames[frame++ % scene.frames.size()]); };
  for (int i = 0; i < WARM_UP; ++i) benchmark::DoNotOptimize(cycle());
  for (auto _ : state) benchmark::DoNotOptimize(cycle());
  state.counters["pairs"] = static_cast<double>(peer->cycle(scene.frames[0]));
  state.counters["boxes"] = static_cast<double>(nb_boxes);
}

void registerAll() {
  for (const std::string& scene : sceneNames()) {
    for (const std::size_t size : SIZES) {
      for (const std::string& who : peerNames()) {
        if (size > largestScene(who, scene)) continue;
        benchmark::RegisterBenchmark(
            ("BM_" + who + "/" + scene + "/" + std::to_string(size)).c_str(),
            [who, scene, size](benchmark::State& state) { runCycles(state, who, scene, size); })
            ->Unit(benchmark::kMicrosecond);
      }
    }
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  collision_pairs::registerAll();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
