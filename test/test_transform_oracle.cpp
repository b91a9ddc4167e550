// Random forests of frames by many publishers, some of which are late, silent or lie, against an
// oracle that knows where every frame really is and who has said what when. It keeps no transforms:
// it is made of the true motions and of the list of arrivals alone.
#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>

#include <gtest/gtest.h>

#include "frame_ways.h"
#include "random_inputs.h"

namespace collision_pairs::test_transform_oracle {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double START = 1000.0, END = 1012.0;  // s
const PoseLimits LIMITS{1.0, 0.5, 0.25};

StampNs at(double seconds) { return static_cast<StampNs>(std::llround(seconds * 1e9)); }

/// Moves along a line and turns about an axis, both at constant speed: between two of its poses
/// interpolation is exact.
struct Motion {
  Isometry3d X_start = Isometry3d::Identity();
  Vector3d velocity = Vector3d::Zero(), axis = Vector3d::UnitX();
  double rate = 0.0;  // rad/s
  Isometry3d at(double t) const {
    Isometry3d X = X_start;
    X.translation() += (t - START) * velocity;
    X.linear() = X_start.linear() * Eigen::AngleAxisd(rate * (t - START), axis).toRotationMatrix();
    return X;
  }
};

struct Frame {
  int parent = -1;
  bool is_static = false;
  Motion motion;
  double last_lie = -1e9;    // arrival
  double last_truth = -1e9;  // arrival
};

struct Arrival {
  double now, stamp;
  int frame;
  bool is_lie;
  std::string publisher;
};

class RandomForest {
 public:
  explicit RandomForest(unsigned seed) : random_(seed) {
    const int nb_frames = random_.integer(3, 12);
    for (int f = 0; f < nb_frames; ++f) {
      Frame frame;
      if (random_.integer(0, 6) > 0) frame.parent = random_.integer(0, nb_frames - 1);
      if (frame.parent == f) frame.parent = -1;  // others may form cycles
      frame.is_static = random_.integer(0, 3) == 0;
      frame.motion.X_start = random_.pose(1.0);
      if (!frame.is_static) {
        frame.motion.velocity = random_.vector(-0.5, 0.5);
        frame.motion.axis = random_.vector(-1.0, 1.0).normalized();
        frame.motion.rate = random_.uniform(-0.5, 0.5);
      }
      frames_.push_back(frame);
      if (frame.parent >= 0) publish(f);
    }
    std::stable_sort(arrivals_.begin(), arrivals_.end(),
                     [](const Arrival& a, const Arrival& b) { return a.now < b.now; });
  }

  std::vector<Frame>& frames() { return frames_; }
  const std::vector<Frame>& frames() const { return frames_; }
  const std::vector<Arrival>& arrivals() const { return arrivals_; }
  RandomInputs& random() { return random_; }
  static std::string nameOf(int frame) { return "f" + std::to_string(frame); }

  /// None where a walk up has no end, or does not end at the same root.
  std::optional<Isometry3d> truth(int target, int source, double t) const {
    Isometry3d X_RT, X_RS;
    const int root = rootOf(target, t, X_RT);
    if (root < 0 || root != rootOf(source, t, X_RS)) return std::nullopt;
    return X_RT.inverse() * X_RS;
  }
  bool isInRing(int frame) const {
    Isometry3d X;
    return rootOf(frame, START, X) < 0;
  }
  /// The frames above this one, and itself.
  std::vector<int> wayUp(int frame) const {
    std::vector<int> way;
    for (; frame >= 0 && way.size() <= frames_.size(); frame = frames_[frame].parent) {
      way.push_back(frame);
    }
    return way;
  }

 private:
  int rootOf(int frame, double t, Isometry3d& X_RF) const {
    X_RF.setIdentity();
    for (std::size_t i = 0; i <= frames_.size(); ++i) {
      if (frames_[frame].parent < 0) return frame;
      X_RF = frames_[frame].motion.at(t) * X_RF;
      frame = frames_[frame].parent;
    }
    return -1;
  }

  void publish(int f) {
    if (frames_[f].is_static) {
      arrivals_.push_back({START + random_.uniform(0.0, 0.1), START, f, false, "/static"});
      return;
    }
    const int nb_honest = random_.integer(1, 3);
    for (int p = 0; p < nb_honest; ++p) send(f, "/honest" + std::to_string(p), false, START, END);
    if (random_.integer(0, 2) > 0) return;
    const double begin = random_.uniform(START + 2.0, END - 4.0);
    send(f, "/liar", true, begin, begin + random_.uniform(0.0, 1.5));
  }

  /// Between 10 and 40 Hz, some samples late and so out of order, some lost, and now and then
  /// silence.
  void send(int f, const std::string& by, bool is_lie, double begin, double end) {
    const double period = random_.uniform(0.025, 0.1), latency = random_.uniform(0.0, 0.1);
    for (double t = begin; t < end; t += period) {
      if (random_.integer(0, 150) == 0 && t < END - 5.0) t += random_.uniform(0.1, 2.0);
      if (random_.integer(0, 20) == 0) continue;
      const double late = random_.integer(0, 30) == 0 ? random_.uniform(0.0, 0.9) : latency;
      arrivals_.push_back({t + late, t, f, is_lie, by});
    }
  }

  RandomInputs random_;
  std::vector<Frame> frames_;
  std::vector<Arrival> arrivals_;
};

struct Counts {
  long known = 0, unknown = 0, lies = 0, back = 0;
};

class Oracle {
 public:
  Oracle(unsigned seed, Counts& counts) : forest_(seed), buffer_(LIMITS), counts_(counts) {}

  void run() {
    auto next = forest_.arrivals().begin();
    for (double now = START; now < END + 0.5; now += forest_.random().uniform(0.002, 0.05)) {
      for (; next != forest_.arrivals().end() && next->now <= now; ++next) take(*next);
      const int nb_frames = static_cast<int>(forest_.frames().size());
      const int target = forest_.random().integer(0, nb_frames - 1);
      const int source = forest_.random().integer(0, nb_frames - 1);
      ask(target, source, {Instant::NEWEST, at(now)}, now);
      ask(target, source, {Instant::AT, at(now - forest_.random().uniform(0.0, 2.0))}, now);
      if (testing::Test::HasFatalFailure()) return;
    }
  }

 private:
  void take(const Arrival& arrival) {
    Frame& frame = forest_.frames()[arrival.frame];
    Isometry3d X = frame.motion.at(arrival.stamp);
    if (arrival.is_lie) X.translation().x() += 20.0;
    const std::string why =
        buffer_.take({forest_.nameOf(frame.parent), forest_.nameOf(arrival.frame),
                      at(arrival.stamp), X.translation(), Eigen::Quaterniond(X.linear())},
                     frame.is_static, arrival.publisher, at(arrival.now));
    (arrival.is_lie ? frame.last_lie : frame.last_truth) = arrival.now;
    counts_.lies += arrival.is_lie;
  }

  /// A lie is noticed with the next truth around it: until then nobody can tell.
  bool isJustLiedAbout(int target, int source) const {
    for (const int end : {target, source}) {
      for (const int f : forest_.wayUp(end)) {
        const Frame& frame = forest_.frames()[f];
        if (frame.last_lie > frame.last_truth - 1.0) return true;
      }
    }
    return false;
  }
  /// Within the last 3 s.
  bool isAnythingWrong(int target, int source, double now) const {
    for (const Arrival& arrival : forest_.arrivals()) {
      if (arrival.is_lie && arrival.now > now - 3.0 && arrival.now <= now) return true;
    }
    return isSilent(target, now) || isSilent(source, now);
  }
  /// A publisher of a frame on the way up has not gone on for all of the last 2 s.
  bool isSilent(int end, double now) const {
    for (const int f : forest_.wayUp(end)) {
      if (forest_.frames()[f].parent < 0 || forest_.frames()[f].is_static) continue;
      std::map<std::string, std::vector<double>> stamps;
      for (const Arrival& arrival : forest_.arrivals()) {
        const bool counts = arrival.frame == f && arrival.now <= now && arrival.stamp > now - 2.5;
        if (counts) stamps[arrival.publisher].push_back(arrival.stamp);
      }
      const auto goesOn = [&](auto& of_publisher) {
        auto& sent = of_publisher.second;
        std::sort(sent.begin(), sent.end());
        double last = now - 2.3;
        for (const double stamp : sent) {
          if (stamp - last > 0.3) return false;
          last = stamp;
        }
        return now - last < 0.3;
      };
      if (stamps.empty() || !std::all_of(stamps.begin(), stamps.end(), goesOn)) return true;
    }
    return false;
  }

  void ask(int target, int source, const Instant& instant, double now) {
    if (target == source) return;
    FoundPose found;
    try {
      found = poseBetween(buffer_, forest_.nameOf(target), forest_.nameOf(source), instant);
    } catch (const InputError& error) {
      ++counts_.unknown;
      if (instant.kind != Instant::NEWEST || now < START + 3.0 || now > END - 0.5) return;
      if (!forest_.truth(target, source, now) || isAnythingWrong(target, source, now)) return;
      ++counts_.back;
      FAIL() << "unknown at " << now
             << ", though all has been well for 2 s: " << forest_.nameOf(source) << " in "
             << forest_.nameOf(target) << ": " << error.what();
    }
    ++counts_.known;
    const StampNs stamp =
        instant.kind == Instant::AT || found.oldest == NEVER ? instant.stamp : found.oldest;
    const auto truth = forest_.truth(target, source, 1e-9 * static_cast<double>(stamp));
    // A ring is none to be seen while one of its transforms is unknown.
    const bool is_broken_ring =
        forest_.isInRing(target) && forest_.isInRing(source) &&
        (now < START + 3.0 || instant.kind == Instant::AT || isAnythingWrong(target, source, now));
    if (is_broken_ring) return;
    ASSERT_TRUE(truth) << "known, though nothing connects them";
    if (isJustLiedAbout(target, source)) return;
    ASSERT_LT((found.X_TS.matrix() - truth->matrix()).cwiseAbs().maxCoeff(), 1e-5)
        << forest_.nameOf(source) << " in " << forest_.nameOf(target) << " at " << now - START
        << ", stamp " << 1e-9 * static_cast<double>(stamp) - START;
  }

  RandomForest forest_;
  TransformBuffer buffer_;
  Counts& counts_;
};

TEST(TransformOracle, WhatIsKnownIsTrueAndIsKnownAgainTwoSecondsAfterAllIsWell) {
  const unsigned seed = 1000 * givenSeed();
  const unsigned nb_seeds = std::getenv("COLLISION_PAIRS_LONG") ? 5000 : 150;
  Counts counts;
  for (unsigned i = 0; i < nb_seeds; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed + i));
    Oracle(seed + i, counts).run();
    if (HasFatalFailure()) return;
  }
  std::printf("%ld known, %ld unknown, %ld lies\n", counts.known, counts.unknown, counts.lies);
  EXPECT_GT(counts.known, 10000);
  EXPECT_GT(counts.unknown, 10000);
  EXPECT_GT(counts.lies, 100);
}

}  // namespace collision_pairs::test_transform_oracle
