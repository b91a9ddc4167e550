#include "message_layout.h"

#include <cstring>
#include <sstream>

namespace collision_pairs {
namespace {

/// Bytes; 0: a string. End: it is a message.
const std::map<std::string, std::uint64_t> BUILT_IN = {
    {"bool", 1},    {"byte", 1},  {"char", 1},     {"int8", 1},   {"uint8", 1},  {"int16", 2},
    {"uint16", 2},  {"int32", 4}, {"uint32", 4},   {"int64", 8},  {"uint64", 8}, {"float32", 4},
    {"float64", 8}, {"time", 8},  {"duration", 8}, {"string", 0},
};

}  // namespace

MessageLayout::MessageLayout(const std::string& type, const std::string& definition) : type_(type) {
  std::string current = type, line;
  for (std::istringstream lines(definition); std::getline(lines, line);) {
    const std::string begins_next = "MSG: ";
    if (line.compare(0, begins_next.size(), begins_next) == 0) {
      current = line.substr(begins_next.size());
      current.erase(current.find_last_not_of(" \r") + 1);
    } else {
      parse(current.substr(0, current.find('/')), line, fields_[current]);
    }
  }
}

void MessageLayout::parse(const std::string& package, const std::string& line, Fields& fields) {
  std::string type, name;
  std::istringstream words(line.substr(0, line.find('#')));
  if (!(words >> type >> name)) return;  // blank, or a row of ====
  if (line.substr(0, line.find('#')).find('=') != std::string::npos) return;  // a constant
  Field field{"", 0, false, 1};
  const std::size_t bracket = type.find('[');
  if (bracket != std::string::npos) {
    const std::string count = type.substr(bracket + 1, type.size() - bracket - 2);
    field.has_count = count.empty();
    if (!count.empty()) field.nb_fixed = static_cast<std::uint32_t>(std::stoul(count));
    type.erase(bracket);
  }
  const auto built_in = BUILT_IN.find(type);
  if (built_in != BUILT_IN.end()) {
    field.size = built_in->second;
  } else if (type == "Header") {
    field.type = "std_msgs/Header";
  } else {
    field.type = type.find('/') == std::string::npos ? package + "/" + type : type;
  }
  fields.push_back(field);
}

class MessageLayout::Walk {
 public:
  Walk(const MessageLayout& layout, const std::uint8_t* data, std::uint32_t size)
      : layout_(layout), data_(data), left_(size) {}

  bool pass(const std::string& type) {
    for (const Field& field : layout_.fields_.at(type)) {
      if (!pass(field)) return false;
    }
    return true;
  }

 private:
  bool pass(const Field& field) {
    std::uint32_t count = field.nb_fixed;
    if (field.has_count && (!read(count) || count > left_)) return false;  // no entry is empty
    if (field.type.empty() && field.size > 0) return skip(count * field.size);
    for (std::uint32_t i = 0; i < count; ++i) {
      std::uint32_t length = 0;
      const bool is_whole = field.type.empty() ? read(length) && skip(length) : pass(field.type);
      if (!is_whole) return false;
    }
    return true;
  }
  bool read(std::uint32_t& number) {
    if (left_ < sizeof number) return false;
    std::memcpy(&number, data_, sizeof number);  // little-endian, like all platforms of ROS
    return skip(sizeof number);
  }
  bool skip(std::uint64_t bytes) {
    if (bytes > left_) return false;
    data_ += bytes;
    left_ -= bytes;
    return true;
  }

  const MessageLayout& layout_;
  const std::uint8_t* data_;
  std::uint64_t left_;
};

bool MessageLayout::fits(const std::uint8_t* data, std::uint32_t size) const {
  return Walk(*this, data, size).pass(type_);
}

}  // namespace collision_pairs
