#include "bag_chunk.h"

#include <algorithm>

#include <bzlib.h>
#include <roslz4/lz4s.h>

namespace collision_pairs {
namespace {

constexpr std::uint32_t LARGEST_CHUNK = 1u << 30;  // bytes; a damaged size asks for more

bool decompressBz2(std::string& data, std::string& content) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return false;
  stream.next_in = data.data();
  stream.avail_in = static_cast<unsigned>(data.size());
  stream.next_out = content.data();
  stream.avail_out = static_cast<unsigned>(content.size());
  int result = BZ_OK;
  while (result == BZ_OK && stream.avail_out > 0) {
    const unsigned before = stream.avail_out + stream.avail_in;
    result = BZ2_bzDecompress(&stream);
    if (stream.avail_out + stream.avail_in == before) break;  // it wants more than there is
  }
  content.resize(content.size() - stream.avail_out);
  BZ2_bzDecompressEnd(&stream);
  return result == BZ_STREAM_END || result == BZ_OK;
}

bool decompressLz4(std::string& data, std::string& content) {
  roslz4_stream stream{};
  if (roslz4_decompressStart(&stream) != ROSLZ4_OK) return false;
  stream.input_next = data.data();
  stream.input_left = static_cast<int>(data.size());
  stream.output_next = content.data();
  stream.output_left = static_cast<int>(content.size());
  int result = ROSLZ4_OK;
  while (result == ROSLZ4_OK && stream.input_left > 0) {
    const int before = stream.output_left + stream.input_left;
    result = roslz4_decompress(&stream);
    if (stream.output_left + stream.input_left == before) break;
  }
  content.resize(content.size() - static_cast<std::size_t>(stream.output_left));
  roslz4_decompressEnd(&stream);
  return result == ROSLZ4_STREAM_END || result == ROSLZ4_OK;
}

}  // namespace

bool decompressChunk(const std::string& compression, const std::string& data, std::uint32_t size,
                     std::string& content) {
  if (compression == "none") {
    content = data.substr(0, size);
    return content.size() == size;
  }
  std::string input = data;  // both libraries want it writable
  content.resize(std::min(size, LARGEST_CHUNK));
  bool sound = false;
  if (compression == "bz2")
    sound = decompressBz2(input, content);
  else if (compression == "lz4")
    sound = decompressLz4(input, content);
  else
    content.clear();
  return sound && content.size() == size;
}

}  // namespace collision_pairs
