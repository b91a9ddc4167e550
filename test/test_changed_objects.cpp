// What a change of objects refuses, leaves to a build, or does without one.
#include <mutex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/batch_check.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/motion_check.h"
#include "demo_scene.h"
#include "refusal.h"
#include "scene_inputs.h"

namespace collision_pairs::test_changed_objects {

using testing::HasSubstr;

RigidObject box(const std::string& name, double x) {
  RigidObject object;
  object.name = name;
  object.elements.push_back({Box{{0.1, 0.1, 0.1}}, Eigen::Isometry3d::Identity()});
  object.X_PO.translation().x() = x;
  return object;
}

RigidObject onLink(const std::string& link, RigidObject object) {
  object.attached_link = link;
  return object;
}

/// Two sliding boxes and the objects near and far.
class Changed : public testing::Test {
 protected:
  Changed() {
    description_.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
    description_.objects = {box("far", 50), box("near", 3)};
    scene_ = CollisionScene::build(description_);
  }
  std::string refusal(const SceneChanges& changes) {
    return collision_pairs::refusal([&] { scene_->with(changes); });
  }
  SceneDescription description_;
  std::shared_ptr<const CollisionScene> scene_;
};

TEST_F(Changed, WhatIsWrongIsNamedAsByABuild) {
  EXPECT_THAT(refusal({{}, {"nea"}}), HasSubstr("no object 'nea' to remove; did you mean 'near'?"));
  EXPECT_THAT(refusal({{box("a", 0)}, {}}), HasSubstr("object 'a' has the name of a link"));
  EXPECT_THAT(refusal({{box("", 0)}, {}}), HasSubstr("no name"));
  EXPECT_THAT(refusal({{box("new", 0), box("new", 5)}, {}}), HasSubstr("'new' is given twice"));
  RigidObject bad = box("bad", 0);
  bad.touch_links = {"nowhere"};
  EXPECT_THAT(refusal({{bad}, {}}), HasSubstr("'nowhere'"));
  bad = box("bad", 1e308);
  bad.X_PO.translation().y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal({{bad}, {}}), HasSubstr("'bad' is too large or too far away"));
  bad = box("bad", 0);
  bad.X_PO.linear() *= 1.001;
  EXPECT_THAT(refusal({{bad}, {}}), HasSubstr("object 'bad': its pose, or that of a shape, is no"));
  bad = box("bad", 0);
  bad.elements[0].X_LE.linear().col(1) *= -1.0;
  EXPECT_THAT(refusal({{bad}, {}}), HasSubstr("object 'bad': its pose, or that of a shape, is no"));
  bad = box("bad", 0);
  bad.padding = -1.0;
  EXPECT_THAT(refusal({{bad}, {}}), HasSubstr("the padding of object 'bad'"));
  bad = box("bad", 0);
  bad.elements[0].shape = vastMesh();
  EXPECT_THAT(refusal({{bad}, {}}), HasSubstr("'bad' is too large or too far away"));
  bad.elements[0].shape = Sphere{-1.0};
  EXPECT_THAT(refusal({{bad}, {}}), HasSubstr("a shape of the scene"));
  bad.elements[0].shape = Mesh{nullptr};
  EXPECT_THAT(refusal({{bad}, {}}), HasSubstr("object 'bad' has a mesh without data"));
}

TEST_F(Changed, WhatADescriptionNamesIsNotRemoved) {
  using Naming = std::function<void(SceneDescription&)>;
  const std::vector<std::pair<std::string, Naming>> by = {
      {"link_fidelity", [](auto& d) { d.settings.link_fidelity["far"] = Fidelity::AABB; }},
      {"pair_rules",
       [](auto& d) {
         d.settings.pair_rules = {{PairRule::Verdict::DENY, "far", "near"}};
       }},
      {"pair_rules",
       [](auto& d) {
         d.settings.pair_rules = {{PairRule::Verdict::DENY, "near", "far"}};
       }},
      {"pair_padding",
       [](auto& d) {
         d.settings.pair_padding = {{"far", "near", 0.1}};
       }},
      {"pair_padding",
       [](auto& d) {
         d.settings.pair_padding = {{"near", "far", 0.1}};
       }},
      {"the restriction", [](auto& d) { d.restriction.names = {"far"}; }},
      {"object 'near', touch_links", [](auto& d) { d.objects[1].touch_links = {"far"}; }},
      {"cloud 'cloud', touch_links", [](auto& d) { d.clouds[0].touch_links = {"far"}; }},
  };
  description_.clouds = {cloudOf("cloud", 0.125, {})};
  for (const auto& [where, name] : by) {
    SceneDescription description = description_;
    name(description);
    scene_ = CollisionScene::build(description);
    EXPECT_THAT(refusal({{}, {"far"}}), HasSubstr(where + " names 'far'"));
  }
}

TEST_F(Changed, TheNarrowPhaseIsStillTheOneThatWasAskedFor) {
  description_.settings.narrow_phase = NarrowPhaseMethod::FCL;
  scene_ = CollisionScene::build(description_)->with({{box("new", 5)}, {"far"}});
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  EXPECT_EQ(CollisionDetector(scene_).detect(poses, {}).narrow_phase, NarrowPhaseMethod::FCL);
}

TEST_F(Changed, WithoutItsOnlyPairIsUncheckedAndWithItIsNotWhateverStays) {
  description_.objects = {onLink("a", box("near_a", 0)), onLink("b", box("near_b", 0))};
  description_.settings.pair_rules = {{PairRule::Verdict::DENY, "?", "*"}};
  const auto with_both = CollisionScene::build(description_);
  const auto without = with_both->with({{}, {"near_a", "near_b"}});
  EXPECT_EQ(without->unchecked(), "there is no pair to check");
  EXPECT_EQ(CollisionDetector(without).detect({}, {}).verdict, Verdict::UNKNOWN);
  EXPECT_EQ(without->with({description_.objects, {}})->unchecked(), "");
}

TEST_F(Changed, ALinkThatComesIntoItsFirstPairMustHaveItsGeometry) {
  description_.settings.pair_rules = {{PairRule::Verdict::DENY, "b", "a"},
                                      {PairRule::Verdict::DENY, "b", "far"},
                                      {PairRule::Verdict::DENY, "b", "near"}};
  const auto scene = CollisionScene::build(withNeededGeometry(description_));
  EXPECT_EQ(scene->findModel("b"), -1);
  const SceneChanges attached{{onLink("a", box("held", 0))}, {}};
  EXPECT_EQ(scene->withAlike(attached), nullptr);
  EXPECT_EQ(collision_pairs::refusal([&] { scene->with(attached); }),
            "link 'b' is in a pair now, but its geometry was left out");
  EXPECT_GE(CollisionScene::build(description_)->with(attached)->findModel("b"), 0);
}

TEST_F(Changed, ALinkWhoseGeometryCouldNotBeReadStaysLeftOut) {
  description_.robots[0].model = description_.robots[0].model->withElements(
      [](const Link& link) { return link.name == "b" ? std::vector<Element>{} : link.elements; });
  const auto alike = CollisionScene::build(description_)->withAlike({{box("new", 5)}, {}});
  ASSERT_NE(alike, nullptr);
  ASSERT_EQ(alike->missing().size(), 1u);
  EXPECT_EQ(alike->missing().count("b"), 1u);
  const SceneChanges all_gone{{}, {"far", "near", "new"}};
  EXPECT_EQ(alike->withAlike(all_gone), nullptr);
  EXPECT_EQ(collision_pairs::refusal([&] { alike->with(all_gone); }), "accepted");
}

TEST_F(Changed, AnIncompleteLinkThatComesIntoItsFirstPairIsMissingFromThenOn) {
  description_.settings.pair_rules = {{PairRule::Verdict::DENY, "b", "a"},
                                      {PairRule::Verdict::DENY, "b", "far"},
                                      {PairRule::Verdict::DENY, "b", "near"}};
  description_.robots[0].model = description_.robots[0].model->withElements(
      [](const Link& link) { return link.elements; },
      [](const Link& link) { return std::vector<std::string>(link.name == "b", "no such file"); });
  const auto scene = CollisionScene::build(description_);
  EXPECT_TRUE(scene->missing().empty());
  const auto with_it = scene->with({{onLink("a", box("held", 0))}, {}});
  ASSERT_EQ(with_it->missing().count("b"), 1u);
  EXPECT_EQ(with_it->missing().at("b"), std::vector<std::string>{"no such file"});
}

// By one check, a motion, and so many states that the batch stage could answer.
TEST_F(Changed, WithoutTheGeometryOfALinkInAPairOrAPartOfItNothingIsFree) {
  const auto whole = description_.robots[0].model;
  const auto without = whole->withElements(
      [](const Link& link) { return link.name == "b" ? std::vector<Element>{} : link.elements; });
  const auto incomplete = whole->withElements(
      [](const Link& link) { return link.elements; },
      [](const Link& link) { return std::vector<std::string>(link.name == "b", "no such file"); });
  const std::vector<std::string> why = {"geometry that could not be read: b"};
  for (const int variant : {0, 1, 2, 3}) {
    description_.settings.allow_empty_scene = variant % 2 > 0;
    description_.robots[0].model = variant > 1 ? incomplete : without;
    const auto scene = CollisionScene::build(description_);
    EXPECT_FALSE(scene->mayBeFree());
    const std::vector<double> apart = {10.0, 14.0}, touching = {3.0, 14.0};
    const auto verdicts = [&](std::size_t count, const std::vector<double>& positions) {
      CheckSettings settings;
      settings.verdict_only = true;
      std::set<Verdict> found;
      std::mutex mutex;
      BatchCheck(scene).runJoints(
          count, settings, [&](std::size_t, std::vector<double>& q) { q = positions; }, {},
          [&](std::size_t, const CollisionReport& report) {
            const std::lock_guard<std::mutex> lock(mutex);
            found.insert(report.verdict);
            if (report.verdict == Verdict::UNKNOWN) {
              EXPECT_EQ(report.unknown_because, why);
            }
          });
      return found;
    };
    for (const std::size_t count : {1, 40000}) {
      EXPECT_EQ(verdicts(count, apart), std::set<Verdict>{Verdict::UNKNOWN});
      EXPECT_EQ(verdicts(count, touching), std::set<Verdict>{Verdict::COLLISION});
    }
    for (const bool only_free : {false, true}) {
      MotionSettings settings;
      settings.only_free = only_free;
      const MotionReport report = MotionCheck(scene).check({apart, {12.0, 14.0}}, settings);
      EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
      EXPECT_EQ(report.unknown_because, why);
      EXPECT_EQ(report.free_until, 0.0);
    }
  }
}

TEST_F(Changed, TheLastObjectTakesItsPairsWithIt) {
  description_.robots = {{robotFrom(slidingBoxes(1)), std::nullopt, ""}};
  scene_ = CollisionScene::build(description_);
  EXPECT_EQ(scene_->withAlike({{}, {"far", "near"}}), nullptr);
  EXPECT_EQ(scene_->with({{}, {"far", "near"}})->unchecked(), "there is no pair to check");
  EXPECT_NE(scene_->withAlike({{}, {"far"}}), nullptr);
}

TEST_F(Changed, AttachedAndDetachedWithoutABuild) {
  const auto held = scene_->withAlike({{onLink("a", box("near", 3))}, {}});
  ASSERT_NE(held, nullptr);
  const auto handed_over = held->withAlike({{onLink("b", box("near", 3))}, {}});
  ASSERT_NE(handed_over, nullptr);
  EXPECT_NE(handed_over->withAlike({{box("near", 3)}, {}}), nullptr);
  EXPECT_NE(handed_over->withAlike({{}, {"near"}}), nullptr);
}

TEST_F(Changed, WhatIsAttachedIsStillWhatATouchLinkNames) {
  description_.objects.push_back(box("third", 6));
  description_.objects.push_back(box("toucher", 9));
  description_.objects.back().touch_links = {"near"};
  scene_ = CollisionScene::build(description_)->with({{onLink("a", box("near", 3))}, {}});
  const auto allowed = [&](const char* a, const char* b) {
    return scene_->filter().allowed(scene_->findModel(a), scene_->findModel(b));
  };
  EXPECT_FALSE(allowed("near", "toucher"));
  EXPECT_TRUE(allowed("near", "third"));
}

TEST_F(Changed, TheOldSceneIsAsItWas) {
  BodyPoses poses;
  poses.resize(2);
  poses.X_WB[1].translation().x() = 5.0;
  CollisionDetector before(scene_);
  EXPECT_EQ(before.detect(poses, {}).verdict, Verdict::FREE);
  const auto after = scene_->with({{box("here", 0)}, {"near"}});
  EXPECT_EQ(CollisionDetector(after).detect(poses, {}).verdict, Verdict::COLLISION);
  EXPECT_EQ(before.detect(poses, {}).verdict, Verdict::FREE);
  EXPECT_EQ(scene_->objects().size(), 2u);
  EXPECT_GE(scene_->findModel("near"), 0);
  EXPECT_EQ(after->findModel("near"), -1);
  ASSERT_EQ(after->objects().size(), 2u);
  EXPECT_EQ(after->objects()[1]->name, "here");
}

}  // namespace collision_pairs::test_changed_objects
