#include "cloud_threads.h"

#include <algorithm>
#include <chrono>
#include <tuple>
#include <utility>

#include <ros/console.h>

#include "point_cloud.h"

namespace collision_pairs {
namespace {

constexpr std::uint32_t CLOUDS_WAITING = 2;  // messages waiting for the callback
const std::chrono::milliseconds PAUSE(1);    // between two looks whether its transforms are there
const ros::WallDuration TELL_PERIOD(5.0);    // between two warnings in the log

}  // namespace

CloudThread::CloudThread(const ros::NodeHandle& node, std::shared_ptr<CloudSource> source,
                         LiveMonitor& monitor, ros::Publisher filtered_cloud)
    : monitor_(monitor),
      topic_(source->config().topic),
      source_(std::move(source)),
      filtered_cloud_(std::move(filtered_cloud)),
      spinner_(1, &queue_) {
  ros::NodeHandle own_queue(node);
  own_queue.setCallbackQueue(&queue_);
  using Event = ros::MessageEvent<const CloudSource::Cloud>;
  const boost::function<void(const Event&)> callback = [this](const Event& event) {
    monitor_.with(
        [&](Monitor&) { source_->take(event.getConstMessage(), event.getPublisherName()); });
    const std::lock_guard<std::mutex> lock(mutex_);
    has_arrived_ = true;
    wakes_worker_.notify_all();
  };
  try {
    subscriber_ = own_queue.subscribe<CloudSource::Cloud, const Event&>(
        topic_, CLOUDS_WAITING, callback, nullptr, ros::TransportHints().tcpNoDelay());
  } catch (const ros::Exception& error) {  // this process knows the topic by another type
    monitor_.with([&](Monitor&) {
      source_->refuse("its topic cannot be subscribed to: " + std::string(error.what()));
    });
    tell();
  }
  worker_ = std::thread([this] { work(); });
  spinner_.start();
}

CloudThread::~CloudThread() {
  spinner_.stop();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wakes_worker_.notify_all();
  worker_.join();
}

void CloudThread::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    wakes_worker_.wait(lock, [this] { return stopping_ || has_arrived_; });
    has_arrived_ = false;
    lock.unlock();
    const bool goes_on = workOnce();
    lock.lock();
    has_arrived_ |= goes_on;
  }
}

bool CloudThread::workOnce() {
  bool is_waiting = false;
  std::shared_ptr<CloudSource> source;
  const std::shared_ptr<CloudJob> job = monitor_.with([&](Monitor&) {
    source = source_;
    auto next = source->next();
    is_waiting = source->isWaiting();
    return next;
  });
  try {
    if (job) {
      job->run();
      const bool is_wanted = filtered_cloud_.getNumSubscribers() > 0 && job->isUsed();
      if (is_wanted) filtered_cloud_.publish(toPointCloud2(job->kept(), job->header()));
      monitor_.with([&](Monitor&) { source->take(*job); });
    } else if (is_waiting) {
      std::this_thread::sleep_for(PAUSE);
    }
  } catch (const std::exception& error) {
    monitor_.with([&](Monitor&) { source->refuse(error.what()); });
  }
  tell();
  return job || is_waiting;
}

void CloudThread::tell() {
  const auto [note, name] = monitor_.with(
      [&](Monitor&) { return std::pair(source_->takeNote(), source_->config().name()); });
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (note.empty() || now < next_telling_) return;
  next_telling_ = now + TELL_PERIOD;
  ROS_WARN_STREAM("cloud '" << name << "': " << note);
}

void CloudThreads::follow() {
  const ActiveScenePtr scene = monitor_.activeScene();
  const auto& wanted = scene->clouds;
  const bool are_same = std::equal(threads_.begin(), threads_.end(), wanted.begin(), wanted.end(),
                                   [](const auto& thread, const auto& source) {
                                     return thread->topic() == source->config().topic;
                                   });
  if (are_same) {
    for (std::size_t i = 0; i < wanted.size(); ++i) threads_[i]->follow(wanted[i]);
    return;
  }
  ros::Publisher filtered;
  if (!wanted.empty()) {
    filtered = private_node_.advertise<sensor_msgs::PointCloud2>(
        "filtered_cloud", static_cast<std::uint32_t>(wanted.size()));
  }
  std::vector<std::unique_ptr<CloudThread>> threads;  // the old ones end without the lock
  for (const auto& source : wanted) {
    threads.push_back(std::make_unique<CloudThread>(node_, source, monitor_, filtered));
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  std::swap(threads_, threads);
}

bool CloudThreads::isEmpty() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return threads_.empty();
}

void CloudThreads::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  using diagnostic_msgs::DiagnosticStatus;
  status.summary(DiagnosticStatus::OK, "all clouds are fresh");
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& thread : threads_) {
    const auto [name, view, health] = monitor_.with([&](Monitor&) {
      const CloudSource& source = *thread->source();
      return std::tuple(source.config().name() + " ", source.view(), source.health());
    });
    for (const std::string* words : {&view.problem, &view.warning}) {
      if (!words->empty()) status.mergeSummary(DiagnosticStatus::WARN, *words);
    }
    status.add(name + "problem", view.problem.empty() ? view.warning : view.problem);
    status.add(name + "rate [Hz]", health.rate);
    status.add(name + "latency [s]", health.latency);
    status.add(name + "processing [s]", health.processing);
    status.add(name + "points", health.points);
    status.add(name + "points kept", health.kept);
    status.add(name + "voxels", health.voxels);
    status.add(name + "received", health.received);
    status.add(name + "used", health.used);
    status.add(name + "dropped", health.dropped);
    status.add(name + "refused", health.refused);
  }
}

}  // namespace collision_pairs
