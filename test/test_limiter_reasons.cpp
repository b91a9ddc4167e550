// What the limiter asks of its surroundings, number by number, and what it says of a command that
// does not pass as it is: every reason, word by word.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "limiter_law.h"
#include "published_decisions.h"

namespace collision_pairs {
namespace test_limiter_reasons {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::EndsWith;
using testing::Pointwise;
using testing::StartsWith;

/// One pair is near; nothing is certified but with that pair left out, if `is_free_without`.
struct OnePair : Surroundings {
  NearPair pair{"hand", "ball", -0.002, 1.0, false};
  double travelled = 1e-4;
  bool is_known = true, is_free_without = false, leads_apart = true;
  std::string path;  // why it is not certified, if that is not the pair

  Certificate certify(const StoppingTube&, double, double,
                      const std::vector<NearPair>& nearer) override {
    return {is_free_without && !nearer.empty(), "hand", "ball", path};
  }
  double travel(const StoppingTube&) override { return travelled; }
  bool leadsApart(const StoppingTube&, const NearPair&) override { return leads_apart; }
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
  settings_.max_joint_state_age = 0.5;
  EXPECT_THAT(refusal({9.0, 8.5, 0.0, {0.1}}), StartsWith("on the stopping path"));
  settings_.max_joint_state_age = 0.25;
  EXPECT_EQ(refusal({9.0, 9.0, 0.0, {nan}}), "the command is not finite");
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
    Certificate certify(const StoppingTube&, double, double,
                        const std::vector<NearPair>&) override {
      return {true, "", "", ""};
    }
  } nothing;
  LimiterLaw law(settings_);
  EXPECT_EQ(published(law, input_, nothing).reason, "");
  publishStop(law, 9.1);
  EXPECT_EQ(published(law, {9.11, 9.11, 0.0, {0.1}}, nothing).reason, "the scale is rising");
}

/// Certifies scales up to one, and remembers all questions.
struct Asked : Surroundings {
  double certified = 0.0, stop_distance = 0.01;
  double seconds = 0.31, command = 0.1;  // of the path along the command
  std::vector<double> scales, clearances, growths, retreats, reaches;
  double kept_scale = 0.0, kept_growth = 0.0;  // of the last retreat
  std::vector<NearPair> near, nearer, touching;
  double travelled = 1e-4;
  bool may_retreat = false, leads_apart = true;

  double scaleOf(const StoppingTube& tube) const {
    return (tube.to[0] - tube.from[0]) / (seconds * command);
  }
  Certificate certify(const StoppingTube& tube, double clearance, double growth,
                      const std::vector<NearPair>& kept) override {
    if (!kept.empty() || clearance == stop_distance) {  // of a retreat
      nearer = kept;
      kept_scale = scaleOf(tube);
      kept_growth = growth;
      return {may_retreat, "", "", ""};
    }
    scales.push_back(scaleOf(tube));
    clearances.push_back(clearance);
    growths.push_back(growth);
    return {scales.back() <= certified, "hand", "ball", ""};
  }
  double travel(const StoppingTube& tube) override {
    retreats.push_back(scaleOf(tube));
    return travelled;
  }
  bool leadsApart(const StoppingTube&, const NearPair& pair) override {
    touching.push_back(pair);
    return leads_apart;
  }
  bool nearPairs(double reach, const std::vector<double>&, std::vector<NearPair>& pairs,
                 std::string&) override {
    reaches.push_back(reach);
    pairs = near;
    return true;
  }
};

class Questions : public testing::Test {
 protected:
  Questions() { settings_.deceleration = {2.0}; }

  /// The first decision of a law, about a scale of 1.
  LimiterDecision decide(double certified) {
    asked_ = Asked();
    asked_.certified = certified;
    return LimiterLaw(settings_).decide({9.0, 9.0, 0.0, {0.1}}, asked_);
  }
  /// One about a retreat from this pair.
  LimiterDecision retreatFrom(const NearPair& pair) {
    asked_.near = {pair};
    asked_.may_retreat = true;
    asked_.nearer.clear();
    return LimiterLaw(settings_).decide({9.0, 9.0, 0.0, {0.1}}, asked_);
  }

  LimiterSettings settings_;
  Asked asked_;
};

TEST_F(Questions, OfASearchAreFiveScalesAtMost) {
  const auto expect = [&](double certified, const std::vector<double>& scales, double found) {
    const LimiterDecision decision = decide(certified);
    EXPECT_NEAR(decision.scale, found, 1e-9);
    EXPECT_EQ(decision.verdict, found > 0.0 ? Verdict::FREE : Verdict::UNKNOWN);
    EXPECT_THAT(asked_.scales, Pointwise(DoubleNear(1e-9), scales));
    EXPECT_EQ(asked_.retreats.empty(), found > settings_.retreat_scale);
  };
  expect(2.0, {1.0}, 1.0);
  expect(0.95, {1.0, 0.85, 0.925}, 0.925);
  expect(0.5, {1.0, 0.85, 0.85 / 3.0, 1.7 / 3.0, 0.425}, 0.425);
  expect(0.0, {1.0, 0.85, 0.85 / 3.0, 0.85 / 9.0, 0.85 / 27.0}, 0.0);
}

TEST_F(Questions, OfALaterSearchBeginBelowWhatPassedLast) {
  LimiterLaw law(settings_);
  asked_.certified = 0.5;
  EXPECT_NEAR(published(law, {9.0, 9.0, 0.0, {0.1}}, asked_).scale, 0.425, 1e-9);
  asked_.scales.clear();
  published(law, {9.1, 9.1, 0.0, {0.1}}, asked_);
  ASSERT_EQ(asked_.scales.size(), 5u);
  EXPECT_NEAR(asked_.scales[0], 0.425 + 2.0 * 0.1, 1e-9);
  EXPECT_NEAR(asked_.scales[1], (0.21 * 0.85 * 0.425 + 0.1 * 0.425) / 0.31, 1e-9);
  asked_ = Asked();
  asked_.certified = 0.99;
  LimiterLaw nearly(settings_);
  published(nearly, {9.0, 9.0, 0.0, {0.1}}, asked_);  // 0.925
  asked_.scales.clear();
  asked_.certified = 0.84;
  published(nearly, {9.001, 9.001, 0.0, {0.1}}, asked_);
  EXPECT_EQ(asked_.scales.size(), 3u) << "near enough";
  publishStop(law, 9.2);
  asked_ = Asked();
  published(law, {9.205, 9.205, 0.0, {0.1}},
            asked_);  // 0.01, then 0.0085, then less than is driven
  EXPECT_EQ(asked_.scales.size(), 2u);
}

TEST_F(Questions, AfterAStopAreOfARobotThatBrakes) {
  LimiterLaw law(settings_);
  asked_.certified = 9.0;
  published(law, {9.0, 9.0, 0.0, {0.2}}, asked_);
  publishStop(law, 9.1);
  asked_.scales.clear();
  published(law, {9.7, 9.7, 0.0, {0.1}}, asked_);
  EXPECT_THAT(asked_.scales, ElementsAre(DoubleNear(1.0, 1e-9)));
  publishStop(law, 9.8);
  asked_.retreats.clear();
  published(law, {9.85, 9.85, 0.0, {0.1}},
            asked_);  // all that may pass is less than a retreat's scale
  EXPECT_TRUE(asked_.retreats.empty());
}

TEST_F(Questions, AreAsIfTheHoldOfTheCommandWereALittleLonger) {
  settings_.stop_distance = 0.02;
  decide(2.0);
  EXPECT_THAT(asked_.scales, ElementsAre(DoubleNear(1.0, 1e-9))) << "0.1 + 0.2 + 0.01 s";
  EXPECT_THAT(asked_.clearances, ElementsAre(0.022));
  EXPECT_THAT(asked_.growths, ElementsAre(0.0));
}

TEST_F(Questions, CountWhatComesFromItsOwnStampOnUntilTheRobotStands) {
  settings_.obstacle_speed = 0.5;
  for (const auto& [age, seconds] : {std::pair{0.0, 0.36}, {0.05, 0.36}, {0.3, 0.61}}) {
    asked_ = Asked();
    asked_.certified = 9.0;
    LimiterLaw(settings_).decide({9.0, 8.95, age, {0.1}}, asked_);
    EXPECT_THAT(asked_.growths, ElementsAre(DoubleNear(0.5 * (seconds + 0.05), 1e-9))) << age;
  }
}

TEST_F(Questions, OfARetreatAreFourScalesAndHowFarItCouldMeetAnything) {
  settings_.obstacle_speed = 0.5;
  asked_.seconds = 0.36;
  const LimiterDecision decision = LimiterLaw(settings_).decide({9.0, 8.95, 0.0, {0.1}}, asked_);
  EXPECT_EQ(decision.scale, 0.0);
  EXPECT_THAT(asked_.retreats, Pointwise(DoubleNear(1e-9), {0.2, 0.05, 0.0125, 0.003125}));
  ASSERT_EQ(asked_.reaches.size(), 5u);
  for (int i = 0; i < 4; ++i) {
    const double braking = 0.1 * asked_.retreats[i] / 2.0;
    EXPECT_NEAR(asked_.reaches[i], 0.012 + 0.5 * (0.36 + braking) + 2e-4, 1e-9);
  }
  EXPECT_DOUBLE_EQ(asked_.reaches[4], 0.11) << "for the distance that is told";
  EXPECT_FALSE(decision.has_distance);
}

TEST_F(Questions, ARetreatIsFromThePairsThatCouldComeTooNear) {
  settings_.obstacle_speed = 0.5;
  const double reach = 0.012 + 0.5 * (0.31 + 0.01) + 2e-4, coming = 0.16;
  for (const bool is_robot : {false, true}) {
    const double limit = reach - (is_robot ? coming : 1e-4);
    EXPECT_GT(retreatFrom({"hand", "ball", limit - 1e-9, 1.0, is_robot}).scale, 0.0);
    EXPECT_LT(retreatFrom({"hand", "ball", limit + 1e-9, 1.0, is_robot}).scale, 0.2);
  }
}

TEST_F(Questions, ARetreatGivesAwayHalfOfADistanceThatIsTooSmall) {
  const auto kept = [&](double distance) {
    EXPECT_GT(retreatFrom({"hand", "ball", distance, 1.0, false}).scale, 0.0) << distance;
    return asked_.nearer.empty() ? NAN : asked_.nearer[0].distance;
  };
  EXPECT_EQ(kept(-0.1), -1.0);
  EXPECT_EQ(kept(0.0000199), -1.0);
  EXPECT_EQ(asked_.touching.size(), 2u) << "what is in contact is only looked at";
  EXPECT_EQ(kept(0.00002), 0.00001);
  EXPECT_EQ(kept(0.001), 0.0005);
  EXPECT_EQ(asked_.touching.size(), 2u);
  EXPECT_EQ(kept(0.008), 0.004);
  EXPECT_EQ(kept(0.0109), 0.005);
  EXPECT_TRUE(std::isnan(kept(settings_.stop_distance + 0.5 * 0.002)));
  EXPECT_NEAR(asked_.kept_scale, 0.2, 1e-9);
  asked_.seconds = 0.36;
  EXPECT_GT(LimiterLaw(settings_).decide({9.0, 8.95, 0.0, {0.1}}, asked_).scale, 0.0);
  EXPECT_NEAR(asked_.kept_scale, 0.2, 1e-9) << "from the stamp on";
  settings_.obstacle_speed = 0.5;
  kept(0.005);
  EXPECT_EQ(asked_.kept_growth, 0.0) << "what comes is let come";
}

TEST_F(Questions, ARetreatFromContactIsShort) {
  const auto passes = [&](double travelled) {
    asked_.travelled = travelled;
    return retreatFrom({"hand", "ball", 0.0, 1.0, false}).scale > 0.0;
  };
  EXPECT_TRUE(passes(0.005));
  EXPECT_FALSE(passes(0.00501));
  settings_.stop_distance = asked_.stop_distance = 0.001;
  EXPECT_TRUE(passes(0.002));
  EXPECT_FALSE(passes(0.00201));
  asked_.travelled = 0.1;
  EXPECT_GT(retreatFrom({"hand", "ball", 0.00002, 1.0, false}).scale, 0.0) << "not in contact";
  asked_.travelled = 0.001;
  EXPECT_TRUE(passes(0.001));
  asked_.leads_apart = false;
  EXPECT_FALSE(passes(0.001));
}

TEST_F(Questions, ARetreatLeadsAwayByMoreThanGradientsMayBeOff) {
  settings_.deceleration = {2.0, 2.0};
  asked_.may_retreat = true;
  const auto passes = [&](double derivative) {
    asked_.near = {{"hand", "ball", 0.005, derivative, false}};
    return LimiterLaw(settings_).decide({9.0, 9.0, 0.0, {0.1, -0.3}}, asked_).scale > 0.0;
  };
  EXPECT_TRUE(passes(1.001e-5 * 0.4));
  EXPECT_FALSE(passes(0.999e-5 * 0.4));
  EXPECT_FALSE(passes(NAN));
}

TEST_F(Questions, ARetreatNamesThePairThatIsNearestOrThatItDoesNotLeave) {
  asked_.may_retreat = true;
  asked_.near = {{"arm", "post", 0.005, 1.0, false}, {"arm", "table", 0.006, 1.0, false}};
  const auto decide = [&] { return LimiterLaw(settings_).decide({9.0, 9.0, 0.0, {0.1}}, asked_); };
  LimiterDecision decision = decide();
  EXPECT_EQ(decision.first + '|' + decision.second, "arm|post");
  EXPECT_EQ(decision.distance, 0.005);
  asked_.near[1].derivative = -1.0;
  decision = decide();
  EXPECT_EQ(decision.first + '|' + decision.second, "arm|table");
  EXPECT_EQ(decision.distance, 0.006);
  EXPECT_THAT(decision.reason, StartsWith("on the stopping path"));
  asked_.near.push_back({"arm", "wall", 0.007, 1.0, false});
  EXPECT_EQ(decide().distance, 0.006) << "of the pair that is named";
}

TEST_F(Questions, ARetreatIsNotCertifiedAsTheSmallerScaleBeforeItWas) {
  asked_.certified = 0.1;
  EXPECT_NEAR(retreatFrom({"hand", "ball", 0.008, 1.0, false}).scale, 0.2, 1e-9);
  EXPECT_EQ(retreatFrom({"hand", "ball", 0.008, 1.0, false}).verdict, Verdict::UNKNOWN);
  asked_.may_retreat = false;
  const LimiterDecision decision = LimiterLaw(settings_).decide({9.0, 9.0, 0.0, {0.1}}, asked_);
  EXPECT_NEAR(decision.scale, 0.85 / 9.0, 1e-9);
  EXPECT_EQ(decision.verdict, Verdict::FREE);
  EXPECT_EQ(decision.reason, "on the stopping path a pair comes nearer than 0.012 m");
}

TEST_F(Questions, TheRobotIsInContactFromADistanceOfZeroOn) {
  EXPECT_EQ(retreatFrom({"hand", "ball", 0.0, 1.0, false}).verdict, Verdict::COLLISION);
  EXPECT_EQ(retreatFrom({"hand", "ball", 1e-12, 1.0, false}).verdict, Verdict::UNKNOWN);
}

TEST_F(Questions, ZerosPassWithoutAny) {
  LimiterLaw law(settings_);
  publishStop(law, 9.0);
  const LimiterDecision decision = published(law, {9.1, 9.1, 0.0, {0.0}}, asked_);
  EXPECT_TRUE(asked_.scales.empty());
  EXPECT_EQ(decision.verdict, Verdict::FREE);
  EXPECT_EQ(decision.reason, "");
  EXPECT_NEAR(decision.scale, 0.2, 1e-9) << "it rises meanwhile";
  EXPECT_FALSE(decision.has_distance);
  EXPECT_EQ(decision.command, std::vector<double>{0.0});
}

}  // namespace test_limiter_reasons
}  // namespace collision_pairs
