// Reads serialized messages from files, in which anything may stand.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <ros/message_traits.h>
#include <ros/serialization.h>

namespace collision_pairs {

/// The layout of a message, from its definition.
class MessageLayout {
 public:
  /// `type` as in "tf2_msgs/TFMessage", with the definition that roscpp has of it.
  MessageLayout(const std::string& type, const std::string& definition);

  /// Whether the message is as long as the lengths in it require. O(size).
  ///
  /// roscpp allocates as many array entries as a message claims before it checks that they exist:
  /// four wrong bytes can request gigabytes. Messages from files are therefore checked first.
  bool fits(const std::uint8_t* data, std::uint32_t size) const;

 private:
  struct Field {
    std::string type;        ///< of a message; empty: of a built-in type
    std::uint64_t size;      ///< bytes of a built-in type; 0: a string
    bool has_count;          ///< an array whose length precedes it
    std::uint32_t nb_fixed;  ///< entries, otherwise
  };
  using Fields = std::vector<Field>;
  class Walk;

  void parse(const std::string& package, const std::string& line, Fields& fields);

  std::string type_;
  std::map<std::string, Fields> fields_;  ///< by type
};

/// Nothing if it is not such a message.
template <class Message>
std::optional<Message> readMessage(std::uint8_t* data, std::uint32_t size) {
  static const MessageLayout LAYOUT(ros::message_traits::datatype<Message>(),
                                    ros::message_traits::definition<Message>());
  if (!LAYOUT.fits(data, size)) return std::nullopt;
  std::optional<Message> message(std::in_place);
  try {
    ros::serialization::IStream stream(data, size);
    ros::serialization::deserialize(stream, *message);
  } catch (const ros::Exception&) {
    return std::nullopt;
  }
  return message;
}

}  // namespace collision_pairs
