// What the limiter says of a command that does not pass as it is: every reason, word by word.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "limiter_law.h"
#include "published_decisions.h"

namespace collision_pairs::test_limiter_reasons {

using testing::EndsWith;
using testing::StartsWith;

/// One pair is near; nothing is certified but with that pair left out, if `is_free_without`.
struct OnePair : Surroundings {
  NearPair pair{"hand", "ball", -0.002, 1.0, false};
  double travelled = 1e-4;
  bool is_known = true, is_free_without = false, leads_apart = true;
  std::string path;  // why it is not certified, if that is not the pair

  Certificate certify(const StoppingTube&, const KeptDistances&,
                      const std::vector<NearPair>& nearer) override {
    return {is_free_without && !nearer.empty(), "hand", "ball", path, pair.are_links};
  }
  double travel(const StoppingTube&) override { return travelled; }
  bool leadsApart(const StoppingTube&, const NearPair&) override { return leads_apart; }
  double distance(const std::string&, const std::string&, double) override {
    return is_known ? pair.distance : NAN;
  }
  bool nearPairs(double, const std::vector<double>&, std::vector<NearPair>& pairs,
                 std::string& why) override {
    pairs = {pair};
    if (!is_known) why = "cloud is not known";
    return is_known;
  }
};

class Reasons : public testing::Test {
 protected:
  Reasons() { settings_.deceleration = {2.0}; }

  LimiterDecision decide(const LimiterInput& input) {
    return LimiterLaw(settings_).decide(input, surroundings_);
  }
  std::string refusal(const LimiterInput& input) {
    const LimiterDecision decision = decide(input);
    EXPECT_EQ(decision.scale, 0.0);
    EXPECT_EQ(decision.command, std::vector<double>(1, 0.0));
    EXPECT_NE(decision.verdict, Verdict::FREE);
    return decision.reason;
  }

  const LimiterInput input_{9.0, 9.0, 0.0, {0.1}};
  LimiterSettings settings_;
  OnePair surroundings_;
};

TEST_F(Reasons, OfAnInputThatCannotBeUsed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal({9.0, 9.0, 0.0, {0.1, 0.1}}),
            "the command has 2 numbers, but 1 joints are limited");
  EXPECT_EQ(refusal({9.0, 9.0, 0.0, {}}), "the command has 0 numbers, but 1 joints are limited");
  settings_.max_joint_state_age = 0.5;
  EXPECT_THAT(refusal({9.0, 8.5, 0.0, {0.1}}), StartsWith("on the stopping path"));
  settings_.max_joint_state_age = 0.25;
  EXPECT_EQ(refusal({9.0, 9.0, 0.0, {nan}}), "the command is not finite");
  EXPECT_EQ(refusal({9.0, 9.0, 0.0, {HUGE_VAL}}), "the command is not finite");
  EXPECT_EQ(refusal({9.0, 8.5, 0.0, {0.1}}), "the joint state is 0.500000 s old");
  EXPECT_EQ(refusal({9.0, 9.25, 0.0, {0.1}}), "the joint state is of the future");
  EXPECT_EQ(refusal({9.0, 9.0, nan, {0.1}}), "the age of obstacles is not known");
}

TEST_F(Reasons, OfAPathThatIsNotCertifiedAreThePairAndTheDistanceThatIsKept) {
  EXPECT_EQ(refusal(input_),
            "on the stopping path a pair comes nearer than 0.012 m; its way back is not certified");
  const LimiterDecision still = decide(input_);
  EXPECT_EQ(still.first, "hand");
  EXPECT_EQ(still.second, "ball");
  EXPECT_TRUE(still.has_distance);
  EXPECT_EQ(still.distance, -0.002);
  surroundings_.path = "cloud is not known";
  EXPECT_EQ(refusal(input_), "cloud is not known; its way back is not certified");
  surroundings_.path.clear();
  settings_.obstacle_speed = 0.5;
  EXPECT_THAT(
      refusal(input_),
      StartsWith(
          "on the stopping path a pair comes nearer than 0.012 m, or than 0.167 m to an object; "));
}

TEST_F(Reasons, OfLinksSayTheDistanceThatLinksKeep) {
  surroundings_.pair.are_links = surroundings_.pair.is_robot = true;
  settings_.obstacle_speed = 0.5;
  EXPECT_THAT(refusal(input_),
              StartsWith("on the stopping path a pair comes nearer than 0.004 m; "));
}

TEST_F(Reasons, OfARetreatThatDoesNotPass) {
  EXPECT_THAT(refusal(input_), EndsWith("; its way back is not certified"));
  surroundings_.travelled = 1.0;
  EXPECT_THAT(refusal(input_), EndsWith("; it would lead too far"));
  surroundings_.leads_apart = false;
  EXPECT_THAT(refusal(input_), EndsWith("; it would lead deeper into contact"));
  surroundings_.pair.derivative = -1.0;
  EXPECT_THAT(refusal(input_), EndsWith("; it does not lead away from all that is near"));
  surroundings_.is_known = false;
  EXPECT_THAT(refusal(input_), EndsWith("; cloud is not known"));
}

TEST_F(Reasons, OfARetreatBeforeTheRobotStands) {
  surroundings_.is_free_without = true;
  LimiterLaw law(settings_);
  surroundings_.pair.derivative = 1.0;
  ASSERT_GT(published(law, input_, surroundings_).scale, 0.0);
  const LimiterDecision back = published(law, {9.01, 9.01, 0.0, {-0.1}}, surroundings_);
  EXPECT_EQ(back.scale, 0.0);
  EXPECT_THAT(back.reason, EndsWith("; the robot does not stand yet"));
}

TEST_F(Reasons, OfAScaleThatIsNotTheWholeAndOfOneThatIs) {
  surroundings_.is_free_without = true;
  const LimiterDecision retreat = decide(input_);
  EXPECT_EQ(retreat.reason, "it leads away from what is near");
  EXPECT_EQ(retreat.verdict, Verdict::COLLISION);
  struct Free : OnePair {
    Certificate certify(const StoppingTube&, const KeptDistances&,
                        const std::vector<NearPair>&) override {
      return {true, "", "", ""};
    }
  } nothing;
  LimiterLaw law(settings_);
  EXPECT_EQ(published(law, input_, nothing).reason, "");
  publishStop(law, 9.1);
  // Law time may stand: nothing is wrong with the zeros that pass then.
  const LimiterDecision at_once = published(law, {9.1, 9.1, 0.0, {0.1}}, nothing);
  EXPECT_EQ(at_once.scale, 0.0);
  EXPECT_EQ(at_once.reason, "the scale is rising");
  EXPECT_EQ(at_once.verdict, Verdict::FREE);
  EXPECT_EQ(published(law, {9.11, 9.11, 0.0, {0.1}}, nothing).reason, "the scale is rising");
}

}  // namespace collision_pairs::test_limiter_reasons
