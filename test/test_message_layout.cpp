// Serialized messages in which anything may stand: too short ones are refused before roscpp reads
// them.
#include <gtest/gtest.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/Marker.h>

#include "message_layout.h"
#include "random_inputs.h"

namespace collision_pairs::test_message_layout {

template <class Message>
std::vector<std::uint8_t> bytesOf(const Message& message) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

template <class Message>
bool isRead(std::vector<std::uint8_t> bytes) {
  bytes.reserve(bytes.size() + 1);  // data() of none
  return readMessage<Message>(bytes.data(), static_cast<std::uint32_t>(bytes.size())).has_value();
}

/// Each beginning of it is refused, and every four bytes that claim two billion of something are
/// either refused or no length.
template <class Message>
void expectOnlyTheWhole(const Message& message) {
  const std::vector<std::uint8_t> whole = bytesOf(message);
  std::vector<std::uint8_t> copy = whole;
  const auto read = readMessage<Message>(copy.data(), static_cast<std::uint32_t>(copy.size()));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(bytesOf(*read), whole);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(isRead<Message>({whole.begin(), whole.begin() + size})) << size;
  }
  int nb_refused = 0;
  for (std::size_t at = 0; at + 4 <= whole.size(); ++at) {
    copy = whole;
    std::fill_n(copy.begin() + at, 4, std::uint8_t{0x7f});
    nb_refused += !isRead<Message>(copy);
  }
  EXPECT_GT(nb_refused, 0);
}

std::string anyText(RandomInputs& random) {
  return std::string(static_cast<std::size_t>(random.integer(0, 9)), 'x');
}

TEST(MessageLayout, ATruncatedMessageAndLengthsThatLieAreRefused) {
  RandomInputs random;
  for (int i = 0; i < 10; ++i) {
    tf2_msgs::TFMessage transforms;
    sensor_msgs::JointState joints;
    sensor_msgs::PointCloud2 cloud;
    visualization_msgs::Marker marker;  // nested arrays, times, durations, colours
    std_msgs::String text;
    text.data = anyText(random);
    transforms.transforms.resize(static_cast<std::size_t>(random.integer(0, 3)));
    for (auto& transform : transforms.transforms) transform.child_frame_id = anyText(random);
    joints.header.frame_id = anyText(random);
    joints.name.assign(static_cast<std::size_t>(random.integer(0, 3)), anyText(random));
    joints.effort.resize(static_cast<std::size_t>(random.integer(0, 3)));
    cloud.fields.resize(static_cast<std::size_t>(random.integer(0, 3)));
    for (auto& field : cloud.fields) field.name = anyText(random);
    cloud.data.resize(static_cast<std::size_t>(random.integer(0, 30)));
    marker.points.resize(static_cast<std::size_t>(random.integer(0, 3)));
    marker.colors.resize(static_cast<std::size_t>(random.integer(0, 3)));
    marker.text = anyText(random);
    expectOnlyTheWhole(transforms);
    expectOnlyTheWhole(joints);
    expectOnlyTheWhole(cloud);
    expectOnlyTheWhole(marker);
    expectOnlyTheWhole(text);
  }
}

}  // namespace collision_pairs::test_message_layout
