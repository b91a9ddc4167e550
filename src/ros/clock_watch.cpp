#include "clock_watch.h"

namespace collision_pairs {
namespace {

// robot_state_publisher may stamp fixed joints half a second ahead; nothing is that late by
// seconds.
const ros::Duration AHEAD(1.0);
const ros::WallDuration MOMENT(3.0);

}  // namespace

bool ClockWatch::wentBack(const ros::Time& now, const ros::WallTime& wall_now) {
  const bool back = now < last_;
  last_ = now;
  if (!back) return false;
  jumped_ = wall_now;
  ++nb_jumps_;
  return true;
}

bool ClockWatch::isLeftOver(const ros::Time& stamp, const ros::Time& now,
                            const ros::WallTime& wall_now) const {
  return nb_jumps_ > 0 && wall_now - jumped_ < MOMENT && stamp > now && stamp - now > AHEAD;
}

}  // namespace collision_pairs
