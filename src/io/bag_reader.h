// Reads the data of a robot from a bag: transforms, joint positions, descriptions.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bag_records.h"
#include "transform_buffer.h"

namespace collision_pairs {

/// A joint's position as it was recorded; of the topic under which it is kept.
struct RecordedPosition {
  StampNs received, stamp;
  int publisher, joint;  ///< numbers of names
  double position;       ///< rad or m, finite
};

class BagContents {
 public:
  explicit BagContents(const PoseLimits& given = {}) : limits(given), transforms(given, true) {}

  /// Adds a transform, in the order of arrival; returns why it is not used, or in doubt.
  std::string take(const ReceivedTransform& transform, bool is_static, const std::string& publisher,
                   StampNs received);
  /// visit(transform, is_static, publisher, received): all that were taken, in their order.
  template <class Visit>
  void forEachTransform(const Visit& visit) const {
    const std::vector<std::string>& all = names.all();
    for (const Recorded& r : recorded_) {
      visit(ReceivedTransform{all[r.parent], all[r.child], r.stamp, r.p_PC, r.R_PC}, r.is_static,
            all[r.publisher], r.received);
    }
  }

  PoseLimits limits;
  TransformBuffer transforms;                ///< of all topics named tf and tf_static
  std::vector<std::vector<StampNs>> stamps;  ///< by frame: of /tf, also of those refused
  std::map<std::string, std::vector<RecordedPosition>> joints;  ///< by topic: named joint_states
  std::map<std::string, std::string> urdfs;  ///< by topic: those named robot_description
  std::map<std::string, std::string> srdfs;  ///< … and robot_description_semantic
  std::size_t nb_messages = 0;               ///< of these topics
  std::vector<std::string> losses;           ///< what could not be read, one sentence each
  Names names;                               ///< of frames, publishers and joints

 private:
  struct Recorded {
    StampNs received, stamp;
    int parent, child, publisher;
    bool is_static;
    Eigen::Vector3d p_PC;
    Eigen::Quaterniond R_PC;
  };
  std::vector<Recorded> recorded_;
};

/// Reads a complete bag; messages of other topics are skipped. Topics are identified by the last
/// part of their name and by the type: tf2_msgs/TFMessage and the older tf/tfMessage (the same on
/// the wire), sensor_msgs/JointState, std_msgs/String. None, bz2 and lz4 compression.
///
/// Transforms and joint positions are taken in the order in which they were recorded, by the rules
/// that the node follows. A joint state without a stamp has the time at which it was recorded.
///
/// A bag without an index, truncated or with damaged chunks is read as far as possible
/// (readBagRecords), and `losses` says what is missing. Throws InputError if it is not a bag, or
/// contains no data of a robot. `also` sees every message, in the order of the file.
BagContents readBag(const std::string& path, const PoseLimits& limits = {},
                    const RawMessageVisitor& also = nullptr);

}  // namespace collision_pairs
