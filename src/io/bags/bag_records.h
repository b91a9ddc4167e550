// Reads the records of a bag in order, even if it is damaged.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace collision_pairs {

/// A recorded message before deserialisation. Valid during the call that passes it.
struct RawMessage {
  const std::string& topic;
  const std::string& type;  ///< as package/Name
  const std::string& md5sum;
  const std::string& publisher;  ///< its node's name; may be empty
  std::int64_t received;         ///< nanoseconds since the epoch
  std::uint8_t* data;
  std::uint32_t size;
};

using RawMessageVisitor = std::function<void(const RawMessage&)>;

/// What could not be read: messages that were recorded after one time and before another may be
/// missing, as far as those of the file are in order. Nanoseconds since the epoch.
struct BagLoss {
  std::string what;  ///< one sentence
  std::int64_t after = std::numeric_limits<std::int64_t>::min();
  std::int64_t before = std::numeric_limits<std::int64_t>::max();
};

struct BagConnection {
  std::string topic, type, md5sum, publisher;
  bool operator==(const BagConnection& other) const;
};

struct BagRecords {
  std::vector<BagLoss> losses;
  std::vector<BagConnection> connections;  ///< also those of which no message was read
};

/// Reads a bag of format 2.0 from the front, without its index: a bag that was never closed, is
/// truncated or has damaged chunks is read as far as possible, including the part of a damaged
/// chunk that can be decompressed. Messages come in the order of the file. Memory: one chunk. A
/// record that is not understood is a loss, and so is a message that the index of its chunk lists
/// and that is not in it. Throws InputError if the file is not such a bag, or is encrypted.
///
/// rosbag_storage is not used, not even for intact bags: it refuses a bag without an index,
/// and where one bit is wrong it may read beyond its buffers (1.15.15: of 1,500 bags with one bit
/// flipped, 14 ended the process), and a damaged bag cannot be recognised before it is read.
BagRecords readBagRecords(const std::string& path, const RawMessageVisitor& visit);

}  // namespace collision_pairs
