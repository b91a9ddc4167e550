// The same random transforms live, as the node takes them, and recorded, as check_bag does: for no
// stamp may the recording be known where the node said that it is not.
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "demo_scene.h"
#include "random_inputs.h"
#include "robot_poses.h"

namespace collision_pairs {
namespace test_recorded_and_live {

constexpr StampNs MS = 1000000;

/// A transform, and when it arrives.
struct Arrival {
  StampNs now;
  ReceivedTransform transform;
  bool is_static;
  std::string publisher;
};

class RandomStream {
 public:
  explicit RandomStream(unsigned seed) : random_(seed) {}

  std::vector<Arrival> make() {
    for (const auto& [parent, child] :
         {std::pair("root", "arm"), {"arm", "mount"}, {"mount", "hand"}, {"root", "cart"}}) {
      const bool is_static = child == std::string("mount") ? chance(2) : chance(20);
      if (is_static) {
        add(parent, child, START + upTo(500), 0.0, true, "/static");
      } else {
        publish(parent, child, "/first", 0.0, START, START + 8000 * MS);
      }
      if (chance(3)) publish(parent, child, "/agrees", 0.0, any(), any());
      // Further off than the others move within max_gap: less may pass for motion.
      if (chance(5)) publish(parent, child, "/liar", 10.0, any(), any());
      if (chance(5)) publish("other", child, "/reparents", 0.0, any(), any());
      if (chance(5)) add(parent, child, any(), 2.0, true, chance(2) ? "/static" : "/mistaken");
      if (chance(9)) add(parent, child, any(), 2.0, true, "/mistaken");
    }
    std::stable_sort(arrivals_.begin(), arrivals_.end(),
                     [](const Arrival& a, const Arrival& b) { return a.now < b.now; });
    return arrivals_;
  }

  static constexpr StampNs START = 1000000 * MS;

 private:
  bool chance(int of) { return random_() % of == 0; }
  StampNs upTo(int milliseconds) { return static_cast<StampNs>(random_() % milliseconds) * MS; }
  StampNs any() { return START + upTo(8000); }

  void publish(const std::string& parent, const std::string& child, const std::string& publisher,
               double off, StampNs begin, StampNs end) {
    const StampNs period = 20 * MS + upTo(chance(4) ? 900 : 100),
                  latency = upTo(chance(4) ? 400 : 30);
    const StampNs ahead = chance(6) ? upTo(450) : 0;
    for (StampNs t = begin; t < end; t += chance(40) ? upTo(1600) : period) {
      const StampNs late = chance(30) ? upTo(1500) : latency;
      StampNs stamp = t + ahead;
      if (chance(60)) stamp = chance(2) ? 0 : t + 3600000 * MS;
      add(parent, child, stamp, off, false, publisher, t + late);
    }
  }

  /// Along x at a constant speed, so that interpolation is exact. The mount is always where the
  /// URDF has it, which serves where its transform is in doubt.
  void add(const std::string& parent, const std::string& child, StampNs stamp, double off,
           bool is_static, const std::string& publisher, StampNs now = 0) {
    const double moved = is_static ? 0.0 : 1e-9 * static_cast<double>(stamp - START);
    const double x = child == "mount" ? 0.0 : off + moved;
    arrivals_.push_back(
        {now == 0 ? stamp : now,
         {parent, child, stamp, Eigen::Vector3d(x, 0, 0), Eigen::Quaterniond::Identity()},
         is_static,
         publisher});
  }

  std::mt19937 random_;
  std::vector<Arrival> arrivals_;
};

std::shared_ptr<const RobotModel> robot() {
  const std::string along_x = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
  return robotFrom(emptyLink("root") + emptyLink("arm") + emptyLink("mount") + emptyLink("hand") +
                   emptyLink("cart") + joint("j", "prismatic", "root", "arm", "0 0 0", along_x) +
                   joint("f", "fixed", "arm", "mount", "0 0 0") +
                   joint("k", "prismatic", "mount", "hand", "0 0 0", along_x) +
                   joint("c", "prismatic", "root", "cart", "0 0 0", along_x));
}

bool areAllKnown(const FoundBodies& found) {
  return std::count(found.known.begin(), found.known.end(), 0) == 0;
}

struct Counts {
  int complete = 0, incomplete = 0, recorded = 0;
};

void compare(unsigned seed, Counts& counts) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  const std::vector<Arrival> arrivals = RandomStream(seed).make();
  const auto model = robot();
  const std::vector<char> all(model->bodies().size(), 1);
  const PoseLimits limits;
  TransformBuffer live(limits), recorded(limits, true);
  for (const Arrival& a : arrivals) recorded.take(a.transform, a.is_static, a.publisher, a.now);
  const RobotPoses from_live(live, *model, "root"), from_recorded(recorded, *model, "root");
  auto next = arrivals.begin();
  for (StampNs now = RandomStream::START; now < RandomStream::START + 9500 * MS; now += 7 * MS) {
    for (; next != arrivals.end() && next->now <= now; ++next) {
      live.take(next->transform, next->is_static, next->publisher, next->now);
    }
    const FoundBodies node = from_live.newest(now, all);
    if (node.stamp == NEVER) continue;
    const FoundBodies bag = from_recorded.place({Instant::AS_IT_ARRIVED, node.stamp}, all);
    ++(areAllKnown(node) ? counts.complete : counts.incomplete);
    counts.recorded += areAllKnown(bag);
    if (!areAllKnown(node)) {
      ASSERT_FALSE(areAllKnown(bag))
          << "at " << now - RandomStream::START << " the node's stamp "
          << node.stamp - RandomStream::START << ": " << testing::PrintToString(node.problems);
    }
    if (!areAllKnown(bag)) continue;
    for (std::size_t b = 0; b < all.size(); ++b) {
      ASSERT_LT((node.X_WB[b].translation() - bag.X_WB[b].translation()).norm(), 1e-6)
          << "body " << b << " at " << now - RandomStream::START << " the node's stamp "
          << node.stamp - RandomStream::START;
    }
  }
}

TEST(RecordedAndLive, WhatTheNodeDoesNotKnowTheRecordingDoesNotKnowEither) {
  const unsigned seed = 5000 * givenSeed();  // so that two runs share no stream
  Counts counts;
  const unsigned nb_seeds = std::getenv("COLLISION_PAIRS_LONG") ? 5000 : 300;
  for (unsigned i = 0; i < nb_seeds; ++i) {
    compare(seed + i, counts);
    if (HasFatalFailure()) return;
  }
  std::printf("%d complete, %d incomplete; %d in the recording\n", counts.complete,
              counts.incomplete, counts.recorded);
  EXPECT_GT(counts.incomplete, 1000);
  EXPECT_GT(counts.recorded, 1000) << "and it knows something";
}

}  // namespace test_recorded_and_live
}  // namespace collision_pairs
