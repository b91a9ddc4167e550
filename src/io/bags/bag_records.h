// Reads the records of a bag in order, even if it is damaged.
#pragma once

#include <cstdint>
#include <functional>
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
  std::size_t nb_losses = 0;  ///< parts of the file before it that could not be read
};

using RawMessageVisitor = std::function<void(const RawMessage&)>;

/// Reads a bag of format 2.0 from the front, without its index: a bag that was never closed, is
/// truncated or has damaged chunks is read as far as possible, including the part of a damaged
/// chunk that can be decompressed. Messages come in the order of the file. Memory: one chunk.
/// Returns what was lost, one sentence each. Throws InputError if the file is not such a bag, or is
/// encrypted.
///
/// rosbag_storage is not used, not even for intact bags: it refuses a bag without an index,
/// and where one bit is wrong it may read beyond its buffers (1.15.15: of 1,500 bags with one bit
/// flipped, 14 ended the process), and a damaged bag cannot be recognised before it is read.
std::vector<std::string> readBagRecords(const std::string& path, const RawMessageVisitor& visit);

}  // namespace collision_pairs
