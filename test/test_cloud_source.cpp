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

/// Something comes to a link and is gone; then the clock goes back, and a cloud shows nothing near.
std::string problemAfterTheClockWentBack(bool is_simulated, double back) {
  TransformSettings settings;
  settings.is_simulated = is_simulated;
  Monitor monitor{settings};
  SceneParameters parameters =
      parametersOf(emptyLink("root") + linkWith("a", "<sphere radius='0.5'/>") +
                   joint("to_a", "floating", "root", "a", "0 0 0", ""));
  parameters.sources.readSettings({"settings", "clouds: [{topic: points, source_timeout: 0.5}]"});
  load(monitor, std::move(parameters));
  const auto source = monitor.scenes().active()->clouds.front();
  double steady = 0.0;
  const auto problemWith = [&](double seconds, double x) {
    std_msgs::Header header;
    header.stamp = ros::Time(1000.0 + seconds);
    header.frame_id = "root";
    monitor.advance({header.stamp, steady += 0.1});
    monitor.take(transformOf("root", "a", header.stamp, 0.0), false, "");
    const auto cloud = toPointCloud2({{x, 0.0, 0.0}, {3.0, 3.0, 0.0}}, header);
    source->take(boost::make_shared<sensor_msgs::PointCloud2>(cloud), "/one");
    while (const auto job = source->next()) {
      job->run();
      source->take(*job);
    }
    return source->view().problem;
  };
  double now = 0.0;
  for (const double x : {0.7, 0.64, 0.6, 0.58, 0.56}) problemWith(now += 0.1, x);
  problemWith(now += 0.1, 3.0);
  EXPECT_THAT(problemWith(now += 0.1, 3.0), HasSubstr("vanished"));
  problemWith(now -= back, 3.0);
  return problemWith(now += 0.1, 3.0);
}

TEST(ACloudSource, DoesNotForgetWhatVanishedWhenTheClockIsSetBack) {
  EXPECT_THAT(problemAfterTheClockWentBack(false, 0.5), HasSubstr("vanished"));
  EXPECT_THAT(problemAfterTheClockWentBack(false, 100.0), HasSubstr("vanished"));
  EXPECT_THAT(problemAfterTheClockWentBack(true, 0.5), HasSubstr("vanished"));
  EXPECT_EQ(problemAfterTheClockWentBack(true, 6.0), "") << "a bag that begins anew";
}

}  // namespace test_cloud_source
}  // namespace collision_pairs
