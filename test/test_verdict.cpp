// FREE is never said of what was not checked: random robots, poses and faults of TF, beside an
// oracle that knows what was published and has plain spheres.
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "monitored_robot.h"

namespace collision_pairs::test_verdict {

constexpr double RADIUS = 0.5;
const PoseLimits LIMITS;  // the defaults

using LinkPair = std::pair<std::string, std::string>;

/// What a link was published at, where that was sound: seconds to x.
using History = std::map<double, double>;

/// x at a time within the history, by straight lines between what was published.
double at(const History& history, double time) {
  const auto after = history.lower_bound(time);
  if (after->first == time || after == history.begin()) return after->second;
  const auto before = std::prev(after);
  const double part = (time - before->first) / (after->first - before->first);
  return before->second + part * (after->second - before->second);
}

class Faults {
 public:
  explicit Faults(unsigned seed) : random_(seed) {
    const int nb_links = 2 + static_cast<int>(random_() % 4);
    std::string urdf = "<robot name='r'><link name='root'/>";
    Srdf srdf;
    for (int i = 0; i < nb_links; ++i) {
      links_.push_back(std::string(1, static_cast<char>('a' + i)));
      urdf += "<link name='" + links_[i] + "'><collision><geometry><sphere radius='" +
              std::to_string(RADIUS) + "'/></geometry></collision></link><joint name='j" +
              links_[i] + "' type='floating'><parent link='root'/><child link='" + links_[i] +
              "'/></joint>";
      for (int j = 0; j < i; ++j) {
        if (random_() % 4 == 0) {
          srdf.disabled_pairs.emplace_back(links_[j], links_[i]);
        } else {
          required_.insert({links_[j], links_[i]});
        }
      }
      x_[links_[i]] = 2.0 * i;
    }
    SceneParameters parameters;
    parameters.sources.robots.push_back(
        {std::make_unique<RobotSource>(urdf + "</robot>", noMeshes), srdf, ""});
    load(monitor_, std::move(parameters));
    faulty_ = links_[random_() % links_.size()];
    fault_ = static_cast<int>(random_() % 8);
    detector_ = std::make_unique<CollisionDetector>(monitor_.scenes().active()->scene);
  }

  /// A fiftieth of a second: links move, publish or fail to; the next report.
  CollisionReport step() {
    now_ += 0.02;
    if (random_() % 40 == 0) faulty_ = links_[random_() % links_.size()];
    if (random_() % 40 == 0) fault_ = static_cast<int>(random_() % 8);
    if (random_() % 200 == 0) silent_steps_ = static_cast<int>(random_() % 150);
    for (const std::string& link : links_) {
      x_[link] += std::uniform_real_distribution<double>(-0.1, 0.1)(random_);
      if (silent_steps_ == 0) publish(link, link == faulty_ ? fault_ : 0);
    }
    silent_steps_ = std::max(0, silent_steps_ - 1);
    monitor_.advance(ros::Time(now_));
    const Snapshot snapshot = monitor_.at(monitor_.scenes().active());
    time_ = snapshot.stamp.toSec();
    return detector_->detect(snapshot.poses, CheckSettings());
  }

  /// Is every required pair known to be apart at the instant of the report?
  ::testing::AssertionResult isTrulyFree() const {
    const double time = time_;
    for (const auto& [a, b] : required_) {
      for (const std::string& link : {a, b}) {
        const auto known = published_.find(link);
        if (known == published_.end()) return ::testing::AssertionFailure() << link << " unknown";
        const double newest = known->second.rbegin()->first;
        if (newest < time - 1e-6) return ::testing::AssertionFailure() << link << " not then";
        if (now_ - time > LIMITS.max_pose_age + 1e-6) {
          return ::testing::AssertionFailure() << link << " too old";
        }
      }
      const double gap = std::abs(at(published_.at(a), time) - at(published_.at(b), time));
      if (gap < 2.0 * RADIUS - 1e-6) return ::testing::AssertionFailure() << a << " meets " << b;
    }
    return ::testing::AssertionSuccess();
  }

  bool isTrulyInContact() const {
    const double time = time_;
    for (const auto& [a, b] : required_) {
      if (!published_.count(a) || !published_.count(b)) continue;
      if (published_.at(a).rbegin()->first < time - 1e-6) continue;
      if (published_.at(b).rbegin()->first < time - 1e-6) continue;
      const double gap = std::abs(at(published_.at(a), time) - at(published_.at(b), time));
      if (gap < 2.0 * RADIUS + 1e-6) return true;
    }
    return false;
  }

 private:
  void publish(const std::string& link, int fault) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    auto& transform = message.transforms[0];
    transform.header.frame_id = "root";
    transform.child_frame_id = link;
    transform.transform.rotation.w = 1.0;
    transform.transform.translation.x = x_[link];
    double stamp = now_;
    const double elsewhere = 1000.0;  // where it would be free
    if (fault == 1) return;           // silent
    if (fault == 2) stamp = now_ + 3600.0;
    if (fault == 3) stamp = now_ + 2.0;
    if (fault == 4) stamp = 0.0;
    if (fault == 5) stamp = now_ - 100.0;
    if (fault == 6) transform.transform.rotation.w = std::nan("");
    if (fault == 7) transform.transform.translation.x = std::nan("");
    if (fault > 1 && fault < 6) transform.transform.translation.x = elsewhere;
    transform.header.stamp = ros::Time(stamp);
    monitor_.advance(ros::Time(now_));
    monitor_.take(message, false, "");
    if (fault == 0) published_[link][transform.header.stamp.toSec()] = x_[link];
  }

  std::mt19937 random_;
  double now_ = 10000.0;
  std::vector<std::string> links_;
  std::set<LinkPair> required_;
  std::map<std::string, double> x_;
  std::map<std::string, History> published_;
  std::string faulty_;
  int fault_ = 0;
  int silent_steps_ = 0;  // of all publishers
  Monitor monitor_{TransformSettings{LIMITS}};
  double time_ = 0.0;  // of the last report
  std::unique_ptr<CollisionDetector> detector_;
};

TEST(Verdict, FreeImpliesThatEveryRequiredPairIsKnownFreshAndApart) {
  ros::Time::init();
  const unsigned seed = std::random_device()();
  RecordProperty("seed", std::to_string(seed));
  std::printf("seed %u\n", seed);
  std::map<int, int> count;
  for (unsigned robot = 0; robot < 100; ++robot) {
    Faults faults(seed + robot);
    for (int i = 0; i < 500; ++i) {
      const CollisionReport report = faults.step();
      ++count[static_cast<int>(report.verdict)];
      ASSERT_EQ(report.in_collision, report.verdict != Verdict::FREE);
      ASSERT_EQ(report.unknown_because.empty(), report.verdict != Verdict::UNKNOWN);
      if (report.verdict == Verdict::FREE) {
        ASSERT_TRUE(faults.isTrulyFree()) << "robot " << robot << " step " << i;
      }
      if (report.verdict == Verdict::COLLISION) {
        ASSERT_TRUE(faults.isTrulyInContact()) << "robot " << robot << " step " << i;
      }
    }
  }
  for (const int verdict : {0, 1, 2}) EXPECT_GT(count[verdict], 1000) << verdict;
}

}  // namespace collision_pairs::test_verdict
