#include "edge_stage.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace collision_pairs {
namespace {

// Of the searches so far, in configurations. Making the stage takes as long as that many, and a
// query of two shapes as long as ten.
constexpr std::uint64_t WORTH_A_STAGE = 30000;
constexpr std::uint64_t QUERY = 10;

}  // namespace

std::shared_ptr<EdgeStage> EdgeStage::of(const std::shared_ptr<const CollisionScene>& scene) {
  using Scene = std::weak_ptr<const CollisionScene>;
  static std::mutex mutex;
  static std::map<Scene, std::weak_ptr<EdgeStage>, std::owner_less<Scene>> stages;
  const std::lock_guard<std::mutex> lock(mutex);
  for (auto i = stages.begin(); i != stages.end();) {
    i = i->second.expired() ? stages.erase(i) : std::next(i);
  }
  std::weak_ptr<EdgeStage>& kept = stages[scene];
  std::shared_ptr<EdgeStage> stage = kept.lock();
  if (!stage) kept = stage = std::make_shared<EdgeStage>(scene);
  return stage;
}

bool EdgeStage::maySettle(const MotionSettings& settings, const JointMotion& motion,
                          const PlacedBodies& placed) {
  const auto isZero = [](double x) { return x == 0.0; };
  return settings.only_free && !settings.from_start && !settings.only_moved &&
         settings.fidelity == Fidelity::MESH && isZero(settings.clearance) &&
         !settings.clearance_of && isZero(settings.time_budget) &&
         settings.resolution <= PairTable::APART && placed.empty() &&
         std::all_of(motion.deviation.begin(), motion.deviation.end(), isZero);
}

void EdgeStage::count(const MotionReport& report) {
  const std::uint64_t work = report.nb_checks + QUERY * report.nb_queries;
  if (work_.fetch_add(work) + work < WORTH_A_STAGE) return;
  std::call_once(once_, [this] {
    stage_ = BatchStage::make(*scene_);
    is_made_.store(stage_ != nullptr, std::memory_order_release);
  });
}

std::unique_ptr<BatchStage::EdgeGroup> EdgeStage::makeGroup() const {
  return std::make_unique<BatchStage::EdgeGroup>(*stage_);
}

std::vector<OpenPair> openPairsOf(const BatchStage::EdgeGroup& edge, const CollisionScene& scene,
                                  const MotionPairs& pairs) {
  const auto& elements = scene.elements();
  std::vector<OpenPair> found;
  for (const BatchStage::EdgeGroup::Part& part : edge.parts()) {
    OpenPair open;
    open.pair = part.pair;
    open.begin = part.begin;
    open.end = part.end;
    open.clearance = PairTable::APART;
    if (part.is_static) {
      open.pair.second = ALL_STATIC;
    } else {
      open.frame = pairs.frameOf(scene.robot(), open.pair);
      const bool in_order = elements[open.pair.first].model < elements[open.pair.second].model;
      if (!in_order) std::swap(open.pair.first, open.pair.second);
    }
    found.push_back(open);
  }
  return found;
}

}  // namespace collision_pairs
