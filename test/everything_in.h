// A report as text, for comparing it to the last bit.
#pragma once

#include <sstream>
#include <string>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// All fields, to the last bit.
inline std::string everythingIn(const CollisionReport& report) {
  std::ostringstream text;
  text << std::hexfloat;
  const auto vector = [&](const Eigen::Vector3d& v) {
    for (int i = 0; i < 3; ++i) text << ' ' << v[i];
  };
  const auto contact = [&](const Contact& c) {
    text << "\ncontact " << c.elements.first << ' ' << c.elements.second << ' ' << c.depth;
    for (const Eigen::Vector3d& v : {c.p_WFirst, c.p_WSecond, c.nhat_W}) vector(v);
    vector(c.voxel.cast<double>());
  };
  text << static_cast<int>(report.verdict) << report.in_collision << ' ' << report.min_distance
       << report.min_distance_is_bound << report.ended_early << ' ' << report.unchecked << ' '
       << report.tolerance << ' ' << report.nb_boxes << ' ' << report.nb_unresolved << ' '
       << report.budget_spent << ' ' << report.nb_degraded << ' '
       << static_cast<int>(report.narrow_phase) << ' ' << report.nb_answered_natively << ' '
       << report.times.boxes << ' ' << report.times.broad_phase << ' ' << report.times.narrow_phase
       << ' ' << report.times.total << "\nsettled";
  for (const std::uint32_t nb : report.nb_settled) text << ' ' << nb;
  if (report.nearest) contact(*report.nearest);
  for (const PairReport& pair : report.pairs) {
    text << "\npair " << pair.first << ' ' << pair.second << ' ' << static_cast<int>(pair.state)
         << ' ' << pair.distance << ' ' << static_cast<int>(pair.fidelity) << ' '
         << static_cast<int>(pair.certainty) << ' ' << pair.first_contact << ' '
         << pair.nb_contacts;
  }
  for (const Contact& c : report.contacts) contact(c);
  for (const auto& [a, b] : report.candidates) text << "\ncandidate " << a << ' ' << b;
  for (const Aabb& box : report.boxes) text << "\nbox", vector(box.min), vector(box.max);
  for (const auto& [a, b] : report.ignored) text << "\nignored " << a << ' ' << b;
  for (const std::uint32_t model : report.left_out) text << "\nleft out " << model;
  return text.str();
}

}  // namespace collision_pairs
