// What changes make of the scene's objects: no master needed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "object_messages.h"
#include "printed.h"
#include "random_inputs.h"
#include "refusal.h"
#include "scene_updates.h"

namespace collision_pairs::test_scene_updates {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

/// A world in which frame "hand" stands at x = 1, turned by a quarter about z.
class Changes : public testing::Test {
 protected:
  Changes() {
    X_WH_.translation().x() = 1.0;
    X_WH_.linear() = Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
    context_.world_frame = "world";
    context_.look_up = [this](const std::string& target, const std::string& source,
                              const ros::Time& stamp) -> Isometry3d {
      asked_stamp_ = stamp;
      return poseOf(target).inverse() * poseOf(source);
    };
  }
  Isometry3d poseOf(const std::string& frame) const {
    if (frame == "world") return Isometry3d::Identity();
    if (frame == "hand") return X_WH_;
    if (frame == "other_hand") return X_WO_;
    throw InputError("TF does not know '" + frame + "'");
  }

  void apply(std::uint8_t operation, const SceneObject& object) {
    SceneChange change;
    change.operation = operation;
    change.object = object;
    collision_pairs::apply(editsBy({change}), objects_);
  }

  ObjectEdits editsBy(const std::vector<SceneChange>& changes) const {
    return collision_pairs::editsBy(changes, readAdded(changes, noMeshLoader()), objects_,
                                    context_);
  }

  std::string refusalOf(std::uint8_t operation, const SceneObject& object) {
    return refusal([&] { apply(operation, object); });
  }

  const RigidObject& stored(const std::string& name) { return objects_.at(name).object; }

  Isometry3d X_WH_ = Isometry3d::Identity(), X_WO_ = X_WH_;
  ros::Time asked_stamp_;
  UpdateContext context_;
  SceneObjects objects_;
};

TEST_F(Changes, APoseIsOfItsFrame) {
  SceneObject object = boxObject("crate", poseAt(0, 0.5, 0));
  apply(SceneChange::ADD, object);
  EXPECT_EQ(stored("crate").X_PO.translation(), Vector3d(0, 0.5, 0));
  object.header.frame_id = "/hand";
  apply(SceneChange::MOVE, object);
  EXPECT_TRUE(stored("crate").X_PO.translation().isApprox(Vector3d(0.5, 0, 0)));
}

TEST_F(Changes, AnObjectThatIsAddedTakesThePlaceOfTheOneOfItsName) {
  apply(SceneChange::ADD, boxObject("crate", poseAt(0, 0.5, 0)));
  SceneObject grip = boxObject("crate", poseAt(0, 0, 0));
  grip.attached_link = "hand";
  apply(SceneChange::ATTACH, grip);
  SceneObject lid = boxObject("lid", poseAt(0, 0, 1));
  lid.attached_link = "hand";
  lid.touch_links = {"crate"};
  apply(SceneChange::ADD, lid);
  SceneObject other = boxObject("crate", poseAt(1, 2, 3));
  other.padding = 0.25;
  apply(SceneChange::ADD, other);
  EXPECT_EQ(objects_.size(), 2u);
  EXPECT_EQ(stored("lid").touch_links, lid.touch_links);
  EXPECT_EQ(stored("crate").attached_link, "");
  EXPECT_EQ(stored("crate").padding, 0.25);
  EXPECT_EQ(stored("crate").X_PO.translation(), Vector3d(1, 2, 3));
}

// No frame is that of the reports, whatever it hangs on.
TEST_F(Changes, WhatIsAttachedIsAddedAndMovedToWhereTheFrameSays) {
  SceneObject object = boxObject("crate", poseAt(0, 0, 2));
  object.attached_link = object.header.frame_id = "hand";
  apply(SceneChange::ADD, object);
  EXPECT_EQ(stored("crate").X_PO.translation(), Vector3d(0, 0, 2));
  object.header.frame_id.clear();
  apply(SceneChange::MOVE, object);
  EXPECT_EQ(stored("crate").attached_link, "hand");
  EXPECT_TRUE((X_WH_ * stored("crate").X_PO).translation().isApprox(Vector3d(0, 0, 2)));
}

// Also where a later change of the request removes it again.
TEST_F(Changes, ALinkThatTheRobotDoesNotHaveIsRefused) {
  context_.require_link = [](const std::string& link) {
    if (link != "hand") throw InputError("no link '" + link + "'");
  };
  for (const char* link : {"hand", "hnad"}) {
    SceneChange add, attach, remove;
    add.operation = SceneChange::ADD;
    attach.operation = SceneChange::ATTACH;
    remove.operation = SceneChange::REMOVE;
    add.object = attach.object = remove.object = boxObject("crate", poseAt(0, 0, 0));
    attach.object.attached_link = link;
    SceneChange added_on = add;
    added_on.object.attached_link = link;
    added_on.object.header.frame_id = link;
    for (const auto& changes : {std::vector<SceneChange>{added_on, remove},
                                std::vector<SceneChange>{add, attach, remove}}) {
      const auto apply = [&] { editsBy(changes); };
      if (std::string(link) == "hand") {
        EXPECT_NO_THROW(apply());
      } else {
        EXPECT_THROW(apply(), InputError);
      }
    }
  }
}

TEST_F(Changes, AttachAndDetachLeaveItWhereItIs) {
  apply(SceneChange::ADD, boxObject("crate", poseAt(3, 1, 0)));
  SceneObject grip;
  grip.name = "crate";
  grip.attached_link = "hand";
  grip.touch_links = {"finger"};
  apply(SceneChange::ATTACH, grip);
  EXPECT_EQ(stored("crate").attached_link, "hand");
  EXPECT_EQ(stored("crate").touch_links, grip.touch_links);
  EXPECT_TRUE((X_WH_ * stored("crate").X_PO).translation().isApprox(Vector3d(3, 1, 0)));
  X_WH_.translation().x() = 5.0;  // it moves along
  grip.attached_link = "other_hand";
  apply(SceneChange::ATTACH, grip);
  EXPECT_EQ(stored("crate").attached_link, "other_hand");
  EXPECT_TRUE((X_WO_ * stored("crate").X_PO).translation().isApprox(Vector3d(7, 1, 0)));
  X_WO_.translation().y() = 4.0;
  apply(SceneChange::DETACH, grip);
  EXPECT_EQ(stored("crate").attached_link, "");
  EXPECT_TRUE(stored("crate").X_PO.translation().isApprox(Vector3d(7, 5, 0)));
}

TEST_F(Changes, WhatMayTouchItEndsWhenItIsDetached) {
  apply(SceneChange::ADD, boxObject("crate", poseAt(3, 1, 0)));
  SceneObject grip;
  grip.name = "crate";
  grip.attached_link = "hand";
  grip.touch_links = {"finger"};
  apply(SceneChange::ATTACH, grip);
  grip.touch_links.clear();
  apply(SceneChange::DETACH, grip);
  EXPECT_TRUE(stored("crate").touch_links.empty());
  grip.touch_links = {"finger"};
  apply(SceneChange::ATTACH, grip);
  grip.touch_links = {"table"};
  apply(SceneChange::DETACH, grip);
  EXPECT_EQ(stored("crate").touch_links, grip.touch_links);
}

TEST_F(Changes, TheListSaysWhereEachIs) {
  apply(SceneChange::ADD, boxObject("b", poseAt(1, 0, 0)));
  apply(SceneChange::ADD, boxObject("a", poseAt(2, 0, 0)));
  SceneObject grip;
  grip.name = "a";
  grip.attached_link = "hand";
  apply(SceneChange::ATTACH, grip);
  const auto list = listed(objects_, "world");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].name, "a");
  EXPECT_EQ(list[0].header.frame_id, "hand");
  EXPECT_NEAR(list[0].pose.position.y, -1.0, 1e-12);
  EXPECT_EQ(list[1].header.frame_id, "world");
  EXPECT_EQ(list[1].pose.position.x, 1.0);
  EXPECT_EQ(list[1].primitives.size(), 1u);
  apply(SceneChange::REMOVE, grip);
  EXPECT_EQ(listed(objects_, "world").size(), 1u);
  apply(SceneChange::CLEAR, SceneObject());
  EXPECT_TRUE(objects_.empty());
}

TEST_F(Changes, WhatIsRemovedIsInNobodysTouchLinks) {
  SceneObject lid = boxObject("lid", poseAt(0, 0, 1));
  lid.touch_links = {"pot", "hand"};
  apply(SceneChange::ADD, lid);
  apply(SceneChange::ADD, boxObject("pot", poseAt(0, 0, 0)));
  apply(SceneChange::REMOVE, boxObject("pot", poseAt(0, 0, 0)));
  EXPECT_EQ(stored("lid").touch_links, (std::vector<std::string>{"hand"}));
}

TEST_F(Changes, OfOneRequestLeaveTheTouchLinksThatTheyLeaveOneByOne) {
  RandomInputs random;
  const std::vector<std::string> names = {"cup", "lid", "pot", "tray"};
  for (int i = 0; i < 300; ++i) {
    const SceneObjects before = objects_;
    std::vector<SceneChange> changes;
    for (int step = 0; step < 8; ++step) {
      SceneChange change;
      change.object =
          boxObject(names[static_cast<std::size_t>(random.integer(0, 3))], poseAt(0, 0, 0));
      const bool is_there = objects_.count(change.object.name) > 0;
      change.operation = is_there && random.integer(0, 1) ? SceneChange::REMOVE : SceneChange::ADD;
      for (const std::string& name : names) {
        const bool names_some = change.operation == SceneChange::ADD && step % 3 == 0;
        if (names_some && random.integer(0, 1)) change.object.touch_links.push_back(name);
      }
      apply(change.operation, change.object);
      changes.push_back(change);
    }
    SceneObjects at_once = before;
    collision_pairs::apply(
        collision_pairs::editsBy(changes, readAdded(changes, noMeshLoader()), before, context_),
        at_once);
    ASSERT_EQ(at_once.size(), objects_.size());
    for (const auto& [name, stored] : objects_) {
      EXPECT_EQ(at_once.at(name).object.touch_links, stored.object.touch_links) << name;
    }
  }
}

// Where each looked at all objects, this took minutes.
TEST_F(Changes, MayRemoveTwentyThousand) {
  std::vector<SceneChange> changes(20000);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    changes[i].object = boxObject("box" + std::to_string(i), poseAt(0, 0, 0));
    changes[i].object.touch_links = {"box0"};
  }
  collision_pairs::apply(editsBy(changes), objects_);
  EXPECT_EQ(objects_.size(), 20000u);
  for (SceneChange& change : changes) {
    change.operation = SceneChange::REMOVE;
    change.object.touch_links.clear();
  }
  collision_pairs::apply(editsBy(changes), objects_);
  EXPECT_TRUE(objects_.empty());
}

TEST_F(Changes, OfOneRequestSeeThoseBeforeThem) {
  apply(SceneChange::ADD, boxObject("old", poseAt(0, 0, 0)));
  SceneObject lid = boxObject("lid", poseAt(0, 0, 1));
  lid.touch_links = {"new", "hand"};
  const auto change = [](std::uint8_t operation, const SceneObject& object) {
    SceneChange made;
    made.operation = operation;
    made.object = object;
    return made;
  };
  const auto why = [&](const std::vector<SceneChange>& changes) {
    return refusal([&] { editsBy(changes); });
  };
  const SceneChange add = change(SceneChange::ADD, boxObject("new", poseAt(1, 0, 0))),
                    move = change(SceneChange::MOVE, boxObject("new", poseAt(2, 0, 0))),
                    remove = change(SceneChange::REMOVE, boxObject("new", poseAt(0, 0, 0))),
                    add_lid = change(SceneChange::ADD, lid),
                    clear = change(SceneChange::CLEAR, SceneObject());
  ObjectEdits edits = editsBy({add_lid, add, move, remove, add_lid});
  EXPECT_EQ(edits.size(), 2u);
  EXPECT_FALSE(edits.at("new").has_value());
  edits = editsBy({add, add_lid, remove});
  EXPECT_EQ(edits.at("lid")->object.touch_links, std::vector<std::string>{"hand"});
  SceneChanges changes = sceneChanges(edits, objects_);
  EXPECT_TRUE(changes.removed.empty()) << "it was never there";
  ASSERT_EQ(changes.objects.size(), 1u);
  EXPECT_EQ(changes.objects[0].name, "lid");
  edits = editsBy({clear, add, move});
  changes = sceneChanges(edits, objects_);
  EXPECT_EQ(changes.removed, std::vector<std::string>{"old"});
  EXPECT_EQ(changes.objects.at(0).X_PO.translation().x(), 2.0);
  EXPECT_THAT(why({add, remove, move}),
              HasSubstr("changes[2], object 'new': there is no such object"
                        "; did you mean 'old'?"));
  EXPECT_FALSE(editsBy({add, clear}).count("new"));
  EXPECT_THAT(why({remove}), HasSubstr("no such object"));
  EXPECT_THAT(why({clear, move}), HasSubstr("there is no such object; the scene has none"));
  EXPECT_THAT(why({clear, add_lid, move}), HasSubstr("did you mean 'lid'?"));
  EXPECT_EQ(objects_.size(), 1u);
}

TEST_F(Changes, AddAndMoveAtTheStampThatTheyNameAndAttachAndDetachNow) {
  SceneObject object = boxObject("crate", poseAt(1, 2, 3));
  object.header.frame_id = "hand";
  object.attached_link = "";
  std::uint32_t second = 0;
  for (const auto operation :
       {SceneChange::ADD, SceneChange::MOVE, SceneChange::ATTACH, SceneChange::DETACH}) {
    object.header.stamp = ros::Time(++second, 0);
    object.attached_link = operation == SceneChange::ATTACH ? "hand" : "";
    apply(operation, object);
    const bool has_pose = operation == SceneChange::ADD || operation == SceneChange::MOVE;
    EXPECT_EQ(asked_stamp_, has_pose ? object.header.stamp : ros::Time()) << operation;
  }
  object.attached_link = "hand";
  object.touch_links = {"finger"};
  object.padding = 0.25;
  apply(SceneChange::ATTACH, object);
  EXPECT_EQ(printed(listed(objects_, "world").at(0)),
            "header frame_id hand name crate pose position x 1 y 2 z 3 orientation w 1 "
            "primitives[0] type 1 dimensions[0] 1 dimensions[1] 2 dimensions[2] 3 attached_link "
            "hand touch_links[0] finger");
}

TEST_F(Changes, WhatIsWrongIsNamedAndNothingIsChanged) {
  apply(SceneChange::ADD, boxObject("crate", poseAt(0, 0, 0)));
  SceneObject object = boxObject("crat", poseAt(0, 0, 0));
  EXPECT_THAT(refusalOf(SceneChange::MOVE, object),
              AllOf(HasSubstr("changes[0], object 'crat'"), HasSubstr("did you mean 'crate'?")));
  EXPECT_THAT(refusalOf(SceneChange::ATTACH, object), HasSubstr("no such object"));
  EXPECT_THAT(refusalOf(77, object), HasSubstr("operation 77 is unknown"));
  object.pose.orientation.w = 0.0;
  EXPECT_THAT(refusalOf(SceneChange::ADD, object), HasSubstr("its pose is invalid"));
  object.pose = poseAt(0, 0, std::nan(""));
  EXPECT_THAT(refusalOf(SceneChange::ADD, object), HasSubstr("its pose is invalid"));
  object.pose = poseAt(0, 0, 0);
  object.header.frame_id = "elsewhere";
  EXPECT_THAT(refusalOf(SceneChange::ADD, object), HasSubstr("'elsewhere'"));
  object.name.clear();
  EXPECT_THAT(refusalOf(SceneChange::ADD, object), HasSubstr("it has no name"));
  object.name = "crate";
  EXPECT_THAT(refusalOf(SceneChange::ATTACH, object), HasSubstr("attached_link is empty"));
  EXPECT_THAT(refusalOf(SceneChange::DETACH, object), HasSubstr("not attached"));
  EXPECT_EQ(objects_.size(), 1u);
  EXPECT_EQ(stored("crate").X_PO.matrix(), Isometry3d::Identity().matrix());
}

}  // namespace collision_pairs::test_scene_updates
