#include "trajectory_check.h"

#include "collision_pairs/input_error.h"
#include "conversions.h"

namespace collision_pairs {

void checkTrajectory(const CheckTrajectory::Request& request, const JointQuery& query,
                     const CheckSettings& settings, const std::vector<std::string>& broken_links,
                     const std::string& frame, const ros::Time& stamp, BatchCheck& batch,
                     CheckTrajectory::Response& response) {
  const auto& points = request.trajectory.points;
  response.in_collision.resize(points.size());
  response.min_distance.resize(points.size());
  if (request.want_reports) response.reports.resize(points.size());
  response.joints_from_tf = query.jointsFromTf();
  response.joints_at_zero = query.jointsAtZero();
  batch.run(
      points.size(), settings,
      [&](std::size_t i, BodyPoses& poses) {
        try {
          query.posesAt(points[i].positions, poses);
        } catch (const InputError& error) {
          throw InputError("point " + std::to_string(i) + ": " + error.what());
        }
      },
      [&](std::size_t i, const CollisionReport& report) {
        response.in_collision[i] = report.in_collision;
        response.min_distance[i] = report.min_distance;
        if (!request.want_reports) return;
        response.reports[i] =
            toMessage(report, batch.scene(), settings, frame, stamp, broken_links);
      });
}

}  // namespace collision_pairs
