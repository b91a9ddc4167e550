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

/// False for bags that only rosbag_storage can read: of another format than 2.0, or encrypted.
/// Throws InputError if the file is no bag at all.
bool hasPlainRecords(const std::string& path);

/// Reads a bag from the front, without its index: a bag that was never closed, was cut off or has
/// damaged chunks is read as far as it goes, and of a damaged chunk what can be decompressed.
/// (rosbag_storage refuses the first two, and reads beyond its buffers where an index or a chunk is
/// damaged: since nothing tells a sound bag before it is read, it does not read those either.)
/// Messages come in the order of the file. Memory: one chunk. Returns what was lost, a sentence
/// each.
std::vector<std::string> readBagRecords(const std::string& path, const RawMessageVisitor& visit);

}  // namespace collision_pairs
