#include "collision_pairs/batch_check.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "batch_stage.h"
#include "check_input.h"
#include "in_parallel.h"
#include "open_pairs.h"

namespace collision_pairs {
namespace {

constexpr std::size_t BLOCK = 16;        // states per piece of work: usually less than 0.1 ms
constexpr std::size_t STAGE_BLOCK = 64;  // the same, in whole groups of lanes

}  // namespace

/// Data of one thread for the batch stage, kept from batch to batch.
struct BatchCheck::StageOfThread {
  StageOfThread(const std::shared_ptr<const CollisionScene>& scene, const BatchStage& stage)
      : group(stage), open(scene, stage.fidelity(), stage.solids()) {}
  BatchStage::Group group;
  OpenPairs open;
};

/// The stage of one fidelity.
struct BatchCheck::Stage {
  std::size_t nb_verdicts = 0;  // requested so far
  bool was_tried = false;
  std::unique_ptr<const BatchStage> stage;
  std::vector<std::unique_ptr<StageOfThread>> of_threads;  // one per detector
};

/// Processes joint states of one batch on one thread.
class BatchCheck::JointsOfThread {
 public:
  /// stage: null if all states go to the exact check.
  JointsOfThread(const CollisionScene& scene, CollisionDetector& detector, StageOfThread* stage,
                 const CheckSettings& settings, const Positions& positions,
                 const CloudVoxels& voxels, const Take& take)
      : scene_(scene),
        detector_(detector),
        settings_(settings),
        positions_(positions),
        take_(take),
        group_(stage != nullptr ? &stage->group : nullptr),
        open_(stage != nullptr ? &stage->open : nullptr) {
    poses_.voxels = voxels;
  }

  /// Processes the states begin … end - 1.
  void run(std::size_t begin, std::size_t end) {
    const std::size_t step = group_ ? static_cast<std::size_t>(group_->lanes()) : 1;
    for (; begin < end; begin += step) {
      if (group_) {
        runGroup(begin, std::min(end, begin + step));
      } else {
        positions_(begin, q_[0]);
        checkExactly(begin, q_[0]);
      }
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  void runGroup(std::size_t begin, std::size_t end) {
    group_->clear();
    const Clock::time_point start = settings_.stage_times ? Clock::now() : Clock::time_point();
    for (std::size_t i = begin; i < end; ++i) {
      positions_(i, q_[i - begin]);
      group_->set(static_cast<int>(i - begin), q_[i - begin]);
    }
    group_->settle();
    share_ = secondsSince(start) / static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i) takeLane(i, static_cast<int>(i - begin));
  }

  void takeLane(std::size_t state, int lane) {
    using Outcome = BatchStage::Group::Outcome;
    switch (group_->outcome(lane)) {
      case Outcome::FREE:
        return takeFree(state, share_);
      case Outcome::CONTACT:
        return takeContact(state, group_->contact(lane), share_);
      case Outcome::OPEN:
        return checkOpen(state, lane);
    }
  }

  void checkOpen(std::size_t state, int lane) {
    const std::vector<double>& q = q_[static_cast<std::size_t>(lane)];
    if (!group_->isSet(lane)) return checkExactly(state, q);
    const Clock::time_point start = settings_.stage_times ? Clock::now() : Clock::time_point();
    group_->openPairs(lane, pairs_);
    group_->openBesideStatic(lane, beside_static_);
    const OpenPairs::Outcome outcome = open_->check(q, pairs_, beside_static_);
    if (outcome == OpenPairs::Outcome::NOT_SETTLED) return checkExactly(state, q);
    const double seconds = share_ + secondsSince(start);
    outcome == OpenPairs::Outcome::FREE ? takeFree(state, seconds)
                                        : takeContact(state, open_->contact(), seconds);
  }

  void checkExactly(std::size_t state, const std::vector<double>& q) {
    scene_.robot().forwardKinematics(q, X_RB_);
    scene_.gatherPoses(X_RB_, poses_);
    take_(state, detector_.detect(poses_, settings_));
  }

  void takeFree(std::size_t state, double seconds) {
    settled_.pairs.clear();
    takeSettled(state, verdictOf(false, false), seconds);
  }

  void takeContact(std::size_t state, const BoxPair& elements, double seconds) {
    const auto models = std::minmax(scene_.elements()[elements.first].model,
                                    scene_.elements()[elements.second].model);
    settled_.pairs.assign(1, {models.first, models.second, PairState::CONTACT, 0.0,
                              settings_.fidelity, Certainty::BOUND, 0, 0});
    takeSettled(state, verdictOf(true, false), seconds);
  }

  void takeSettled(std::size_t state, Verdict verdict, double seconds) {
    settled_.verdict = verdict;
    settled_.in_collision = verdict != Verdict::FREE;
    settled_.ended_early = verdict == Verdict::COLLISION;
    settled_.min_distance_is_bound = verdict == Verdict::FREE;
    settled_.times.total = seconds;
    take_(state, settled_);
  }

  double secondsSince(Clock::time_point start) const {
    if (!settings_.stage_times) return 0.0;
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  const CollisionScene& scene_;
  CollisionDetector& detector_;
  const CheckSettings& settings_;
  const Positions& positions_;
  const Take& take_;
  BatchStage::Group* const group_;
  OpenPairs* const open_;
  std::vector<double> q_[MOST_BATCH_LANES];
  std::vector<Eigen::Isometry3d> X_RB_;
  BodyPoses poses_;
  std::vector<BoxPair> pairs_;
  std::vector<std::uint32_t> beside_static_;
  CollisionReport settled_;
  double share_ = 0.0;  // a state's share of the stage's time for its group, s
};

BatchCheck::BatchCheck(std::shared_ptr<const CollisionScene> scene, unsigned threads)
    : scene_(std::move(scene)) {
  const std::size_t nb_detectors = nbThreads(threads, std::numeric_limits<std::size_t>::max());
  for (std::size_t i = 0; i < nb_detectors; ++i) detectors_.emplace_back(scene_);
}

BatchCheck::~BatchCheck() = default;

void BatchCheck::run(std::size_t count, const CheckSettings& settings, const Pose& pose,
                     const Take& take) {
  std::vector<BodyPoses> poses(detectors_.size());
  for (BodyPoses& of_thread : poses) of_thread.resize(scene_->bodies().size());
  const std::size_t nb_blocks = count / BLOCK + (count % BLOCK > 0);
  inParallel(detectors_.size(), nb_blocks, [&](std::size_t thread, std::size_t block) {
    const std::size_t begin = block * BLOCK, end = std::min(begin + BLOCK, count);
    for (std::size_t i = begin; i < end; ++i) {
      pose(i, poses[thread]);
      take(i, detectors_[thread].detect(poses[thread], settings));
    }
  });
}

void BatchCheck::runJoints(std::size_t count, const CheckSettings& settings,
                           const Positions& positions, const CloudVoxels& voxels,
                           const Take& take) {
  if (count > 0) checkSettings(settings);  // detectors do not see all states
  Stage* const stage = stageFor(count, settings);
  const std::size_t size = stage != nullptr ? STAGE_BLOCK : BLOCK;
  const std::size_t nb_blocks = count / size + (count % size > 0);
  std::vector<std::unique_ptr<JointsOfThread>> threads(detectors_.size());
  if (stage != nullptr) stage->of_threads.resize(threads.size());
  inParallel(threads.size(), nb_blocks, [&](std::size_t thread, std::size_t block) {
    auto& of_thread = threads[thread];
    if (!of_thread) {
      StageOfThread* kept = nullptr;
      if (stage != nullptr) {
        auto& made = stage->of_threads[thread];
        if (!made) made = std::make_unique<StageOfThread>(scene_, *stage->stage);
        kept = made.get();
      }
      of_thread = std::make_unique<JointsOfThread>(*scene_, detectors_[thread], kept, settings,
                                                   positions, voxels, take);
    }
    of_thread->run(block * size, std::min((block + 1) * size, count));
  });
}

BatchCheck::Stage* BatchCheck::stageFor(std::size_t count, const CheckSettings& settings) {
  const Fidelity fidelity = settings.fidelity;
  const bool has_stage = fidelity == Fidelity::MESH || fidelity == Fidelity::SPHERES;
  const bool is_possible = scene_->unchecked().empty() && settings.verdict_only && has_stage &&
                           settings.time_budget == 0.0 && !settings.min_distance &&
                           !settings.selection && !settings.may_ignore;
  if (!is_possible) return nullptr;
  auto& of_fidelity = stages_[fidelity];
  if (!of_fidelity) of_fidelity = std::make_unique<Stage>();
  Stage& stage = *of_fidelity;
  stage.nb_verdicts += count;
  if (stage.nb_verdicts >= STATES_WORTH_A_STAGE && !stage.was_tried) {
    stage.stage = BatchStage::make(*scene_, fidelity);
    stage.was_tried = true;
  }
  return stage.stage != nullptr ? &stage : nullptr;
}

std::size_t BatchCheck::stageMemory() const {
  std::size_t bytes = 0;
  for (const auto& [fidelity, of_fidelity] : stages_) {
    if (of_fidelity->stage) bytes += of_fidelity->stage->memory();
  }
  return bytes;
}

}  // namespace collision_pairs
