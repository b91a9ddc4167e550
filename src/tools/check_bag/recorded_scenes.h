// The scenes that a node has published on ~scene, in a bag.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <collision_pairs/Scene.h>

#include "bag_records.h"
#include "stamps.h"

namespace collision_pairs {

class RecordedScenes {
 public:
  static bool isScene(const RawMessage& raw);

  /// Adds a message of the bag, if it is a scene.
  void take(const RawMessage& raw);
  /// After all messages.
  void finish(const BagRecords& records);

  /// Chooses a topic; empty: the only one. Throws InputError if the bag has no scenes on it, or
  /// several topics to choose from. False: there is none.
  bool choose(const std::string& topic);

  /// Of the chosen topic.
  const std::string& topic() const { return topic_; }
  /// The one with the earliest arrival. Throws InputError if none can be read.
  const Scene& first() const;
  bool isChosen(const RawMessage& raw) const { return isScene(raw) && raw.topic == topic_; }
  /// Why the scene may have been another one at that time; empty: it was the last that had arrived,
  /// or the first if it was published before.
  std::string whySuspectAt(StampNs now) const;

 private:
  struct Track {
    Scene first;
    StampNs first_arrival = NEVER;
    struct Revision {
      std::uint64_t number = 0;
      StampNs since = 0;  ///< tells two nodes apart that have counted equally far
    };
    /// By arrival, the highest; none: it cannot be read.
    std::map<StampNs, std::optional<Revision>> revisions;
  };
  std::map<std::string, Track> tracks_;  ///< by topic
  std::vector<BagLoss> losses_;
  std::string topic_;
};

}  // namespace collision_pairs
