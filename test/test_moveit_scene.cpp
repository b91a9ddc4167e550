// What the detector for MoveIt does without types of MoveIt: rules and scenes.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <octomap/OcTree.h>

#include "collision_pairs/input_error.h"
#include "moveit_scene.h"

namespace collision_pairs::test_moveit_scene {

using Eigen::Isometry3d;
using Eigen::Translation3d;
using testing::ElementsAre;
using testing::IsEmpty;

MoveitBody link(const std::string& name, int index) { return {name, index, false, {}}; }

TEST(AllowedContact, IsThatOfTheMatrixUnlessAnAttachedBodyMayTouch) {
  int nb_asked = 0;
  const auto entry = [&] {
    ++nb_asked;
    return AllowedContact::CONDITIONAL;
  };
  const MoveitBody hand = link("hand", 3), finger = link("finger", 4);
  const MoveitBody cup{"cup", 3, true, {"finger", "lid"}}, plate{"plate", 3, true, {}};
  const MoveitBody lid{"lid", 4, true, {}};
  const auto expectAlways = [&](const MoveitBody& a, const MoveitBody& b) {
    EXPECT_EQ(allowedContact(&a, &b, entry), AllowedContact::ALWAYS) << a.name << b.name;
    EXPECT_EQ(allowedContact(&b, &a, entry), AllowedContact::ALWAYS) << a.name << b.name;
  };
  expectAlways(cup, finger);  // a touch link
  expectAlways(cup, plate);   // attached to the same link
  EXPECT_EQ(nb_asked, 0);
  EXPECT_EQ(allowedContact(&cup, &hand, entry), AllowedContact::CONDITIONAL);  // carries it
  EXPECT_EQ(allowedContact(&cup, &lid, entry), AllowedContact::CONDITIONAL);   // no link
  EXPECT_EQ(allowedContact(&hand, &finger, entry), AllowedContact::CONDITIONAL);
  EXPECT_EQ(allowedContact(&cup, nullptr, entry), AllowedContact::CONDITIONAL);
  EXPECT_EQ(nb_asked, 4);
}

TEST(AContinuousJoint, TurnsTheShorterWay) {
  EXPECT_NEAR(endOfTurn(3.0, -3.0), 2.0 * M_PI - 3.0, 1e-12);
  EXPECT_NEAR(endOfTurn(-3.0, 3.0), 3.0 - 2.0 * M_PI, 1e-12);
  EXPECT_NEAR(endOfTurn(0.5, 1.0), 1.0, 1e-12);
  EXPECT_NEAR(endOfTurn(0.0, 10.0), 10.0 - 2.0 * M_PI, 1e-12) << "not shorter, but MoveIt's";
  EXPECT_NEAR(endOfTurn(0.0, -10.0), 2.0 * M_PI - 10.0, 1e-12);
  EXPECT_EQ(endOfTurn(0.0, M_PI), M_PI);
}

TEST(AMimicJoint, EndsWhereItsLeaderPutsItOrNotAtAll) {
  const double leader = endOfTurn(3.0, -3.0);  // passes pi
  EXPECT_NEAR(*endOfMimic(leader, 1.0, 0.2, -2.8, true), leader + 0.2, 1e-12);
  EXPECT_NEAR(*endOfMimic(leader, -2.0, 0.0, 6.0, true), -2.0 * leader, 1e-12) << "two turns";
  EXPECT_FALSE(endOfMimic(leader, 0.5, 0.0, -1.5, true)) << "jumps by half a turn at pi";
  EXPECT_FALSE(endOfMimic(leader, 1.0, 0.0, -3.0, false)) << "a slide jumps at pi";
  EXPECT_NEAR(*endOfMimic(0.5, 0.5, 0.1, 0.35, false), 0.35, 1e-12);
  EXPECT_FALSE(endOfMimic(0.5, 0.5, 0.1, 0.36, true)) << "not where its leader puts it";
  EXPECT_FALSE(endOfMimic(0.5, 0.5, 0.1, std::numeric_limits<double>::quiet_NaN(), true));
}

class AScene : public testing::Test {
 protected:
  AScene() {
    for (int i = 0; i < 3; ++i) {
      moving_.push_back({link("link[" + std::to_string(i) + "]", i), {ball()}, 0.0});
    }
  }
  static Element ball() { return {Sphere{0.5}, Isometry3d::Identity()}; }
  static RigidObject objectAt(const std::string& name, double x) {
    RigidObject object;
    object.name = name;
    object.elements = {ball()};
    object.X_PO.translation().x() = x;
    return object;
  }
  /// The links, and what is attached to them, at x = 0, 10, 20; in the frame of an octree.
  static void setPoses(const MoveitScene& scene, double moved, BodyPoses& poses) {
    poses.resize(scene.scene().bodies().size());
    for (std::size_t i = 0; i < poses.X_WB.size(); ++i) {
      poses.X_WB[i].translation().x() = 10.0 * scene.moving(i).link;
      if (scene.moving(i).link == 0) poses.X_WB[i].translation().x() += moved;
    }
    if (scene.octree()) scene.toOctree(poses);
  }
  Verdict check(const MoveitScene& scene, double moved = 0.0) const {
    const MoveitScene::Lease worker = scene.lease();
    setPoses(scene, moved, worker->poses);
    return worker->detector.detect(worker->poses, CheckSettings()).verdict;
  }
  /// "a b" for each pair that is asked about and touches, sorted.
  std::vector<std::string> contactsOf(const MoveitScene& scene, double moved) const {
    const MoveitScene::Lease worker = scene.lease();
    setPoses(scene, moved, worker->poses);
    if (scene.readsLeaves()) {
      worker->poses.voxels =
          voxelsOf(scene.resolution(), scene.leavesWithin(0.0, nullptr, *worker));
    }
    std::vector<std::string> contacts;
    const auto& models = scene.scene().models();
    for (const PairReport& pair : worker->detector.detect(worker->poses, CheckSettings()).pairs) {
      const bool is_asked = scene.isAsked(models[pair.first], models[pair.second]);
      if (!is_asked || pair.state != PairState::CONTACT) continue;
      const std::string a = nameOf(scene, pair.first), b = nameOf(scene, pair.second);
      contacts.push_back(std::min(a, b) + " " + std::max(a, b));
    }
    std::sort(contacts.begin(), contacts.end());
    return contacts;
  }
  static std::string nameOf(const MoveitScene& scene, std::uint32_t model) {
    return scene.nameOf(scene.scene().models()[model]);
  }

  std::vector<MovingBody> moving_;
  SceneCache cache_;
};

TEST_F(AScene, HasEachLinkAsABodyOfItsOwn) {
  const auto self = MoveitScene::ofSelf(moving_, cache_);
  EXPECT_TRUE(self->hasPairs());
  EXPECT_EQ(self->scene().bodies().size(), 3u);
  EXPECT_EQ(check(*self), Verdict::FREE);
  EXPECT_EQ(check(*self, 9.5), Verdict::COLLISION);  // no two are taken for neighbours
  moving_[1].padding = 0.3;
  EXPECT_EQ(check(*MoveitScene::ofSelf(moving_, cache_), 8.8), Verdict::COLLISION);
  EXPECT_EQ(check(*self, 8.8), Verdict::FREE);
  moving_[1].elements[0].X_LE.linear() *= 1.0 + 1e-4;  // a quaternion of four digits
  EXPECT_EQ(check(*MoveitScene::ofSelf(moving_, cache_)), Verdict::FREE);
}

TEST_F(AScene, OfAWorldChangesWithTheFirstAndLastObject) {
  const auto empty = MoveitScene::ofWorld(moving_, {}, {}, cache_);
  EXPECT_FALSE(empty->hasPairs());
  const auto one = empty->with({{objectAt("box[1]", 10.0)}, {}}, {}, cache_);
  EXPECT_TRUE(one->hasPairs());
  EXPECT_TRUE(one->hasObject("box[1]"));
  EXPECT_FALSE(one->hasObject("box[2]"));
  EXPECT_EQ(check(*one), Verdict::COLLISION);
  EXPECT_EQ(check(*one, 10.0), Verdict::COLLISION);
  const auto moved = one->with({{objectAt("box[1]", 30.0)}, {}}, {}, cache_);
  EXPECT_EQ(check(*moved), Verdict::FREE);
  EXPECT_EQ(check(*moved, 10.0), Verdict::FREE);  // links are not checked against each other
  EXPECT_FALSE(moved->with({{}, {"box[1]"}}, {}, cache_)->hasPairs());
  EXPECT_EQ(&moved->scene().robot(), &empty->scene().robot());
}

TEST_F(AScene, RefusesAnObjectWithTheNameThatItUsesItself) {
  const auto world = MoveitScene::ofWorld(moving_, {objectAt("box", 30.0)}, {}, cache_);
  std::string taken;
  for (const CollisionModel& model : world->scene().models()) {
    if (MoveitScene::isPlaceholder(model.name)) taken = model.name;
  }
  ASSERT_NE(taken, "");
  EXPECT_THROW(world->with({{objectAt(taken, 10.0)}, {}}, {}, cache_), InputError);
  EXPECT_THROW(MoveitScene::ofWorld(moving_, {objectAt(taken, 10.0)}, {}, cache_), InputError);
}

TEST_F(AScene, CallsItsModelsAsMoveItDoes) {
  moving_.push_back({{"box", 2, true, {}}, {ball()}, 0.0});  // attached, called as an object
  const auto world = MoveitScene::ofWorld(moving_, {objectAt("box", 50.0)}, {}, cache_);
  std::vector<std::string> links, attached, objects;
  for (std::uint32_t m = 0; m < world->scene().models().size(); ++m) {
    const CollisionModel& model = world->scene().models()[m];
    const MoveitBody* body = world->movingOf(model);
    if (!body && MoveitScene::isPlaceholder(model.name)) continue;
    (!body ? objects : body->is_attached ? attached : links).push_back(nameOf(*world, m));
  }
  EXPECT_THAT(links, ElementsAre("link[0]", "link[1]", "link[2]"));
  EXPECT_THAT(attached, ElementsAre("box"));
  EXPECT_THAT(objects, ElementsAre("box"));
}

TEST_F(AScene, TakesAttachedBodiesAsABuildDoes) {
  const std::vector<RigidObject> objects = {objectAt("box", 30.0), objectAt("cup", 80.0)};
  const auto self = MoveitScene::ofSelf(moving_, cache_);
  const auto world = MoveitScene::ofWorld(moving_, objects, {}, cache_);
  moving_.push_back({{"cup", 2, true, {}}, {ball()}, 0.3});
  moving_.push_back({{"lid", 0, true, {"link[1]"}}, {ball(), ball()}, 0.0});
  moving_.back().elements[1].X_LE.translation().x() = 1.75;
  const auto with_self = self->withAttached(moving_, cache_);
  const auto with_world = world->withAttached(moving_, cache_);
  ASSERT_TRUE(with_self && with_world);
  EXPECT_EQ(&with_self->scene().robot(), &self->scene().robot()) << "a build";
  EXPECT_EQ(&with_world->scene().robot(), &world->scene().robot()) << "a build";
  const auto built_self = MoveitScene::ofSelf(moving_, cache_);
  const auto built_world = MoveitScene::ofWorld(moving_, objects, {}, cache_);
  for (const double moved : {0.0, 8.1, 18.8, 27.1, 28.9, 29.1}) {
    EXPECT_EQ(contactsOf(*with_self, moved), contactsOf(*built_self, moved)) << moved;
    EXPECT_EQ(contactsOf(*with_world, moved), contactsOf(*built_world, moved)) << moved;
  }
  EXPECT_THAT(contactsOf(*with_self, 0.0), ElementsAre("cup link[2]", "lid link[0]"));
  EXPECT_THAT(contactsOf(*with_self, 18.8),
              ElementsAre("cup lid", "cup link[0]", "cup link[2]", "lid link[0]", "lid link[2]"));
  EXPECT_THAT(contactsOf(*with_world, 18.8), IsEmpty());
  EXPECT_THAT(contactsOf(*with_world, 28.9), ElementsAre("box lid"));
  EXPECT_THAT(contactsOf(*with_world, 29.1), ElementsAre("box lid", "box link[0]"));
}

TEST_F(AScene, OfAttachedBodiesHasAChangingWorld) {
  const auto world = MoveitScene::ofWorld(moving_, {objectAt("box", 30.0)}, {}, cache_);
  moving_.push_back({{"cup", 0, true, {}}, {ball()}, 0.0});
  const auto held = world->withAttached(moving_, cache_);
  const auto changed = held->with({{objectAt("cup", 50.0)}, {"box"}}, {}, cache_);
  EXPECT_TRUE(changed->hasObject("cup"));
  EXPECT_FALSE(changed->hasObject("box"));
  EXPECT_THAT(contactsOf(*changed, 50.0), ElementsAre("cup cup", "cup link[0]"));
  EXPECT_FALSE(changed->with({{}, {"cup"}}, {}, cache_)->hasPairs());
  const std::string its_name = "attached body: cup/body";
  EXPECT_FALSE(changed->hasObject(its_name));
  EXPECT_THROW(changed->with({{objectAt(its_name, 50.0)}, {}}, {}, cache_), InputError);
  const auto such_a_world = world->with({{objectAt(its_name, 50.0)}, {}}, {}, cache_);
  EXPECT_THROW(such_a_world->withAttached(moving_, cache_), InputError);
}

TEST_F(AScene, IsBuiltForManyAttachedBodiesOrNoLinks) {
  const auto self = MoveitScene::ofSelf(moving_, cache_);
  for (int i = 0; i < 8; ++i) {
    EXPECT_TRUE(self->withAttached(moving_, cache_)) << i;
    moving_.push_back({{"cup" + std::to_string(i), 0, true, {}}, {ball()}, 0.0});
  }
  EXPECT_EQ(contactsOf(*self->withAttached(moving_, cache_), 0.0).size(), 8u * 7u / 2u + 8u);
  moving_.push_back({{"cup", 0, true, {}}, {ball()}, 0.0});
  EXPECT_FALSE(self->withAttached(moving_, cache_));
  moving_.erase(moving_.begin(), moving_.end() - 2);
  EXPECT_FALSE(self->withAttached(moving_, cache_));
  EXPECT_FALSE(self->withAttached({}, cache_));
}

/// An octree of leaves of 1 m (level 0) and its pose, in object "map".
MoveitOctree mapAt(double x, std::vector<octomap::point3d> centres) {
  const auto tree = std::make_shared<octomap::OcTree>(1.0);
  for (const octomap::point3d& centre : centres) tree->setNodeValue(centre, 1.0f);
  return {"map", tree, Isometry3d(Translation3d(x, 0.0, 0.0))};
}

TEST_F(AScene, OfAWorldHasItsOctreesAsTheyAre) {
  MoveitOctree map = mapAt(50.0, {{0.5f, 0.5f, 0.5f}});
  map.X_WO.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));  // leaf from 49 to 50
  const auto tree = std::const_pointer_cast<octomap::OcTree>(map.tree);
  const auto world = MoveitScene::ofWorld(moving_, {}, {map}, cache_);
  EXPECT_FALSE(world->hasPairs()) << "beside the octree";
  ASSERT_EQ(world->octrees().size(), 1u);
  const MoveitScene& of_map = *world->octrees()[0];
  EXPECT_TRUE(of_map.hasPairs());
  EXPECT_EQ(&of_map.moving(0), &world->moving(0));
  const auto contacts = [&](double moved) { return contactsOf(of_map, moved); };
  EXPECT_THAT(contacts(48.4), IsEmpty());
  EXPECT_THAT(contacts(48.6), ElementsAre("link[0] map"));
  EXPECT_THAT(contacts(50.4), ElementsAre("link[0] map"));
  EXPECT_THAT(contacts(50.6), IsEmpty());
  tree->setNodeValue(octomap::point3d(-0.5f, 0.5f, 0.5f), 1.0f);
  EXPECT_THAT(contacts(51.4), ElementsAre("link[0] map"));
  tree->clear();
  EXPECT_FALSE(of_map.hasPairs());
  tree->setNodeValue(octomap::point3d(-0.5f, 0.5f, 0.5f), -1.0f);
  EXPECT_THAT(contacts(51.4), IsEmpty());
}

TEST_F(AScene, OfBoxesHasAContactForEachLeaf) {
  const auto world = MoveitScene::ofWorld(
      moving_, {}, {mapAt(50.0, {{0.5f, 0.5f, 0.5f}, {1.5f, 0.5f, 0.5f}, {7.5f, 0.5f, 0.5f}})},
      cache_);
  const MoveitScene& of_map = *world->octrees().at(0);
  const MoveitScene::Lease worker_of_map = of_map.lease();
  setPoses(of_map, 51.0, worker_of_map->poses);
  const auto boxes = of_map.ofBoxes(of_map.leavesWithin(0.0, nullptr, *worker_of_map));
  EXPECT_TRUE(of_map.readsLeaves());
  EXPECT_FALSE(boxes->readsLeaves());
  EXPECT_EQ(&boxes->scene().robot(), &of_map.scene().robot()) << "a build";
  EXPECT_THAT(contactsOf(*boxes, 51.0), ElementsAre("link[0] map"));
  EXPECT_THAT(contactsOf(*boxes, 57.0), IsEmpty()) << "those leaves and no others";
  const MoveitScene::Lease worker = boxes->lease();
  setPoses(*boxes, 51.0, worker->poses);
  CheckSettings settings;
  settings.alarm_distance = 0.0;
  const CollisionReport& report = worker->detector.detect(worker->poses, settings);
  ASSERT_EQ(report.contacts.size(), 2u);
  Contact contact = report.contacts[0];
  boxes->toWorld(contact);
  EXPECT_NEAR(contact.p_WFirst.x(), 51.0, 0.5 + 1e-9);
}

TEST_F(AScene, OfAnOctreeIsSharedUntilItChanges) {
  const MoveitOctree map = mapAt(50.0, {{0.5f, 0.5f, 0.5f}});
  const auto tree = std::const_pointer_cast<octomap::OcTree>(map.tree);
  const auto world = MoveitScene::ofWorld(moving_, {}, {map}, cache_);
  const SceneChanges box = {{objectAt("box", 30.0)}, {}};
  const auto sceneWith = [&](const MoveitOctree& octree) {
    return world->with(box, {octree}, cache_)->octrees().at(0);
  };
  EXPECT_EQ(sceneWith(map), world->octrees()[0]);
  MoveitOctree moved = map, other = map;
  moved.X_WO.translation().x() = 60.0;
  other.object = "other map";
  for (const MoveitOctree& changed : {moved, other, mapAt(50.0, {})}) {
    EXPECT_NE(sceneWith(changed), world->octrees()[0]);
    EXPECT_EQ(&sceneWith(changed)->scene(), &world->octrees()[0]->scene()) << "a build";
  }
  EXPECT_THAT(contactsOf(*sceneWith(moved), 60.4), ElementsAre("link[0] map"));
  EXPECT_THAT(contactsOf(*sceneWith(other), 50.4), ElementsAre("link[0] other map"));
  EXPECT_THAT(world->with({}, {}, cache_)->octrees(), IsEmpty());
  EXPECT_TRUE(world->areResolutionsKept());
  tree->setResolution(2.0);
  EXPECT_FALSE(world->areResolutionsKept());
  const auto coarser = world->with({}, {map, moved}, cache_);
  EXPECT_TRUE(coarser->areResolutionsKept());
  EXPECT_EQ(&coarser->octrees()[0]->scene(), &coarser->octrees()[1]->scene());
  EXPECT_THAT(contactsOf(*coarser->octrees()[0], 52.4), ElementsAre("link[0] map"));
  moved.X_WO.linear() *= 1.1;
  EXPECT_THROW(world->with({}, {moved}, cache_), InputError);
}

TEST_F(AScene, OfAnOctreeHasWhatIsAttachedAndSelected) {
  moving_[0].padding = 0.25;
  const auto world = MoveitScene::ofWorld(moving_, {}, {mapAt(50.0, {{0.5f, 0.5f, 0.5f}})}, cache_);
  const MoveitScene& of_links = *world->octrees().at(0);
  const MoveitScene::Lease worker = of_links.lease();
  setPoses(of_links, 50.0, worker->poses);
  EXPECT_EQ(of_links.leavesWithin(0.0, nullptr, *worker).size(), 1u);
  const auto selection = of_links.selectionOf({0, 1, 0});
  EXPECT_THAT(of_links.leavesWithin(0.0, selection, *worker), IsEmpty());
  EXPECT_EQ(of_links.leavesWithin(40.0, selection, *worker).size(), 1u);

  moving_.push_back({{"cup", 0, true, {}}, {ball()}, 0.0});
  const auto held = world->withAttached(moving_, cache_);
  ASSERT_TRUE(held);
  const MoveitScene& of_map = *held->octrees().at(0);
  EXPECT_THAT(contactsOf(of_map, 50.0), ElementsAre("cup map", "link[0] map"));
  EXPECT_THAT(contactsOf(of_map, 51.6), ElementsAre("link[0] map")) << "padded";
  EXPECT_THAT(contactsOf(of_map, 51.8), IsEmpty());
}

TEST_F(AScene, SelectsWhatIsActive) {
  const auto self = MoveitScene::ofSelf(moving_, cache_);
  const auto selection = self->selectionOf({0, 1, 0});
  ASSERT_TRUE(selection);
  EXPECT_EQ(selection, self->selectionOf({0, 1, 0}));
  EXPECT_NE(selection, self->selectionOf({1, 1, 0}));
  for (std::uint32_t a = 0; a < 3; ++a) {
    for (std::uint32_t b = 0; b < a; ++b) {
      const bool is_active = nameOf(*self, a) == "link[1]" || nameOf(*self, b) == "link[1]";
      EXPECT_EQ(selection->filter().allowed(a, b), is_active);
    }
  }
}

}  // namespace collision_pairs::test_moveit_scene
