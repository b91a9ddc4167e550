// Poses of frames in each other, against walks up to their root.
#include <optional>

#include <gtest/gtest.h>

#include "frame_ways.h"
#include "random_inputs.h"

namespace collision_pairs::test_frame_ways {

using Eigen::Vector3d;

constexpr StampNs SECOND = 1000000000;

/// By frame: the one on which it hangs, or -1. Some hang on themselves, by others.
std::vector<int> randomParents(RandomInputs& random, int nb_frames) {
  std::vector<int> parents;
  for (int frame = 0; frame < nb_frames; ++frame) {
    const int parent = random.integer(-1, nb_frames - 1);
    parents.push_back(parent == frame ? -1 : parent);
  }
  return parents;
}

/// The last frame above, and the pose in it; -1 if there is no last one.
int rootOf(int frame, const std::vector<int>& parents, const std::vector<Eigen::Isometry3d>& X_PF,
           Eigen::Isometry3d& X_RF) {
  X_RF.setIdentity();
  for (std::size_t i = 0; i <= parents.size(); ++i) {
    const auto at = static_cast<std::size_t>(frame);
    if (parents[at] < 0) return frame;
    X_RF = X_PF[at] * X_RF;
    frame = parents[at];
  }
  return -1;
}

std::optional<Eigen::Isometry3d> poseAt(const TransformBuffer& buffer, const std::string& target,
                                        const std::string& source, StampNs stamp) {
  try {
    return poseBetween(buffer, target, source, {Instant::AT, stamp}).X_TS;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

TEST(FramePoses, AreThoseOfWalksUpToOneRootAndUnknownWhereAWalkHasNoEnd) {
  RandomInputs random;
  int nb_known = 0, nb_rings = 0;
  for (int i = 0; i < 500; ++i) {
    const int nb_frames = random.integer(2, 7);
    const std::vector<int> parents = randomParents(random, nb_frames);
    const auto nameOf = [](int frame) { return "f" + std::to_string(frame); };
    TransformBuffer buffer{PoseLimits{2.0, 1.0, 0.5}};
    std::vector<Eigen::Isometry3d> X_PF;
    for (int frame = 0; frame < nb_frames; ++frame) {
      X_PF.push_back(random.pose(1.0));
      const int parent = parents[static_cast<std::size_t>(frame)];
      if (parent < 0) continue;
      const Eigen::Quaterniond turn(X_PF.back().linear());
      const Vector3d p = X_PF.back().translation();
      buffer.take({nameOf(parent), nameOf(frame), 0, p, turn}, true, "", SECOND);
    }
    for (int target = 0; target < nb_frames; ++target) {
      for (int source = 0; source < nb_frames; ++source) {
        if (source == target) continue;
        Eigen::Isometry3d X_RT, X_RS;
        const int root = rootOf(target, parents, X_PF, X_RT);
        const bool is_known = root >= 0 && root == rootOf(source, parents, X_PF, X_RS);
        nb_rings += root < 0;
        nb_known += is_known;
        SCOPED_TRACE("case " + std::to_string(i));
        const auto X_TS = poseAt(buffer, nameOf(target), nameOf(source), SECOND);
        ASSERT_EQ(X_TS.has_value(), is_known);
        if (!is_known) continue;
        EXPECT_TRUE(X_TS->isApprox(X_RT.inverse() * X_RS, 1e-9));
      }
    }
  }
  EXPECT_GT(nb_known, 200);
  EXPECT_GT(nb_rings, 200);
}

/// The frames above one, and itself, up to the root.
std::vector<int> wayUp(int frame, const std::vector<int>& parents) {
  std::vector<int> way;
  for (; frame >= 0; frame = parents[static_cast<std::size_t>(frame)]) way.push_back(frame);
  return way;
}

TEST(FramePoses, AreAsOldAsTheOldestTransformBetweenTheTwoFrames) {
  RandomInputs random;
  int nb_up = 0, nb_mixed = 0;
  for (int i = 0; i < 300; ++i) {
    const int nb_frames = random.integer(3, 8);
    const auto nameOf = [](int frame) { return "f" + std::to_string(frame); };
    TransformBuffer buffer{PoseLimits{2.0, 1.0, 0.5}};
    std::vector<int> parents;
    std::vector<StampNs> newest;
    for (int frame = 0; frame < nb_frames; ++frame) {
      parents.push_back(frame == 0 ? -1 : random.integer(0, frame - 1));
      const bool is_static = random.integer(0, 3) == 0;
      newest.push_back(is_static ? NEVER : SECOND + random.integer(200, 900) * SECOND / 1000);
      if (frame == 0) continue;
      const auto take = [&](StampNs stamp) {
        buffer.take({nameOf(parents.back()), nameOf(frame), stamp, random.vector(-1.0, 1.0),
                     Eigen::Quaterniond::Identity()},
                    is_static, "", 2 * SECOND);
      };
      take(SECOND);
      if (!is_static) take(newest.back());
    }
    for (int target = 0; target < nb_frames; ++target) {
      for (int source = 0; source < nb_frames; ++source) {
        const std::vector<int> up = wayUp(target, parents), down = wayUp(source, parents);
        StampNs oldest = NEVER;
        for (const auto& [way, other] : {std::pair(&up, &down), std::pair(&down, &up)}) {
          for (const int frame : *way) {
            if (std::count(other->begin(), other->end(), frame) > 0) continue;
            nb_up += way == &up && newest[static_cast<std::size_t>(frame)] < oldest;
            nb_mixed += oldest != NEVER;
            oldest = std::min(oldest, newest[static_cast<std::size_t>(frame)]);
          }
        }
        const Instant now{Instant::NEWEST, 2 * SECOND};
        EXPECT_EQ(poseBetween(buffer, nameOf(target), nameOf(source), now).oldest, oldest)
            << i << ": " << nameOf(source) << " in " << nameOf(target);
      }
    }
  }
  EXPECT_GT(nb_up, 1000);
  EXPECT_GT(nb_mixed, 1000);
}

// tf2 walks up from one frame before it walks up from the other, also by what is not known: above
// where the two ways meet it must not come.
TEST(FramePoses, AreThoseOfKnownTransformsAloneWhateverElseTf2Has) {
  RandomInputs random;
  int nb_known = 0, nb_from_below = 0;
  for (int i = 0; i < 500; ++i) {
    const int nb_frames = random.integer(3, 7);
    const auto nameOf = [](int frame) { return "f" + std::to_string(frame); };
    TransformBuffer buffer{PoseLimits{0.4, 0.5, 0.5}};
    const auto take = [&](const std::string& parent, int frame, const Eigen::Isometry3d& X_PF,
                          const std::vector<double>& stamps) {
      for (const double seconds : stamps) {
        const auto stamp = static_cast<StampNs>(seconds * 1e9);
        buffer.take(
            {parent, nameOf(frame), stamp, X_PF.translation(), Eigen::Quaterniond(X_PF.linear())},
            false, "", stamp);
      }
    };
    std::vector<int> parents;
    std::vector<Eigen::Isometry3d> X_PF;
    for (int frame = 0; frame < nb_frames; ++frame) {
      const bool is_known = frame > 0 && random.integer(0, 2) > 0;
      const int parent = frame == 0 ? -1 : random.integer(0, frame - 1);
      parents.push_back(is_known ? parent : -1);
      X_PF.push_back(random.pose(1.0));
      const int other = (frame + random.integer(1, nb_frames - 1)) % nb_frames;
      if (!is_known) take(nameOf(other), frame, random.pose(1.0), {1.0});
      const std::string name = parent < 0 ? "map" : nameOf(parent);
      take(name, frame, X_PF.back(), is_known ? std::vector{1.95, 2.05} : std::vector{2.05});
    }
    for (int target = 0; target < nb_frames; ++target) {
      for (int source = 0; source < nb_frames; ++source) {
        Eigen::Isometry3d X_RT, X_RS;
        const int root = rootOf(target, parents, X_PF, X_RT);
        const bool is_known = root == rootOf(source, parents, X_PF, X_RS);
        nb_known += is_known && source != target;
        nb_from_below += is_known && root == source && source != target;
        SCOPED_TRACE("case " + std::to_string(i));
        const auto X_TS = poseAt(buffer, nameOf(target), nameOf(source), 2 * SECOND);
        ASSERT_EQ(X_TS.has_value(), is_known);
        if (!is_known) continue;
        EXPECT_TRUE(X_TS->isApprox(X_RT.inverse() * X_RS, 1e-9));
      }
    }
  }
  EXPECT_GT(nb_known, 1000);
  EXPECT_GT(nb_from_below, 200);
}

}  // namespace collision_pairs::test_frame_ways
