// Checks what a node would have reported of a bag, row by row.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bag_outputs.h"
#include "bag_recorder.h"
#include "bag_replay.h"
#include "collision_pairs/collision_detector.h"
#include "scene_files.h"

namespace collision_pairs {

struct BagCheckOptions {
  std::vector<std::string> bags;
  SceneOptions scene;
  std::string scene_topic;  ///< of several in a bag; empty: the only one
  BagReplayOptions replay;
  bool has_limits = false;  ///< those of a recorded scene do not count
  CheckSettings settings;
  Shard shard;
};

class BagChecker {
 public:
  /// All must outlive it; the recorder may be null.
  BagChecker(const BagCheckOptions& options, const BagLineSink& sink, BagRecorder* recorder)
      : options_(options), sink_(sink), recorder_(recorder) {}

  /// The bag of that number. Throws InputError that names it.
  void check(std::size_t number);

 private:
  void checkOneScene(std::size_t number, const BagIndex& index, const RawMessageFilter& wants);
  void checkRecordedScenes(std::size_t number, const BagIndex& index, const RawMessageFilter& wants,
                           const RecordedScenes& scenes);
  void checkReports(std::size_t number, std::size_t nb_messages, BagReplay& replay);
  void write(std::size_t number, std::size_t state, const Snapshot& snapshot,
             const BagReplay& replay);

  const BagCheckOptions& options_;
  const BagLineSink& sink_;
  BagRecorder* recorder_;
  std::string urdf_, srdf_;  // of parameters_
  SceneParameters parameters_;
  std::set<std::string> told_;
  const std::shared_ptr<SceneCache> cache_ = std::make_shared<SceneCache>();
  std::unique_ptr<CollisionDetector> detector_;
};

}  // namespace collision_pairs
