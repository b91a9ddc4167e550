// The records of a bag, one after the other, whatever its state.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace collision_pairs {

/// A recorded message before it is understood. Valid during the call that hands it over.
struct RawMessage {
  const std::string& topic;
  const std::string& md5sum;
  std::int64_t received;  ///< nanoseconds since the epoch
  std::uint8_t* data;
  std::uint32_t size;
};

using RawMessageVisitor = std::function<void(const RawMessage&)>;

/// Reads a bag of format 2.0 from the front, without its index: a bag that was never closed, was
/// cut off or has damaged chunks is read as far as it goes, and of a damaged chunk what can be
/// decompressed. Messages come in the order of the file. Memory: one chunk. Returns what was lost,
/// a sentence each. Throws InputError if the file is no such bag, or is encrypted.
///
/// This is not left to rosbag_storage, not even for sound bags: it refuses a bag without an index,
/// and where one bit is wrong it may read beyond its buffers (1.15.15: of 1,500 bags with one bit
/// flipped, 14 ended the process), and nothing tells a sound bag from such a one before it is read.
std::vector<std::string> readBagRecords(const std::string& path, const RawMessageVisitor& visit);

}  // namespace collision_pairs
