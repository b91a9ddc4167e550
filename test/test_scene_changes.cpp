// A scene that was changed is the scene that is built of the changed description.
#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/occupied_voxels.h"
#include "everything_in.h"
#include "random_robot.h"
#include "refusal.h"
#include "scene_inputs.h"

namespace collision_pairs::test_scene_changes {

/// A description, and what random changes make of it, one object at a time: the oracle.
class Objects {
 public:
  Objects(RandomInputs& random, SceneDescription description)
      : random_(random), description_(std::move(description)) {}

  const SceneDescription& description() const { return description_; }

  SceneChanges change() {
    SceneChanges changes;
    for (int i = random_.integer(1, 3); i > 0; --i) {
      const int kind = random_.integer(0, 12);
      auto& objects = description_.objects;
      const bool is_add = kind < 4 || objects.empty();
      const auto one = static_cast<std::size_t>(
          is_add ? 0 : random_.integer(0, static_cast<int>(objects.size()) - 1));
      if (is_add) {
        put(changed(changes, newObject()));
      } else if (kind < 7) {
        RigidObject moved = objects[one];
        moved.X_PO = random_.pose(1.0);
        put(changed(changes, moved));
      } else if (kind < 9) {
        const bool is_in_it =
            std::any_of(changes.objects.begin(), changes.objects.end(),
                        [&](const auto& o) { return o.name == objects[one].name; });
        if (is_in_it) continue;  // what is removed comes first
        changes.removed.push_back(objects[one].name);
        objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(one));
      } else {
        RigidObject attached = objects[one];
        const bool is_detach = !attached.attached_link.empty() && random_.integer(0, 2) > 0;
        attached.attached_link = is_detach ? "" : link();
        attached.X_PO = random_.pose(0.2);
        if (random_.integer(0, 2) == 0) attached.touch_links = {link(), link()};
        put(changed(changes, attached));
      }
    }
    return changes;
  }

 private:
  std::string link() {
    const char* const links[] = {"left/link_0", "left/link_1", "left/link_2", "right/link_0",
                                 "right/link_1"};
    return links[random_.integer(0, 4)];  // the last of either robot need not be there
  }

  /// Each object once.
  static const RigidObject& changed(SceneChanges& changes, const RigidObject& object) {
    for (RigidObject& given : changes.objects) {
      if (given.name == object.name) return given = object;
    }
    changes.objects.push_back(object);
    return object;
  }

  RigidObject newObject() {
    RigidObject object;
    object.name = std::string(1, static_cast<char>('a' + random_.integer(0, 25))) + "_box";
    const Shape shapes[] = {Box{{0.2, 0.2, 0.1}}, Sphere{0.1}, meshShape(LShape().mesh())};
    for (int i = random_.integer(1, 2); i > 0; --i) {
      object.elements.push_back({shapes[random_.integer(0, 2)], random_.pose(0.2)});
    }
    object.X_PO = random_.pose(1.0);
    if (random_.integer(0, 4) == 0) object.padding = 0.02;
    if (random_.integer(0, 4) == 0) object.touch_links = {"left/link_0"};
    if (random_.integer(0, 9) == 0) object.touch_links = {"m_box"};   // there may be none
    if (random_.integer(0, 49) == 0) object.touch_links = {"?_box"};  // no name, but some rule's
    if (random_.integer(0, 49) == 0) object.elements[0].shape = vastMesh();
    return object;
  }

  void put(const RigidObject& object) {
    for (RigidObject& known : description_.objects) {
      if (known.name == object.name) {
        known = object;
        return;
      }
    }
    description_.objects.push_back(object);
  }

  RandomInputs& random_;
  SceneDescription description_;
};

void expectSameElements(const CollisionScene& found, const CollisionScene& expected) {
  ASSERT_EQ(found.elements().size(), expected.elements().size());
  ASSERT_EQ(found.nbStaticElements(), expected.nbStaticElements());
  for (std::uint32_t e = 0; e < found.elements().size(); ++e) {
    const SceneElement &a = found.elements()[e], &b = expected.elements()[e];
    EXPECT_EQ(a.model, b.model);
    EXPECT_EQ(a.body, b.body);
    EXPECT_EQ(a.finest, b.finest);
    EXPECT_EQ(a.X_BE.matrix(), b.X_BE.matrix());
    EXPECT_EQ(a.padding, b.padding);
    EXPECT_EQ(a.box_padding, b.box_padding);
    EXPECT_EQ(a.shape.index(), b.shape.index());
    EXPECT_EQ(found.cloudOf(e), expected.cloudOf(e));
    for (const Fidelity f : {Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
      EXPECT_EQ(a.rung(f).shape == nullptr, b.rung(f).shape == nullptr);
    }
    if (e >= found.nbStaticElements()) continue;
    EXPECT_EQ(found.staticBoxes().box(e).min, expected.staticBoxes().box(e).min);
    EXPECT_EQ(found.staticBoxes().box(e).max, expected.staticBoxes().box(e).max);
    EXPECT_EQ(found.staticBoxes().model(e), b.model);
    for (std::uint32_t other = 0; other < found.elements().size(); ++other) {
      EXPECT_EQ(found.padding(e, other), expected.padding(e, other));
    }
  }
}

void expectSameModels(const CollisionScene& found, const CollisionScene& expected) {
  ASSERT_EQ(found.models().size(), expected.models().size());
  ASSERT_EQ(found.bodies().size(), expected.bodies().size());
  EXPECT_EQ(found.unchecked(), expected.unchecked());
  EXPECT_EQ(found.openMeshes(), expected.openMeshes());
  EXPECT_EQ(found.staticBoxes().bounds().min, expected.staticBoxes().bounds().min);
  EXPECT_EQ(found.staticBoxes().bounds().max, expected.staticBoxes().bounds().max);
  for (std::uint32_t m = 0; m < found.models().size(); ++m) {
    const CollisionModel &a = found.models()[m], &b = expected.models()[m];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.body, b.body);
    EXPECT_EQ(a.first_element, b.first_element);
    EXPECT_EQ(a.nb_elements, b.nb_elements);
    EXPECT_EQ(a.is_object, b.is_object);
    EXPECT_EQ(a.attached_link, b.attached_link);
    for (std::uint32_t other = 0; other < found.models().size(); ++other) {
      EXPECT_EQ(found.filter().allowed(m, other), expected.filter().allowed(m, other));
    }
  }
}

/// To the last bit; both scenes have the same models.
void expectSameReports(RandomInputs& random, const std::shared_ptr<const CollisionScene>& found,
                       const std::shared_ptr<const CollisionScene>& expected,
                       const CloudVoxels& voxels, int& nb_pairs) {
  CollisionDetector a(found), b(expected);
  std::vector<Eigen::Isometry3d> X_RB;
  found->robot().forwardKinematics(randomPositions(random, found->robot()), X_RB);
  BodyPoses poses;
  found->gatherPoses(X_RB, poses);
  if (!found->clouds().empty()) poses.voxels = voxels;
  CheckSettings settings;
  settings.min_distance = random.integer(0, 1);
  const CollisionReport& report = a.detect(poses, settings);
  ASSERT_EQ(everythingIn(report), everythingIn(b.detect(poses, settings)));
  nb_pairs += static_cast<int>(report.pairs.size());
}

SceneDescription randomStart(RandomInputs& random, CloudVoxels& voxels) {
  SceneDescription description = randomScene(random);
  SceneSettings& settings = description.settings;
  if (random.integer(0, 2) == 0) {
    settings.pair_rules.push_back({PairRule::Verdict::DENY, "[a-m]_box", "right/*"});
  }
  if (random.integer(0, 2) == 0) {
    settings.pair_padding.push_back({"[h-z]_box", "left/link_*", 0.04});
  }
  if (random.integer(0, 4) == 0) description.restriction.names = {"left/link_1", "[a-f]_box"};
  if (random.integer(0, 4) == 0)
    settings.pair_rules.push_back({PairRule::Verdict::DENY, "*", "?_box"});
  if (random.integer(0, 3) == 0) {  // there may be no pair left
    settings.pair_rules = {{PairRule::Verdict::DENY, "*", "*"},
                           {PairRule::Verdict::ALLOW, "?_box", "?_box"}};
  } else if (random.integer(0, 3) == 0) {
    description.clouds.push_back(cloudOf("m_cloud", 0.1, {}));
    voxels = {std::make_shared<const OccupiedVoxels>(
        0.1, std::vector<VoxelCell>{{1, 2, 3}, {0, 0, -4}, {-3, 2, 0}})};
  }
  return description;
}

bool movesAny(const SceneChanges& changes) {
  return std::any_of(changes.objects.begin(), changes.objects.end(),
                     [](const RigidObject& object) { return !object.attached_link.empty(); });
}

TEST(ASceneThatWasChanged, IsTheSceneBuiltOfTheChangedDescription) {
  RandomInputs random;
  int nb_pairs = 0, nb_alike = 0, nb_attached = 0, nb_built = 0, nb_refused = 0, nb_empty = 0;
  for (int round = 0; round < 100; ++round) {
    CloudVoxels voxels;
    Objects objects(random, randomStart(random, voxels));
    SceneCache cache;
    auto scene = CollisionScene::build(objects.description(), &cache);
    auto needed = CollisionScene::build(withNeededGeometry(objects.description()), &cache);
    for (int step = 0; step < 12; ++step) {
      const Objects before = objects;
      const SceneChanges changes = objects.change();
      std::shared_ptr<const CollisionScene> expected, alike;
      const std::string problem =
          refusal([&] { expected = CollisionScene::build(objects.description()); });
      EXPECT_EQ(refusal([&] {
                  alike = scene->withAlike(changes, random.integer(0, 1) ? &cache : nullptr);
                  scene = scene->with(changes, &cache);
                }),
                problem);
      ++(alike ? nb_alike : expected ? nb_built : nb_refused);
      if (alike && movesAny(changes)) ++nb_attached;
      if (!expected) break;
      const auto needed_alike = needed->withAlike(changes, &cache);
      EXPECT_EQ(needed_alike != nullptr, alike != nullptr);
      needed = needed_alike ? needed_alike
                            : CollisionScene::build(withNeededGeometry(objects.description()));
      nb_empty += expected->models().empty();
      for (const auto& made : {scene, alike, needed}) {
        if (!made) continue;
        expectSameModels(*made, *expected);
        expectSameElements(*made, *expected);
        expectSameReports(random, made, expected, voxels, nb_pairs);
      }
      ASSERT_FALSE(HasFailure()) << "round " << round << ", step " << step;
    }
  }
  EXPECT_GT(nb_pairs, 200);
  EXPECT_GT(nb_alike, 100);
  EXPECT_GT(nb_attached, 30);
  EXPECT_GT(nb_built, 50);
  EXPECT_GT(nb_refused, 0);
  EXPECT_GT(nb_empty, 10);
}

}  // namespace collision_pairs::test_scene_changes
