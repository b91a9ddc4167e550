// Records reports and markers as a bag, to be played together with the checked one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rosbag/bag.h>

#include "collision_pairs/collision_detector.h"
#include "stamps.h"

namespace collision_pairs {

/// Writes what the node would have published, on the node's topics, at the stamps of the poses.
/// Through a temporary file beside `path` that takes its name only in finish(): whatever goes
/// wrong, no partial bag is left under the final name.
class BagRecorder {
 public:
  /// Throws InputError if it cannot be written.
  explicit BagRecorder(const std::string& path);
  ~BagRecorder();
  BagRecorder(const BagRecorder&) = delete;
  BagRecorder& operator=(const BagRecorder&) = delete;

  /// `frame` is the frame of the root link as the checked bag calls it.
  void write(const CollisionReport& report, const CollisionScene& scene,
             const CheckSettings& settings, const std::string& frame, StampNs stamp);
  void finish();

 private:
  std::string path_;
  std::string part_;
  /// On a full disk the bag's own destructor throws, which would end the process.
  struct Close {
    void operator()(rosbag::Bag* bag) const;
  };
  std::unique_ptr<rosbag::Bag, Close> bag_;
};

}  // namespace collision_pairs
