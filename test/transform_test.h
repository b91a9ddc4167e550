// Transforms received by a TransformInput, without a master.
#pragma once

#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "refusal.h"
#include "transform_input.h"

namespace collision_pairs {

inline tf2_msgs::TFMessage linkAt(const std::string& child, const ros::Time& stamp, double x) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  auto& transform = message.transforms[0];
  transform.header.stamp = stamp;
  transform.header.frame_id = "root";
  transform.child_frame_id = child;
  transform.transform.translation.x = x;
  transform.transform.rotation.w = 1.0;
  return message;
}

class Transforms : public testing::Test {
 protected:
  void SetUp() override { ros::Time::init(); }

  void receive(const std::string& child, double stamp, double x) {
    input_.take(linkAt(child, ros::Time(stamp), x), false, now_);
  }
  /// By another publisher.
  void receiveBy(const std::string& publisher, const std::string& child, double stamp, double x,
                 bool is_static = false) {
    input_.take(linkAt(child, ros::Time(stamp), x), is_static, now_, publisher);
  }
  double newestOf(const std::string& child) const {
    return input_.lookUp("root", child, ros::Time(0)).X_TS.translation().x();
  }
  bool knows(const std::string& child, ros::Time stamp = ros::Time(0)) const {
    return refusal([&] { input_.lookUp("root", child, stamp); }) == "accepted";
  }
  std::string whyNot(const std::string& child) const {
    return refusal([&] { input_.lookUp("root", child, ros::Time(0)); });
  }
  /// Once for each 20 ms, as the clock goes on.
  void play(double begin, double end, const std::function<void()>& publish) {
    for (double t = begin; t < end; t += 0.02) {
      now_ = ros::Time(t);
      publish();
      input_.followClock(now_);
    }
  }

  TransformInput input_;
  ros::Time now_{1000.0};
};

}  // namespace collision_pairs
