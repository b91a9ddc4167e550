// What MotionCheck certifies, beside the exact check at many configurations of each segment.
//
// A small run by default; scripts/test --long makes it the run that docs/motions.md states.
#include <cstdlib>

#include <gtest/gtest.h>

#include "benchmark/demo_motion.h"
#include "benchmark/motion_scenes.h"

namespace collision_pairs::test_motion_certificates {

constexpr double TO_ROUNDING = 1e-7;  // m: beside a distance that was computed at one configuration
constexpr double MUST_BE_CERTIFIED = 1e-3;  // m

bool isLong() { return std::getenv("COLLISION_PAIRS_LONG") != nullptr; }
int nbSegments() { return isLong() ? 10000 : 60; }
int nbSamples() { return isLong() ? 1000 : 100; }

/// What became of the motions of one robot.
struct Tally {
  int nb[3] = {0, 0, 0};     ///< by verdict
  int nb_not_certified = 0;  ///< UNKNOWN, though nothing came nearer in any sample

  ~Tally() {
    std::cout << nb[0] << " free, " << nb[1] << " collision, " << nb[2] << " unknown, of which "
              << nb_not_certified << " keep more than " << 1e3 * MUST_BE_CERTIFIED
              << " mm in all samples\n";
    EXPECT_LE(nb_not_certified, (nb[0] + nb_not_certified) / 100);
  }
};

class Judge {
 public:
  Judge(const std::shared_ptr<const CollisionScene>& scene, Tally& tally,
        Fidelity fidelity = Fidelity::MESH)
      : tally_(tally), check_(scene), loop_(scene), robot_(scene, &scene->robot()) {
    motion_settings_.fidelity = settings_.fidelity = fidelity;
  }

  void judge(int first, int end) {
    for (int i = first; i < end; ++i) {
      SCOPED_TRACE("motion " + std::to_string(i));
      judge(static_cast<std::uint64_t>(i));
    }
  }

 private:
  void judge(std::uint64_t index) {
    const JointMotion motion = randomMotion(robot_, index, lengthNumber(index));
    MotionSettings settings = motion_settings_;
    settings.clearance = index % 4 == 3 ? 0.01 : 0.0;  // asked for in every fourth
    const MotionReport report = check_.check(motion, settings);
    expectFreeUntil(motion, settings, report);
    ++tally_.nb[static_cast<int>(report.verdict)];
    if (report.verdict == Verdict::FREE) {
      ASSERT_GE(report.clearance, settings.clearance);
      expectFree(motion, report.clearance);
    } else if (report.verdict == Verdict::COLLISION) {
      expectContact(motion, report);
    } else {
      ASSERT_FALSE(report.pairs.empty());
      const bool is_near = smallestDistance(motion) <= settings.clearance + MUST_BE_CERTIFIED;
      if (!is_near) ++tally_.nb_not_certified;
    }
  }

  /// Before free_until no sample is too near, and with from_start that is where one first is; no
  /// other setting puts it later.
  void expectFreeUntil(const JointMotion& motion, MotionSettings settings,
                       const MotionReport& report) {
    settings.from_start = true;
    const MotionReport longest = check_.check(motion, settings);
    ASSERT_EQ(longest.verdict == Verdict::FREE, report.verdict == Verdict::FREE);
    ASSERT_GE(longest.free_until, report.free_until);
    settings.only_free = true;
    for (const bool from_start : {false, true}) {
      settings.from_start = from_start;
      const MotionReport only_free = check_.check(motion, settings);
      ASSERT_EQ(only_free.verdict == Verdict::FREE, report.verdict == Verdict::FREE);
      ASSERT_GE(longest.free_until, only_free.free_until);
    }
    ASSERT_EQ(longest.free_until == 1.0, report.verdict == Verdict::FREE);
    if (report.verdict == Verdict::FREE) return;
    ASSERT_LE(longest.free_until, longest.verdict == Verdict::COLLISION ? longest.contact_at : 1.0);
    for (int i = 0; longest.free_until > 0.0 && i < nbSamples(); ++i) {
      const double fraction = longest.free_until * i / nbSamples();
      ASSERT_GE(distanceAt(motion, fraction), settings.clearance - TO_ROUNDING) << fraction;
    }
    ASSERT_LE(distanceAt(motion, longest.free_until), settings.clearance + 2 * settings.resolution);
  }

  /// The smallest distance up to 2 cm; -1 or less in contact.
  double distanceAt(const JointMotion& motion, double fraction) {
    CheckSettings settings = settings_;
    settings.alarm_distance = 0.02;
    const CollisionReport& exact = loop_.at(motion, fraction, settings);
    double smallest = 0.02;
    for (const PairReport& pair : exact.pairs) smallest = std::min(smallest, pair.distance);
    return exact.verdict == Verdict::FREE ? smallest : std::min(smallest, -1.0);
  }

  /// No sample is in contact; the clearance, which takes longer to measure, in every fiftieth.
  void expectFree(const JointMotion& motion, double clearance) {
    CheckSettings settings = settings_;
    for (int i = 0; i < nbSamples(); ++i) {
      const double fraction = static_cast<double>(i) / (nbSamples() - 1);
      settings.verdict_only = i % 50 != 25;
      settings.alarm_distance = settings.verdict_only ? 0.0 : std::min(clearance, 1.0);
      const CollisionReport& exact = loop_.at(motion, fraction, settings);
      ASSERT_EQ(exact.verdict, Verdict::FREE) << "at " << fraction;
      for (const PairReport& pair : exact.pairs) {
        ASSERT_GE(pair.distance, clearance - TO_ROUNDING) << "at " << fraction;
      }
    }
  }

  void expectContact(const JointMotion& motion, const MotionReport& report) {
    ASSERT_GE(report.contact_at, 0.0);
    ASSERT_LE(report.contact_at, 1.0);
    CheckSettings settings = settings_;
    settings.alarm_distance = 0.0;
    const CollisionReport& exact = loop_.at(motion, report.contact_at, settings);
    ASSERT_EQ(exact.verdict, Verdict::COLLISION);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const PairReport& pair : exact.pairs) pairs.emplace_back(pair.first, pair.second);
    ASSERT_EQ(report.pairs, pairs);
  }

  double smallestDistance(const JointMotion& motion) {
    CheckSettings settings = settings_;
    settings.min_distance = true;
    double smallest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < nbSamples(); ++i) {
      const double fraction = static_cast<double>(i) / (nbSamples() - 1);
      smallest = std::min(smallest, loop_.at(motion, fraction, settings).min_distance);
    }
    return smallest;
  }

  Tally& tally_;
  CheckSettings settings_;
  MotionSettings motion_settings_;
  MotionCheck check_;
  StateLoop loop_;
  std::shared_ptr<const RobotModel> robot_;
};

void judgeAmongClutter(const BenchmarkRobot& robot) {
  constexpr int MOTIONS_A_CLUTTER = 250;
  Tally tally;
  for (int first = 0; first < nbSegments(); first += MOTIONS_A_CLUTTER) {
    SCOPED_TRACE("clutter " + std::to_string(first));
    Judge(clutteredScene(robot, static_cast<std::uint64_t>(first)), tally)
        .judge(first, std::min(first + MOTIONS_A_CLUTTER, nbSegments()));
  }
}

TEST(MotionCertificates, OfTheDemoRobotAreNotContradicted) { judgeAmongClutter(demoRobot()); }

TEST(MotionCertificates, OfCoarserRungsAreNotContradicted) {
  SceneSettings settings;
  settings.max_hull_vertices = 12;
  settings.link_fidelity["forearm"] = Fidelity::OBB;
  const auto scene = clutteredScene(demoRobot(), 0, settings);
  for (const Fidelity fidelity :
       {Fidelity::AABB, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
    SCOPED_TRACE(fidelityName(fidelity));
    Tally tally;
    Judge(scene, tally, fidelity).judge(0, nbSegments() / 2);
  }
}

/// panda, ur5 and pr2, which need not be there.
class CertificatesOf : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (benchmarkRobots().empty()) GTEST_SKIP() << "skipped: no COLLISION_PAIRS_SHARED";
  }
  const BenchmarkRobot& robot() const { return benchmarkRobots()[GetParam()]; }
};

TEST_P(CertificatesOf, ARobotAmongClutterAreNotContradicted) { judgeAmongClutter(robot()); }

TEST_P(CertificatesOf, ARobotInItsWorldAreNotContradicted) {
  Tally tally;
  Judge(CollisionScene::build(robot().robot, robot().srdf, robot().world), tally)
      .judge(0, nbSegments());
}

std::string robotName(const testing::TestParamInfo<int>& robot) {
  const char* const names[] = {"panda", "ur5", "pr2"};
  return names[robot.param];
}

INSTANTIATE_TEST_SUITE_P(RealRobots, CertificatesOf, testing::Values(0, 1, 2), robotName);

}  // namespace collision_pairs::test_motion_certificates
