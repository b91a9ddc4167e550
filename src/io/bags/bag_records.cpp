#include "bag_records.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

const std::string ANY_MAGIC = "#ROS";  // formats before 2.0 begin with #ROSLOG or #ROSRECORD
const std::string MAGIC = "#ROSBAG V2.0\n";
constexpr std::uint32_t LONGEST_HEADER = 1 << 20;  // bytes; rosbag writes some hundred

enum Op { MESSAGE = 2, BAG_HEADER = 3, CHUNK = 5, CONNECTION = 7 };

using Fields = std::map<std::string, std::string>;

std::uint32_t toNumber(const char* bytes) {
  std::uint32_t number;
  std::memcpy(&number, bytes, sizeof number);  // bags are little-endian, like all platforms of ROS
  return number;
}

/// A sequence of "name=value" entries, each after its length. Empty if malformed.
Fields parseFields(const char* at, std::size_t size) {
  Fields fields;
  for (std::size_t begin = 0; begin + 4 <= size;) {
    const std::uint32_t length = toNumber(at + begin);
    begin += 4;
    if (length > size - begin) return {};
    const std::string field(at + begin, length);
    const std::size_t equals = field.find('=');
    if (equals == std::string::npos) return {};
    fields[field.substr(0, equals)] = field.substr(equals + 1);
    begin += length;
  }
  return fields;
}

std::uint32_t numberIn(const Fields& fields, const std::string& name, std::size_t offset = 0) {
  const auto found = fields.find(name);
  return found == fields.end() || found->second.size() < offset + 4
             ? 0
             : toNumber(found->second.data() + offset);
}

int opOf(const Fields& fields) {
  const auto op = fields.find("op");
  return op == fields.end() || op->second.size() != 1 ? -1 : op->second[0];
}

constexpr std::uint32_t LARGEST_CHUNK = 1u << 30;  // bytes; only a damaged size exceeds it

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
    if (stream.avail_out + stream.avail_in == before) break;  // the input is truncated
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

/// `compression` is none, bz2 or lz4. Appends to `content` what can be decompressed, at most `size`
/// bytes; false if that is not all of it.
bool decompressChunk(const std::string& compression, const std::string& data, std::uint32_t size,
                     std::string& content) {
  if (compression == "none") {
    content = data.substr(0, size);
    return content.size() == size;
  }
  std::string input = data;  // both libraries require it to be writable
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

struct Connection {
  std::string topic, type, md5sum, publisher;
};

class RecordReader {
 public:
  RecordReader(const std::string& path, const RawMessageVisitor& visit)
      : path_(path), file_(path, std::ios::binary), visit_(visit) {}

  std::vector<std::string> run() {
    std::string magic(MAGIC.size(), ' ');
    file_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
    if (magic.compare(0, ANY_MAGIC.size(), ANY_MAGIC) != 0) {
      const auto endsWith = [&](const std::string& end) {
        return path_.size() >= end.size() &&
               path_.compare(path_.size() - end.size(), end.size(), end) == 0;
      };
      const bool is_of_ros2 = endsWith(".db3") || endsWith(".mcap");
      throw InputError(path_ + ": is not a bag" +
                       (is_of_ros2 ? " of ROS 1; convert it with rosbags-convert" : ""));
    }
    if (magic != MAGIC) {
      throw InputError(path_ + ": is a bag of a format other than 2.0; convert it with " +
                       "rosbag record while rosbag play runs");
    }
    while (file_.peek() != std::char_traits<char>::eof() && readRecord()) {
    }
    return std::move(losses_);
  }

 private:
  bool readRecord() {
    const auto place = static_cast<std::uint64_t>(file_.tellg());
    const std::optional<std::string> header = readBlock(LONGEST_HEADER);
    const Fields fields = header ? parseFields(header->data(), header->size()) : Fields();
    if (fields.empty()) return lose("nothing could be read after byte " + std::to_string(place));
    std::uint32_t size = 0;
    std::string data;
    const bool whole = readSize(size) && readData(size, data);
    take(fields, data, place);
    if (!whole)
      lose("the file is truncated within the record that begins at byte " + std::to_string(place));
    return whole;
  }

  void take(const Fields& fields, std::string& data, std::uint64_t place) {
    switch (opOf(fields)) {
      case CHUNK:
        takeChunk(fields, data, place);
        break;
      case CONNECTION:
        takeConnection(fields, data.data(), data.size());
        break;
      case BAG_HEADER:
        refuseEncrypted(fields);
        if (numberIn(fields, "index_pos") == 0 && numberIn(fields, "index_pos", 4) == 0) {
          lose("it has no index: its recording was not closed");
        }
        break;
      default:  // indices, which are not needed
        break;
    }
  }

  void refuseEncrypted(const Fields& fields) const {
    const auto encryptor = fields.find("encryptor");
    if (encryptor == fields.end() || encryptor->second.empty()) return;
    throw InputError(path_ + ": is encrypted with " + encryptor->second +
                     "; decrypt it with rosbag decrypt");
  }

  void takeChunk(const Fields& fields, const std::string& data, std::uint64_t place) {
    const auto compression = fields.find("compression");
    std::string content;
    const bool whole = decompressChunk(compression == fields.end() ? "none" : compression->second,
                                       data, numberIn(fields, "size"), content);
    const bool understood = readRecordsIn(content);
    if (whole && understood) return;
    lose("the end of the chunk at byte " + std::to_string(place) + " (of its " +
         std::to_string(numberIn(fields, "size")) + " bytes " + std::to_string(content.size()) +
         " were read)");
  }

  bool readRecordsIn(std::string& content) {
    std::size_t at = 0;
    const auto left = [&] { return content.size() - at; };
    while (left() > 0) {
      if (left() < 4 || toNumber(&content[at]) > left() - 4) return false;
      const std::uint32_t header_size = toNumber(&content[at]);
      const Fields fields = parseFields(&content[at + 4], header_size);
      at += 4 + header_size;
      if (left() < 4 || toNumber(&content[at]) > left() - 4) return false;
      const std::uint32_t size = toNumber(&content[at]);
      at += 4;
      if (opOf(fields) == CONNECTION) takeConnection(fields, &content[at], size);
      if (opOf(fields) == MESSAGE) takeMessage(fields, &content[at], size);
      at += size;
    }
    return true;
  }

  void takeConnection(const Fields& fields, const char* data, std::size_t size) {
    Fields header = parseFields(data, size);
    const auto topic = fields.find("topic");
    if (topic == fields.end()) return;
    connections_[numberIn(fields, "conn")] = {topic->second, header["type"], header["md5sum"],
                                              header["callerid"]};
  }

  void takeMessage(const Fields& fields, char* data, std::uint32_t size) {
    const auto found = connections_.find(numberIn(fields, "conn"));
    if (found == connections_.end()) return;
    const Connection& from = found->second;
    visit_({from.topic, from.type, from.md5sum, from.publisher,
            std::int64_t{numberIn(fields, "time")} * 1000000000 + numberIn(fields, "time", 4),
            reinterpret_cast<std::uint8_t*>(data), size, losses_.size()});
  }

  bool readSize(std::uint32_t& size) {
    char bytes[4];
    if (!file_.read(bytes, sizeof bytes)) return false;
    size = toNumber(bytes);
    return true;
  }

  /// Reads as much of it as exists; false if that is not all. Grows while reading, so that a
  /// damaged size cannot request gigabytes.
  bool readData(std::uint32_t size, std::string& data) {
    constexpr std::size_t STEP = 1 << 20;
    while (data.size() < size && file_) {
      const std::size_t begin = data.size();
      data.resize(begin + std::min<std::size_t>(STEP, size - begin));
      file_.read(&data[begin], static_cast<std::streamsize>(data.size() - begin));
      data.resize(begin + static_cast<std::size_t>(file_.gcount()));
    }
    return data.size() == size;
  }

  std::optional<std::string> readBlock(std::uint32_t longest) {
    std::uint32_t size = 0;
    std::string data;
    if (!readSize(size) || size > longest || !readData(size, data)) return std::nullopt;
    return data;
  }

  bool lose(const std::string& what) {
    losses_.push_back(what);
    return false;
  }

  const std::string& path_;
  std::ifstream file_;
  const RawMessageVisitor& visit_;
  std::map<std::uint32_t, Connection> connections_;
  std::vector<std::string> losses_;
};

}  // namespace

std::vector<std::string> readBagRecords(const std::string& path, const RawMessageVisitor& visit) {
  return RecordReader(path, visit).run();
}

}  // namespace collision_pairs
