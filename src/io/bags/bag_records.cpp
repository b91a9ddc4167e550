#include "bag_records.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

const std::string ANY_MAGIC = "#ROS";  // formats before 2.0 begin with #ROSLOG or #ROSRECORD
const std::string MAGIC = "#ROSBAG V2.0\n";
constexpr std::uint32_t LONGEST_HEADER = 1 << 20;  // bytes; rosbag writes some hundred

enum Op { MESSAGE = 2, BAG_HEADER = 3, INDEX = 4, CHUNK = 5, CHUNK_INFO = 6, CONNECTION = 7 };

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

/// Nanoseconds.
std::int64_t toTime(const char* bytes) {
  return std::int64_t{toNumber(bytes)} * 1000000000 + toNumber(bytes + 4);
}

std::uint32_t numberIn(const Fields& fields, const std::string& name, std::size_t offset = 0) {
  const auto found = fields.find(name);
  return found == fields.end() || found->second.size() < offset + 4
             ? 0
             : toNumber(found->second.data() + offset);
}

/// Its op; -1 if that is unknown, or a field that belongs to it is missing.
int opOf(const Fields& fields) {
  struct Field {
    const char* name;
    std::size_t least, most;  // bytes
  };
  constexpr std::size_t ANY = LONGEST_HEADER;
  static const std::map<int, std::vector<Field>> OPS = {
      {MESSAGE, {{"conn", 4, 4}, {"time", 8, 8}}},
      {BAG_HEADER, {{"index_pos", 8, 8}}},
      {INDEX, {{"conn", 4, 4}, {"count", 4, 4}}},
      {CHUNK, {{"compression", 1, ANY}, {"size", 4, 4}}},
      {CHUNK_INFO, {{"chunk_pos", 8, 8}}},
      {CONNECTION, {{"conn", 4, 4}, {"topic", 1, ANY}}},
  };
  const auto op = fields.find("op");
  const auto known =
      op == fields.end() || op->second.size() != 1 ? OPS.end() : OPS.find(op->second[0]);
  if (known == OPS.end()) return -1;
  for (const Field& field : known->second) {
    const auto found = fields.find(field.name);
    if (found == fields.end()) return -1;
    if (found->second.size() < field.least || found->second.size() > field.most) return -1;
  }
  return known->first;
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

class RecordReader {
 public:
  RecordReader(const std::string& path, const RawMessageVisitor& visit)
      : path_(path), file_(path, std::ios::binary), visit_(visit) {}

  BagRecords run() {
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
    losses_.insert(losses_.end(), anywhere_.begin(), anywhere_.end());
    BagRecords records{std::move(losses_), {}};
    for (const auto& [number, connection] : connections_) records.connections.push_back(connection);
    return records;
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
    if (!take(fields, data, place)) {
      lose("the record at byte " + std::to_string(place) + " is not understood");
      chunk_.is_whole = false;  // it may have been the chunk of the indices that follow
    }
    if (!whole)
      lose("the file is truncated within the record that begins at byte " + std::to_string(place));
    return whole;
  }

  bool take(const Fields& fields, std::string& data, std::uint64_t place) {
    switch (opOf(fields)) {
      case CHUNK:
        takeChunk(fields, data, place);
        return true;
      case CONNECTION:
        return takeConnection(fields, data.data(), data.size());
      case MESSAGE:
        return takeMessage(fields, data.data(), static_cast<std::uint32_t>(data.size()));
      case INDEX:
        return compareWithIndex(fields, data);
      case BAG_HEADER:
        refuseEncrypted(fields);
        if (numberIn(fields, "index_pos") == 0 && numberIn(fields, "index_pos", 4) == 0) {
          lose("it has no index: its recording was not closed");
        }
        return true;
      case CHUNK_INFO:
        return true;
      default:
        return false;
    }
  }

  void refuseEncrypted(const Fields& fields) const {
    const auto encryptor = fields.find("encryptor");
    if (encryptor == fields.end() || encryptor->second.empty()) return;
    throw InputError(path_ + ": is encrypted with " + encryptor->second +
                     "; decrypt it with rosbag decrypt");
  }

  void takeChunk(const Fields& fields, const std::string& data, std::uint64_t place) {
    chunk_ = {place, false, {}};
    std::string content;
    const bool whole =
        decompressChunk(fields.at("compression"), data, numberIn(fields, "size"), content);
    chunk_.is_whole = readRecordsIn(content) && whole;
    if (chunk_.is_whole) return;
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
      const int op = opOf(fields);
      const bool is_known = op == CONNECTION
                                ? takeConnection(fields, &content[at], size)
                                : op == MESSAGE && takeMessage(fields, &content[at], size);
      if (!is_known)
        lose("a record in the chunk at byte " + std::to_string(chunk_.place) +
             " is not understood");
      at += size;
    }
    return true;
  }

  bool takeConnection(const Fields& fields, const char* data, std::size_t size) {
    Fields header = parseFields(data, size);
    if (header["type"].empty()) return false;
    const BagConnection made{fields.at("topic"), header["type"], header["md5sum"],
                             header["callerid"]};
    const auto& known = connections_.emplace(numberIn(fields, "conn"), made).first->second;
    // Each chunk has it, and the index: one of them is damaged.
    if (!(known == made)) {
      loseAnywhere("connection " + std::to_string(numberIn(fields, "conn")) +
                   " is described in two ways");
    }
    return true;
  }

  bool takeMessage(const Fields& fields, char* data, std::uint32_t size) {
    const auto found = connections_.find(numberIn(fields, "conn"));
    if (found == connections_.end()) return false;
    const BagConnection& from = found->second;
    last_ = toTime(fields.at("time").data());
    for (; nb_ended_ < losses_.size(); ++nb_ended_) losses_[nb_ended_].before = last_;
    chunk_.times[found->first].insert(last_);
    visit_({from.topic, from.type, from.md5sum, from.publisher, last_,
            reinterpret_cast<std::uint8_t*>(data), size});
    return true;
  }

  /// It follows its chunk: the times of the messages of one connection.
  bool compareWithIndex(const Fields& fields, const std::string& data) {
    constexpr std::size_t ENTRY = 12;  // bytes: time and place
    if (data.size() != ENTRY * numberIn(fields, "count")) return false;
    std::multiset<std::int64_t>& found = chunk_.times[numberIn(fields, "conn")];
    std::size_t nb_missing = 0;
    for (std::size_t at = 0; at < data.size(); at += ENTRY) {
      const auto message = found.find(toTime(&data[at]));
      if (message == found.end()) {
        ++nb_missing;
      } else {
        found.erase(message);
      }
    }
    if (nb_missing > 0 && chunk_.is_whole) {
      loseAnywhere(std::to_string(nb_missing) + " messages that the index of the chunk at byte " +
                   std::to_string(chunk_.place) + " lists are not in it");
    }
    return true;
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
    losses_.push_back({what, last_});
    return false;
  }
  /// Messages may have a wrong time or connection.
  void loseAnywhere(const std::string& what) { anywhere_.push_back({what}); }

  const std::string& path_;
  std::ifstream file_;
  const RawMessageVisitor& visit_;
  std::map<std::uint32_t, BagConnection> connections_;
  std::vector<BagLoss> losses_, anywhere_;
  std::size_t nb_ended_ = 0;  ///< losses that a message has followed
  std::int64_t last_ = std::numeric_limits<std::int64_t>::min();  ///< message that was read
  struct {
    std::uint64_t place = 0;
    bool is_whole = false;
    std::map<std::uint32_t, std::multiset<std::int64_t>> times;  ///< of messages, by connection
  } chunk_;                                                      ///< the last
};

}  // namespace

bool BagConnection::operator==(const BagConnection& other) const {
  return topic == other.topic && type == other.type && md5sum == other.md5sum &&
         publisher == other.publisher;
}

BagRecords readBagRecords(const std::string& path, const RawMessageVisitor& visit) {
  return RecordReader(path, visit).run();
}

}  // namespace collision_pairs
