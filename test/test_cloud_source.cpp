// Which clouds a source takes, and what it says of others. Without a master.
#include <boost/make_shared.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "monitored_robot.h"
#include "point_cloud.h"

namespace collision_pairs::test_cloud_source {

using testing::HasSubstr;

/// Ball a, and clouds of the topic "points".
struct Clouds {
  explicit Clouds(bool is_simulated) : monitor({{}, is_simulated}) {
    SceneParameters parameters =
        parametersOf(emptyLink("root") + linkWith("a", "<sphere radius='0.5'/>") +
                     joint("to_a", "floating", "root", "a", "0 0 0", ""));
    parameters.sources.readSettings({"settings", "clouds: [{topic: points, source_timeout: 0.5}]"});
    load(monitor, std::move(parameters));
  }

  /// What is wrong after a cloud of now, with the ball there.
  std::string problemWith(const Now& now, double x_of_ball,
                          const std::vector<Eigen::Vector3d>& points, const std::string& frame,
                          const std::string& node) {
    std_msgs::Header header;
    header.stamp = now.stamp;
    header.frame_id = frame;
    monitor.advance(now);
    monitor.take(transformOf("root", "a", header.stamp, x_of_ball), false, "");
    const auto source = monitor.scenes().active()->clouds.front();
    source->take(boost::make_shared<sensor_msgs::PointCloud2>(toPointCloud2(points, header)), node);
    while (const auto job = source->next()) {
      job->run();
      source->take(*job);
    }
    return source->view().problem;
  }

  Monitor monitor;
};

TEST(ACloudSource, TakesCloudsOfOneCameraAndIsSuspectWhileThereIsAnother) {
  Clouds clouds(false);
  const auto problemAfter = [&](double seconds, const std::string& frame, const std::string& node) {
    return clouds.problemWith(ros::Time(1000.0 + seconds), 20.0, {{4.0, 0.0, 0.0}}, frame, node);
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
  clouds.monitor.clearClouds();
  EXPECT_EQ(problemAfter(9.1, "a", "/two"), "");
}

/// Something comes to a link and is gone; then the clock goes back, and a cloud shows nothing near.
std::string problemAfterTheClockWentBack(bool is_simulated, double back) {
  Clouds clouds(is_simulated);
  double steady = 0.0;
  const auto problemWith = [&](double seconds, double x) {
    return clouds.problemWith({ros::Time(1000.0 + seconds), steady += 0.1}, 0.0,
                              {{x, 0.0, 0.0}, {3.0, 3.0, 0.0}}, "root", "/one");
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

}  // namespace collision_pairs::test_cloud_source
