// Padding is a distance: what it does to a pair, the plain scene says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "mixed_robot.h"
#include "refusal.h"

namespace collision_pairs::test_padding {

using testing::HasSubstr;

SceneDescription mixedDescription() {
  SceneDescription description;
  description.robots.push_back({mixedRobot(2), std::nullopt, ""});
  return description;
}

using Distances = std::map<std::pair<std::string, std::string>, PairReport>;

Distances distances(const CollisionScene& scene, const CollisionReport& report) {
  Distances found;
  for (const PairReport& pair : report.pairs) {
    found[{scene.models()[pair.first].name, scene.models()[pair.second].name}] = pair;
  }
  return found;
}

class Padding : public testing::Test {
 protected:
  Distances check(const SceneDescription& description, const BodyPoses& poses,
                  double alarm_distance, Fidelity fidelity = Fidelity::MESH) {
    const auto scene = CollisionScene::build(description);
    CollisionDetector detector(scene);
    CheckSettings settings;
    settings.alarm_distance = alarm_distance;
    settings.fidelity = fidelity;
    report_ = detector.detect(poses, settings);
    return distances(*scene, report_);
  }

  BodyPoses randomPoses(const SceneDescription& description) {
    BodyPoses poses;
    poses.resize(CollisionScene::build(description)->bodies().size());
    throwAbout(random_, 0.7, poses);
    return poses;
  }

  RandomInputs random_;
  CollisionReport report_;
};

TEST_F(Padding, TakesItsSumFromTheDistanceOfEachPair) {
  const double padding = 0.05, alarm = 0.1;
  const SceneDescription plain = mixedDescription();
  SceneDescription padded = plain;
  padded.settings.padding = padding;
  padded.settings.link_padding = {{"c", 0.02}, {"e", 0.0}};
  const auto of = [&](const std::string& link) {
    const auto own = padded.settings.link_padding.find(link);
    return own == padded.settings.link_padding.end() ? padding : own->second;
  };
  int nb_apart = 0;
  for (int round = 0; round < 40; ++round) {
    const BodyPoses poses = randomPoses(plain);
    const Distances with = check(padded, poses, alarm);
    const Distances without = check(plain, poses, alarm + 2 * padding);
    for (const auto& [names, pair] : without) {
      const double expected = pair.distance - of(names.first) - of(names.second);
      const auto found = with.find(names);
      ASSERT_EQ(found != with.end(), expected <= alarm) << names.first << "|" << names.second;
      if (found == with.end()) continue;
      EXPECT_NEAR(found->second.distance, expected, 1e-9) << names.first << "|" << names.second;
      EXPECT_EQ(found->second.state, expected <= 0.0 ? PairState::CONTACT : PairState::NEAR);
      nb_apart += pair.distance > 0.0;
    }
    for (const auto& entry : with) ASSERT_EQ(without.count(entry.first), 1u);
  }
  EXPECT_GT(nb_apart, 100);
}

TEST_F(Padding, OfALinkOfTheWorldIsItsOwn) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(1)), std::nullopt, ""});
  description.world = robotFrom(boxLink("wall", 1));
  description.settings.link_padding = {{"wall", 0.25}};
  BodyPoses poses;
  poses.resize(1);
  poses.X_WB[0].translation().x() = 1.5;
  EXPECT_NEAR(check(description, poses, 0.5).at({"a", "wall"}).distance, 0.25, 1e-9);
}

TEST_F(Padding, WitnessPointsAreApartByTheDistanceAlongTheNormal) {
  SceneDescription padded = mixedDescription();
  padded.settings.padding = 0.03;
  for (int round = 0; round < 20; ++round) {
    check(padded, randomPoses(padded), 0.2);
    for (const Contact& contact : report_.contacts) {
      const double along = contact.nhat_W.dot(contact.p_WSecond - contact.p_WFirst);
      EXPECT_NEAR(along, -contact.depth, 1e-6);
    }
  }
}

TEST_F(Padding, OfAPairStandsForTheSumAndTheLastThatMatchesCounts) {
  SceneDescription padded = mixedDescription();
  padded.settings.padding = 0.04;
  padded.settings.pair_padding = {{"*", "z", 0.3}, {"z", "a", 0.0}};
  const SceneDescription plain = mixedDescription();
  for (int round = 0; round < 20; ++round) {
    const BodyPoses poses = randomPoses(plain);
    const Distances with = check(padded, poses, 0.0);
    for (const auto& [names, pair] : check(plain, poses, 0.4)) {
      const bool has_z = names.second == "z";
      const double padding = !has_z ? 0.08 : names.first == "a" ? 0.0 : 0.3;
      EXPECT_EQ(with.count(names), pair.distance <= padding ? 1u : 0u)
          << names.first << "|" << names.second << " at " << pair.distance;
    }
  }
}

TEST_F(Padding, OfAPairIsTheSameInEitherOrder) {
  SceneDescription description = mixedDescription();
  description.world = robotFrom(boxLink("wall", 0.1));
  description.settings.pair_padding = {{NamePattern("*"), NamePattern("*"), 0.25}};
  const auto scene = CollisionScene::build(description);
  const auto size = static_cast<std::uint32_t>(scene->elements().size());
  for (std::uint32_t a = 0; a < size; ++a) {
    for (std::uint32_t b = 0; b < size; ++b) {
      if (!scene->filter().allowed(scene->elements()[a].model, scene->elements()[b].model))
        continue;
      EXPECT_EQ(scene->padding(a, b), 0.25) << a << ' ' << b;
    }
  }
}

// A verdict ends early where a report goes on to the boxes along the elements' axes.
TEST_F(Padding, MakesAPairAContactForTheVerdictWhereItDoesForTheReportAtEveryRung) {
  int nb_contacts = 0, nb_free = 0;
  for (const int max_hull_vertices : {0, 6}) {
    SceneDescription padded = mixedDescription();
    padded.settings.padding = random_.uniform(0.03, 0.2);
    padded.settings.max_hull_vertices = max_hull_vertices;
    const auto scene = CollisionScene::build(padded);
    CollisionDetector detector(scene);
    BodyPoses poses;
    poses.resize(scene->bodies().size());
    const auto nb_models = static_cast<std::uint32_t>(scene->models().size());
    for (int round = 0; round < 40; ++round) {
      throwAbout(random_, random_.uniform(0.5, 2.0), poses);
      for (std::uint32_t i = 0; i < nb_models * nb_models * 4; ++i) {
        const std::uint32_t a = i / 4 / nb_models, b = i / 4 % nb_models;
        if (a >= b) continue;
        CheckSettings settings;
        settings.fidelity =
            std::array{Fidelity::SPHERES, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}[i % 4];
        const auto isContact = [&](bool verdict_only) {
          settings.verdict_only = verdict_only;
          detector.beginNarrowPhase(poses, settings);
          detector.addCollisionPair(a, b);
          return detector.endNarrowPhase().in_collision;
        };
        const bool reported = isContact(false);
        ASSERT_EQ(isContact(true), reported) << fidelityName(settings.fidelity);
        ++(reported ? nb_contacts : nb_free);
      }
    }
  }
  EXPECT_GT(nb_contacts, 1000);
  EXPECT_GT(nb_free, 1000);
}

std::string refusalOf(const SceneDescription& description) {
  return refusal([&] { CollisionScene::build(description); });
}

TEST_F(Padding, BelowZeroOrNotANumberIsRefused) {
  const auto refusal = [](const SceneSettings& settings) {
    SceneDescription description = mixedDescription();
    description.settings = settings;
    return refusalOf(description);
  };
  for (const auto objects : {&SceneDescription::objects, &SceneDescription::clouds}) {
    SceneDescription description = mixedDescription();
    (description.*objects).push_back(cloudOf("thing", 0.1, {}));
    (description.*objects).back().padding = -0.01;
    EXPECT_THAT(refusalOf(description), HasSubstr("the padding of object 'thing' is -0.01"));
  }
  SceneSettings settings;
  settings.padding = -0.01;
  EXPECT_THAT(refusal(settings), HasSubstr("padding is -0.01"));
  settings = {};
  settings.link_padding["c"] = std::nan("");
  EXPECT_THAT(refusal(settings), HasSubstr("link_padding of 'c'"));
  settings = {};
  settings.link_padding["cc"] = 0.1;
  EXPECT_THAT(refusal(settings), HasSubstr("'c'?"));
  settings = {};
  settings.pair_padding = {{"a", "b", INFINITY}};
  EXPECT_THAT(refusal(settings), HasSubstr("pair_padding of 'a' and 'b'"));
}

TEST(SettingsOfLinks, RefuseNamesOfWhatTheyAreNotAppliedTo) {
  for (const auto things : {&SceneDescription::objects, &SceneDescription::clouds}) {
    SceneDescription plain = mixedDescription();
    (plain.*things).push_back(cloudOf("thing", 0.1, {}));
    SceneDescription padded = plain, ignored = plain, capsule = plain, pattern = plain;
    padded.settings.link_padding["thing"] = 0.1;
    ignored.settings.ignored_links = {"thing"};
    capsule.settings.cylinder_as_capsule = {"thing"};
    EXPECT_THAT(refusalOf(padded), HasSubstr("link_padding names 'thing', which is not a link"));
    EXPECT_THAT(refusalOf(ignored), HasSubstr("ignored_links names 'thing', which is not a link"));
    EXPECT_THAT(refusalOf(capsule), HasSubstr("cylinder_as_capsule names 'thing', which is not"));
    pattern.settings.ignored_links = pattern.settings.cylinder_as_capsule = {"thin*"};
    EXPECT_GE(CollisionScene::build(pattern)->findModel("thing"), 0);
  }
}

TEST(CylinderAsCapsule, EnclosesTheCylinderAndIsForTheNamedLinksOnly) {
  SceneDescription description = mixedDescription();
  description.settings.cylinder_as_capsule = {"b"};
  const auto scene = CollisionScene::build(description);
  const auto shapeOf = [&](const std::string& link) {
    const auto& model = scene->models()[static_cast<std::size_t>(scene->findModel(link))];
    return scene->elements()[model.first_element].shape;
  };
  const Shape of_b = shapeOf("b");
  const auto* capsule = std::get_if<Capsule>(&of_b);
  ASSERT_NE(capsule, nullptr);
  EXPECT_EQ(capsule->radius, 0.1);
  EXPECT_EQ(capsule->length, 0.3);
  EXPECT_TRUE(std::holds_alternative<Cylinder>(shapeOf("j")));
}

}  // namespace collision_pairs::test_padding
