// What the limiter asks of its surroundings, number by number.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "limiter_law.h"
#include "published_decisions.h"

namespace collision_pairs::test_limiter_questions {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;
using testing::StartsWith;

/// Certifies scales up to one, and remembers all questions.
struct Asked : Surroundings {
  double certified = 0.0, stop_distance = 0.01;
  double nearest = 1.0;  // of this pair: no more is certified
  std::string first = "hand", second = "ball";
  double seconds = 0.31, command = 0.1;  // of the path along the command
  std::vector<double> scales, clearances, of_links, growths, retreats, reaches;
  double told_within = 0.0;
  double kept_scale = 0.0;  // of the last retreat
  KeptDistances kept_distances;
  std::vector<NearPair> near, nearer, touching;
  double travelled = 1e-4;
  bool may_retreat = false, leads_apart = true;

  double scaleOf(const StoppingTube& tube) const {
    return (tube.to[0] - tube.from[0]) / (seconds * command);
  }
  Certificate certify(const StoppingTube& tube, const KeptDistances& all,
                      const std::vector<NearPair>& kept) override {
    if (!kept.empty() || all.others == stop_distance) {  // of a retreat
      nearer = kept;
      kept_scale = scaleOf(tube);
      kept_distances = all;
      return {may_retreat, "", "", ""};
    }
    scales.push_back(scaleOf(tube));
    clearances.push_back(all.others);
    of_links.push_back(all.links);
    growths.push_back(all.coming);
    return {scales.back() <= certified && all.others <= nearest, first, second, ""};
  }
  double travel(const StoppingTube& tube) override {
    retreats.push_back(scaleOf(tube));
    return travelled;
  }
  bool leadsApart(const StoppingTube&, const NearPair& pair) override {
    touching.push_back(pair);
    return leads_apart;
  }
  double distance(const std::string& one, const std::string& other, double reach) override {
    told_within = reach;
    for (const NearPair& pair : near) {
      if (pair.first == one && pair.second == other) return pair.distance;
    }
    return HUGE_VAL;
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
  EXPECT_THAT(asked_.retreats, Pointwise(DoubleNear(1e-9), {0.2, 0.1, 0.025, 0.003125}));
  ASSERT_EQ(asked_.reaches.size(), 1u) << "what is near for the largest is near for all";
  const double braking = 0.1 * asked_.retreats[0] / 2.0;
  EXPECT_NEAR(asked_.reaches[0], 0.012 + 0.5 * (0.36 + braking) + 2e-4, 1e-9);
  EXPECT_DOUBLE_EQ(asked_.told_within, 0.11);
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
  EXPECT_EQ(kept(0.005), 0.0025) << "what comes is let come";
  EXPECT_EQ(kept(0.015), settings_.stop_distance);
  EXPECT_GT(asked_.kept_distances.coming, 0.1)
      << "but not by what the command does not lead away from";
}

TEST_F(Questions, ARetreatKeepsTheStopDistanceToAllThatIsNotNearerAlready) {
  asked_.may_retreat = true;
  asked_.near = {{"hand", "ball", -0.002, 1.0, false},
                 {"arm", "ball", 0.006, 1.0, false},
                 {"arm", "table", 0.0115, 1.0, false}};
  EXPECT_GT(LimiterLaw(settings_).decide({9.0, 9.0, 0.0, {0.1}}, asked_).scale, 0.0);
  EXPECT_EQ(asked_.kept_distances.others, settings_.stop_distance);
  EXPECT_EQ(asked_.kept_distances.links, settings_.self_stop_distance);
  ASSERT_EQ(asked_.nearer.size(), 2u);
  EXPECT_LT(asked_.nearer[0].distance, 0.0);  // it touches
  EXPECT_EQ(asked_.nearer[1].second, "ball");
  EXPECT_DOUBLE_EQ(asked_.nearer[1].distance, 0.003);
}

TEST_F(Questions, OfLinksAreAboutTheirOwnDistance) {
  settings_.self_stop_distance = 0.003;
  decide(2.0);
  EXPECT_THAT(asked_.clearances, ElementsAre(0.012));
  EXPECT_THAT(asked_.of_links, ElementsAre(0.005));
  const auto kept = [&](double distance) {
    EXPECT_GT(retreatFrom({"hand", "arm", distance, 1.0, true, true}).scale, 0.0) << distance;
    return asked_.nearer.empty() ? NAN : asked_.nearer[0].distance;
  };
  asked_ = Asked();
  EXPECT_EQ(kept(-0.1), -1.0);
  EXPECT_EQ(kept(0.001), 0.0005);
  EXPECT_EQ(kept(0.0039), 0.0015);
  EXPECT_TRUE(std::isnan(kept(0.0041)));
  // Beyond that the pair has no part in it, but for what both may move.
  EXPECT_GT(retreatFrom({"hand", "arm", 0.005 + 2e-4 - 1e-9, 1.0, true, true}).scale, 0.0);
  EXPECT_LT(retreatFrom({"hand", "arm", 0.005 + 2e-4 + 1e-9, 1.0, true, true}).scale, 0.2);
}

// The certificate covers them.
TEST_F(Questions, ARetreatMayLeadNearerToWhatIsFarEnough) {
  asked_.may_retreat = true;
  settings_.self_stop_distance = 0.003;
  const auto passes = [&](const NearPair& other) {
    asked_.near = {{"hand", "ball", 0.001, 1.0, false, false}, other};
    return LimiterLaw(settings_).decide({9.0, 9.0, 0.0, {0.1}}, asked_).scale > 0.0;
  };
  EXPECT_TRUE(passes({"arm", "post", 0.0121, -1.0, false, false}));
  EXPECT_EQ(asked_.nearer.size(), 1u) << "the other keeps what all keep";
  EXPECT_FALSE(passes({"arm", "post", 0.0119, -1.0, false, false}));
  EXPECT_TRUE(passes({"arm", "hand", 0.0051, -1.0, true, true}));
  EXPECT_FALSE(passes({"arm", "hand", 0.0049, -1.0, true, true}));
  asked_.near = {{"arm", "post", 0.0121, -1.0, false, false}};
  EXPECT_EQ(LimiterLaw(settings_).decide({9.0, 9.0, 0.0, {0.1}}, asked_).scale, 0.0)
      << "it leads away from nothing";
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

TEST_F(Questions, OfACommandThatWasStoppedAreAboutMoreUntilAnotherOneComes) {
  settings_.deceleration = {2.0, 2.0};
  LimiterLaw law(settings_);
  asked_.certified = -1.0;
  const auto clearanceOf = [&](double now, std::vector<double> command) {
    asked_.clearances.clear();
    published(law, {now, now, 0.0, std::move(command)}, asked_);
    return asked_.clearances.front();
  };
  EXPECT_DOUBLE_EQ(clearanceOf(9.0, {0.1, 0.1}), 0.012);
  EXPECT_DOUBLE_EQ(clearanceOf(9.1, {0.1, 0.1}), 0.014);
  EXPECT_DOUBLE_EQ(clearanceOf(9.2, {0.3, 0.25}), 0.014) << "the same way";
  EXPECT_DOUBLE_EQ(clearanceOf(9.3, {0.1, 0.0}), 0.012) << "another way";
  EXPECT_DOUBLE_EQ(clearanceOf(9.4, {-0.1, 0.0}), 0.012) << "back";
  EXPECT_DOUBLE_EQ(clearanceOf(9.5, {-0.1, 0.0}), 0.014);
  publishStop(law, 9.6);
  EXPECT_DOUBLE_EQ(clearanceOf(9.7, {-0.1, 0.0}), 0.012) << "stopped for another reason";
}

// As long as a servo that leads along a wall goes on.
TEST_F(Questions, WhatWasNotStoppedForMayStayAsNearAsItIs) {
  settings_.deceleration = {2.0};
  for (const bool is_another : {true, false}) {
    LimiterLaw law(settings_);
    asked_ = Asked();
    asked_.certified = -1.0;
    EXPECT_EQ(published(law, {9.0, 9.0, 0.0, {0.1}}, asked_).scale, 0.0);
    asked_.certified = 1.0;
    asked_.nearest = 0.013;
    if (is_another) asked_.second = "wall";
    const double scale = published(law, {9.5, 9.5, 0.0, {0.1}}, asked_).scale;
    EXPECT_EQ(scale > 0.0, is_another);
  }
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

}  // namespace collision_pairs::test_limiter_questions
