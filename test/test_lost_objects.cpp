// What is said of objects that only a node before this one knew. Without a master.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/mesh_loader.h"
#include "monitored_robot.h"

namespace collision_pairs::test_lost_objects {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(LostObjects, AreAReasonUntilTheyAreCleared) {
  Monitor monitor{TransformSettings()};
  load(monitor, parametersOf(emptyLink("root") + boxLink("post", 1.0) + boxLink("a", 1.0) +
                             joint("stands", "fixed", "root", "post") +
                             joint("to_a", "floating", "root", "a", "0 0 0", "")));
  const ros::Time now(1000.0);
  monitor.advance(now);
  monitor.take(transformOf("root", "a", now, 9.0), false, "");
  const auto report = [&] {
    return check(monitor, monitor.at(monitor.scenes().active()), {}).report;
  };
  monitor.scenes().setObjectsLost(true);
  const auto update = [&](std::uint8_t operation) {
    SceneChange change;
    change.operation = operation;
    change.object.name = "ball";
    change.object.pose.position.y = 9.0;
    change.object.pose.orientation.w = 1.0;
    change.object.primitives.resize(1);
    change.object.primitives[0].type = shape_msgs::SolidPrimitive::SPHERE;
    change.object.primitives[0].dimensions = {0.1};
    change.object.primitive_poses.resize(1);
    change.object.primitive_poses[0].orientation.w = 1.0;
    SceneJob job = monitor.scenes().update({change}, readAdded({change}, makeMeshLoader()));
    job.run();
    EXPECT_TRUE(monitor.scenes().take(job));
    return report();
  };
  EXPECT_THAT(report().unknown_because, ElementsAre(HasSubstr("are lost: send CLEAR")));
  EXPECT_EQ(update(SceneChange::ADD).verdict, Verdict::UNKNOWN);
  EXPECT_EQ(update(SceneChange::CLEAR).verdict, Verdict::FREE);
  EXPECT_FALSE(monitor.scenes().stored().are_objects_lost);
}

}  // namespace collision_pairs::test_lost_objects
