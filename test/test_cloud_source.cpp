// Which clouds a source takes, and what it says of others. Without a master.
#include <boost/make_shared.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "monitored_robot.h"
#include "point_cloud.h"

namespace collision_pairs {
namespace test_cloud_source {

using testing::HasSubstr;

TEST(ACloudSource, TakesCloudsOfOneCameraAndIsSuspectWhileThereIsAnother) {
  Monitor monitor{TransformSettings()};
  SceneParameters parameters =
      parametersOf(emptyLink("root") + linkWith("a", "<sphere radius='0.5'/>") +
                   joint("to_a", "floating", "root", "a", "0 0 0", ""));
  parameters.sources.readSettings({"settings", "clouds: [{topic: points, source_timeout: 0.5}]"});
  load(monitor, std::move(parameters));
  const auto source = monitor.scenes().active()->clouds.front();
  const auto problemAfter = [&](double seconds, const std::string& frame, const std::string& node) {
    std_msgs::Header header;
    header.stamp = ros::Time(1000.0 + seconds);
    monitor.advance(header.stamp);
    monitor.take(transformOf("root", "a", header.stamp, 20.0), false, "");
    header.frame_id = frame;
    const auto cloud = toPointCloud2({{4.0, 0.0, 0.0}}, header);
    source->take(boost::make_shared<sensor_msgs::PointCloud2>(cloud), node);
    while (const auto job = source->next()) {
      job->run();
      source->take(*job);
    }
    return source->view().problem;
  };
  const auto is_another = HasSubstr("each camera needs a topic of its own");
  EXPECT_EQ(problemAfter(0.0, "root", "/one"), "");
  EXPECT_THAT(problemAfter(0.1, "root", "/two"), is_another);
  EXPECT_THAT(problemAfter(0.2, "/root", "/one"), is_another) << "the other was heard lately";
  EXPECT_THAT(problemAfter(0.55, "root", "/one"), is_another);
  EXPECT_EQ(problemAfter(0.65, "root", "/one"), "");
  EXPECT_EQ(problemAfter(1.3, "root", "/two"), "") << "the other was started anew";
  EXPECT_THAT(problemAfter(1.4, "a", "/two"), is_another);
  EXPECT_EQ(problemAfter(2.0, "root", "/two"), "");
  EXPECT_THAT(problemAfter(3.0, "a", "/two"), is_another) << "however old";
  EXPECT_THAT(problemAfter(9.0, "a", "/two"), testing::Not(""));
  monitor.clearClouds();
  EXPECT_EQ(problemAfter(9.1, "a", "/two"), "");
}

}  // namespace test_cloud_source
}  // namespace collision_pairs
