#include "live_monitor.h"

#include <ros/console.h>

namespace collision_pairs {
namespace {

constexpr std::uint32_t QUEUE_SIZE = 100;  // messages, as in tf2_ros

}  // namespace

void LiveMonitor::subscribe(const ros::NodeHandle& node, const std::function<void()>& taken) {
  using Event = ros::MessageEvent<const tf2_msgs::TFMessage>;
  ros::NodeHandle own_queue(node);
  own_queue.setCallbackQueue(&queue_);
  const auto subscribe_to = [&](const char* topic, bool is_static) {
    const boost::function<void(const Event&)> callback = [=](const Event& event) {
      with([&](Monitor& monitor) {
        monitor.take(*event.getConstMessage(), is_static, event.getPublisherName());
      });
      ++nb_taken_;
      if (taken) taken();
    };
    ros::SubscribeOptions options;
    options.initByFullCallbackType<const Event&>(topic, QUEUE_SIZE, callback);
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    return own_queue.subscribe(options);
  };
  subscriber_ = subscribe_to("/tf", false);
  static_subscriber_ = subscribe_to("/tf_static", true);
  spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
  spinner_->start();
}

ros::Time LiveMonitor::advance() {
  const unsigned nb_jumps = monitor_.transforms().nbClockJumps();
  const ros::Time now = ros::Time::now();
  monitor_.advance({now, ros::SteadyTime::now().toSec()});
  return monitor_.transforms().nbClockJumps() == nb_jumps ? ros::Time() : now;
}

LiveMonitor::Jump::~Jump() {
  if (to.isZero()) return;
  ROS_INFO_STREAM("the clock went back to " << to << " s: earlier transforms are discarded");
}

}  // namespace collision_pairs
