#include "bag_recorder.h"

#include <filesystem>

#include <std_msgs/Bool.h>
#include <unistd.h>

#include "collision_pairs/input_error.h"
#include "conversions.h"
#include "markers.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

namespace fs = std::filesystem;

const std::string NODE = "/collision_pairs_node/";

}  // namespace

BagRecorder::BagRecorder(const std::string& path)
    : path_(path),
      part_(behindLinks(path) + ".part" + std::to_string(::getpid())),
      bag_(new rosbag::Bag) {
  // Writing a bag seeks, and its file replaces the one of that name: not possible for a device.
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_regular_file(path_, error)) {
    throw InputError(path_ + ": is not a regular file");
  }
  try {
    bag_->open(part_, rosbag::bagmode::Write);
  } catch (const rosbag::BagException&) {
    fs::remove(part_, error);
    throw InputError(path_ + ": cannot be written");
  }
  bag_->setCompression(rosbag::compression::LZ4);
}

void BagRecorder::Close::operator()(rosbag::Bag* bag) const {
  try {
    bag->close();
    delete bag;
  } catch (const std::exception&) {  // it would throw again: the bag is leaked on purpose
  }
}

BagRecorder::~BagRecorder() {
  if (part_.empty()) return;
  std::error_code error;
  fs::remove(part_, error);  // later writes go to an unlinked file
}

void BagRecorder::write(const CollisionReport& report, const CollisionScene& scene,
                        const CheckSettings& settings, const std::string& frame, StampNs stamp) {
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(stamp));
  const CollisionPairs message = toMessage(report, scene, settings, frame, time);
  std_msgs::Bool in_collision;
  in_collision.data = message.in_collision;
  try {
    bag_->write(NODE + "collision_pairs", time, message);
    bag_->write(NODE + "in_collision", time, in_collision);
    bag_->write(NODE + "markers", time, toMarkers(message, &report, false));
  } catch (const rosbag::BagException& error) {
    throw InputError(path_ + ": " + error.what());
  }
}

void BagRecorder::finish() {
  try {
    bag_->close();
    fs::rename(part_, behindLinks(path_));
  } catch (const std::exception& error) {
    throw InputError(path_ + ": cannot be written: " + error.what());
  }
  part_.clear();
}

}  // namespace collision_pairs
