// The topics of point clouds.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <sensor_msgs/PointCloud2.h>

#include "live_monitor.h"

namespace collision_pairs {

/// Receives the clouds of one source on one thread and computes their voxels on another, so that
/// neither the cycle nor the subscription ever waits.
class CloudThread {
 public:
  CloudThread(const ros::NodeHandle& node, std::shared_ptr<CloudSource> source,
              LiveMonitor& monitor, ros::Publisher filtered_cloud);
  ~CloudThread();

  /// Another source of the same topic: no cloud is lost in between.
  void follow(const std::shared_ptr<CloudSource>& source) {
    auto old = source;  // destroyed without the lock
    monitor_.with([&](Monitor&) { std::swap(source_, old); });
  }
  const std::string& topic() const { return topic_; }
  /// To be used under the lock of the monitor.
  const std::shared_ptr<CloudSource>& source() const { return source_; }

 private:
  void work();
  /// False: there is nothing to do.
  bool workOnce();
  void tell();

  LiveMonitor& monitor_;
  const std::string topic_;
  std::shared_ptr<CloudSource> source_;  // under the lock of the monitor
  const ros::Publisher filtered_cloud_;
  ros::SteadyTime next_telling_;

  std::mutex mutex_;  // guards what follows
  std::condition_variable wakes_worker_;
  bool stopping_ = false, has_arrived_ = false;

  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_;
  std::thread worker_;
  ros::AsyncSpinner spinner_;  // last: stops before the members it uses are destroyed
};

/// Of all sources of the monitor's scene. Thread safe.
class CloudThreads {
 public:
  /// Topics are names relative to `node`; the kept points are published on ~filtered_cloud.
  CloudThreads(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
               LiveMonitor& monitor)
      : node_(node), private_node_(private_node), monitor_(monitor) {}

  /// Subscribes to the sources of the active scene, and to no others. Not from two threads at a
  /// time; the others never wait for it.
  void follow();
  bool isEmpty() const;
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  ros::NodeHandle node_, private_node_;
  LiveMonitor& monitor_;
  mutable std::mutex mutex_;  // guards threads_
  std::vector<std::unique_ptr<CloudThread>> threads_;
};

}  // namespace collision_pairs
