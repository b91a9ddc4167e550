// Which cells points occupy, for how long, and which cells a query finds.
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/voxel_grid.h"
#include "random_inputs.h"

namespace collision_pairs::test_voxel_grid {

using Eigen::Vector3d;
using Cells = std::set<std::array<int, 3>>;

Cells cellsOf(const OccupiedVoxels& voxels) {
  Cells cells;
  voxels.forEach([&](const VoxelCell& cell) {
    EXPECT_TRUE(cells.insert({cell[0], cell[1], cell[2]}).second) << "twice";
  });
  EXPECT_EQ(cells.size(), voxels.size());
  return cells;
}

VoxelSettings settingsOf(double voxel_size) {
  VoxelSettings settings;
  settings.voxel_size = voxel_size;
  return settings;
}

TEST(OccupiedVoxels, HoldWhatTheyWereGivenInAnyOrder) {
  RandomInputs random;
  for (const int reach : {3, 100, VOXEL_RANGE - 1}) {
    std::vector<VoxelCell> cells;
    Cells wanted;
    for (int i = 0; i < 500; ++i) {
      const VoxelCell cell(random.integer(-reach - 1, reach), random.integer(-reach - 1, reach),
                           random.integer(-reach - 1, reach));
      cells.push_back(cell);
      wanted.insert({cell[0], cell[1], cell[2]});
    }
    EXPECT_EQ(cellsOf(OccupiedVoxels(0.1, cells)), wanted);
    std::vector<VoxelCell> order;
    OccupiedVoxels(0.1, cells).forEach([&](const VoxelCell& cell) { order.push_back(cell); });
    std::shuffle(cells.begin(), cells.end(), random.engine());
    std::vector<VoxelCell> again;
    OccupiedVoxels(0.1, cells).forEach([&](const VoxelCell& cell) { again.push_back(cell); });
    EXPECT_EQ(order, again);
  }
}

TEST(OccupiedVoxels, AQueryFindsTheCellsWhoseCubesAreNearAndNoOthers) {
  RandomInputs random;
  for (int round = 0; round < 200; ++round) {
    const double size = random.uniform(0.01, 0.2);
    std::vector<VoxelCell> cells;
    for (int i = 0; i < 100; ++i) {
      cells.emplace_back(random.integer(-20, 20), random.integer(-20, 20), random.integer(-9, 9));
    }
    const OccupiedVoxels voxels(size, cells);
    const Vector3d corner = random.vector(-20 * size, 20 * size);
    const Aabb box{corner, corner + random.vector(0.0, 5 * size)};
    const double reach = round % 3 == 0 ? 0.0 : random.uniform(0.0, 3 * size);
    Cells wanted, found;
    for (const VoxelCell& cell : cells) {
      const Vector3d low = size * cell.cast<double>();
      const Aabb cube{low, low + Vector3d::Constant(size)};
      if (std::sqrt(squaredGap(cube, box)) <= reach) wanted.insert({cell[0], cell[1], cell[2]});
    }
    voxels.forEachWithin(box, reach, [&](const VoxelCell& cell) {
      found.insert({cell[0], cell[1], cell[2]});
    });
    EXPECT_EQ(found, wanted);
    EXPECT_EQ(voxels.anyWithin(box, reach), !wanted.empty());
  }
}

TEST(OccupiedVoxels, ABoxThatTouchesAFaceFindsTheVoxelOnEitherSide) {
  for (const int axis : {0, 1, 2}) {
    for (const int cell_there : {-5, 3}) {
      VoxelCell cell = VoxelCell::Zero();
      cell[axis] = cell_there;
      const OccupiedVoxels voxels(0.25, {cell});  // its faces are exact
      for (const double side : {-1.0, 1.0}) {
        Aabb box{Vector3d::Constant(0.125), Vector3d::Constant(0.125)};
        box.min[axis] = box.max[axis] = 0.25 * (cell_there + (side > 0.0 ? 1 : 0));
        (side > 0.0 ? box.max : box.min)[axis] += side;
        EXPECT_TRUE(voxels.anyWithin(box, 0.0)) << axis << " " << cell_there << " " << side;
      }
    }
  }
}

TEST(OccupiedVoxels, BoundsAreTight) {
  const OccupiedVoxels voxels(0.5, {{-3, 2, 7}, {4, 2, -1}});
  EXPECT_EQ(voxels.bounds().min, Vector3d(-1.5, 1.0, -0.5));
  EXPECT_EQ(voxels.bounds().max, Vector3d(2.5, 1.5, 4.0));
  EXPECT_FALSE(OccupiedVoxels(0.5, std::vector<VoxelCell>{}).bounds().valid());
}

TEST(OccupiedVoxels, SizesAndCellsOutOfRangeAreRefused) {
  const std::vector<VoxelCell> none;
  EXPECT_THROW(OccupiedVoxels(0.0, none), InputError);
  EXPECT_THROW(OccupiedVoxels(-1.0, none), InputError);
  EXPECT_THROW(OccupiedVoxels(NAN, none), InputError);
  EXPECT_THROW(OccupiedVoxels(INFINITY, none), InputError);
  EXPECT_THROW(OccupiedVoxels(0.1, {{VOXEL_RANGE, 0, 0}}), InputError);
  EXPECT_THROW(OccupiedVoxels(0.1, {{0, -VOXEL_RANGE - 1, 0}}), InputError);
}

TEST(VoxelGrid, APointLiesInTheCellThatHoldsItAlsoAtBordersAndBelowZero) {
  RandomInputs random;
  const double inf = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 2000; ++round) {
    const double size = round % 2 == 0 ? 0.1 : random.uniform(0.001, 0.3);
    const int k = random.integer(-3000, 3000);
    for (const double p : {k * size, std::nextafter(k * size, -inf), std::nextafter(k * size, inf),
                           random.uniform(-30.0, 30.0), -0.0}) {
      VoxelGrid grid(settingsOf(size));
      grid.begin(0.0, Vector3d::Zero());
      grid.add({p, 0.0, -p});
      const Cells cells = cellsOf(*grid.end());
      ASSERT_EQ(cells.size(), 1u);
      const auto [x, y, z] = *cells.begin();
      EXPECT_LE(x * size, p);
      EXPECT_GT((x + 1) * size, p);
      EXPECT_EQ(y, 0);
      EXPECT_LE(z * size, -p);
      EXPECT_GT((z + 1) * size, -p);
    }
  }
}

TEST(VoxelGrid, WhatIsNotFiniteIsCountedAndWhatIsTooFarTruncates) {
  VoxelGrid grid(settingsOf(1.0));
  grid.begin(0.0, Vector3d::Zero());
  grid.add({NAN, 0, 0});
  grid.add({0, INFINITY, 0});
  grid.add({0, 0, 0.5});
  EXPECT_FALSE(grid.end()->isTruncated());
  EXPECT_EQ(grid.counts().not_finite, 2u);
  grid.begin(1.0, Vector3d::Zero());
  for (const double far : {1.0 * VOXEL_RANGE, -VOXEL_RANGE - 0.001, 1e300, 4294967296.5}) {
    grid.add({0, far, 0});
  }
  grid.add({0, VOXEL_RANGE - 0.5, -VOXEL_RANGE + 0.0});
  EXPECT_EQ(grid.counts().out_of_range, 4u);
  EXPECT_EQ(grid.counts().added, 1u);
  EXPECT_TRUE(grid.end()->isTruncated());
  EXPECT_EQ(cellsOf(*grid.end()), (Cells{{0, VOXEL_RANGE - 1, -VOXEL_RANGE}}));
  grid.begin(2.0, Vector3d::Zero());
  EXPECT_FALSE(grid.end()->isTruncated());
}

TEST(VoxelGrid, FewerPointsOfOneCloudDoNotOccupyAVoxel) {
  VoxelSettings settings = settingsOf(1.0);
  settings.min_points = 3;
  settings.decay = 10.0;
  VoxelGrid grid(settings);
  for (int cloud = 0; cloud < 3; ++cloud) {  // two points each time never make three
    grid.begin(cloud, Vector3d::Zero());
    for (int i = 0; i < 2; ++i) grid.add({0.5, 0.5, 0.5});
    for (int i = 0; i < 3; ++i) grid.add({-0.5, 0.1 * i, 0.5});
    EXPECT_EQ(cellsOf(*grid.end()), (Cells{{-1, 0, 0}}));
  }
}

TEST(VoxelGrid, CloudsThatAre4096InTheDecayOrMoreExpireTogetherAndNotTooEarly) {
  VoxelSettings settings = settingsOf(1.0);
  settings.decay = 4096.0;  // so that those within a second share a number
  VoxelGrid grid(settings);
  const std::array<int, 3> a{0, 0, 0}, b{5, 0, 0}, c{-7, 0, 0};
  double x = 0.5;
  for (const double stamp : {0.0, 0.75, 1.5}) {
    grid.begin(stamp, Vector3d::Zero());
    grid.add({x, 0, 0});
    grid.end();
    x = x == 0.5 ? 5.5 : -6.5;
  }
  EXPECT_EQ(cellsOf(*grid.at(4096.5)), (Cells{a, b, c})) << "a is with b";
  EXPECT_EQ(cellsOf(*grid.at(4097.0)), (Cells{c}));
  EXPECT_EQ(cellsOf(*grid.at(4097.5)), (Cells{c}));
  EXPECT_EQ(cellsOf(*grid.at(4098.0)), (Cells{}));
}

TEST(VoxelGrid, WithoutDecayEachCloudReplacesTheOneBefore) {
  VoxelGrid grid(settingsOf(1.0));
  grid.begin(0.0, Vector3d::Zero());
  grid.add({0.5, 0.5, 0.5});
  grid.end();
  grid.begin(0.0, Vector3d::Zero());
  grid.add({1.5, 0.5, 0.5});
  EXPECT_EQ(cellsOf(*grid.end()), (Cells{{1, 0, 0}}));
  EXPECT_EQ(cellsOf(*grid.at(1e9)), (Cells{{1, 0, 0}}));
}

TEST(VoxelGrid, AVoxelThatIsNotSeenAgainIsForgottenAfterItsDecay) {
  VoxelSettings settings = settingsOf(1.0);
  settings.decay = 1.0;
  VoxelGrid grid(settings);
  const auto see = [&](double stamp, double x) {
    grid.begin(stamp, Vector3d::Zero());
    grid.add({x, 0, 0});
    return cellsOf(*grid.end());
  };
  const std::array<int, 3> a{0, 0, 0}, b{5, 0, 0}, c{-7, 0, 0};
  EXPECT_EQ(see(0.0, 0.5), (Cells{a}));
  EXPECT_EQ(see(0.5, 5.5), (Cells{a, b}));
  EXPECT_EQ(see(1.0, -6.5), (Cells{a, b, c}));  // a is just one second old
  EXPECT_EQ(see(1.25, -6.5), (Cells{b, c}));
  EXPECT_EQ(cellsOf(*grid.at(1.5)), (Cells{b, c}));
  EXPECT_EQ(cellsOf(*grid.at(1.75)), (Cells{c}));
  EXPECT_EQ(cellsOf(*grid.at(2.5)), (Cells{}));
  EXPECT_EQ(see(2.6, 0.5), (Cells{a}));
  EXPECT_EQ(see(1.0, 5.5), (Cells{b})) << "a clock that goes back forgets all";
  EXPECT_EQ(cellsOf(*grid.at(0.5)), (Cells{b})) << "what is asked for does not turn it back";
  EXPECT_EQ(see(0.75, 0.5), (Cells{a}));
  grid.clear();
  EXPECT_EQ(cellsOf(*grid.at(1.0)), (Cells{}));
}

TEST(VoxelGrid, WhatIsForgottenTakesNoRoomFromTheNextCloud) {
  VoxelSettings settings = settingsOf(1.0);
  settings.decay = 1.0;
  settings.max_voxels = 100;
  VoxelGrid grid(settings);
  for (const auto& [stamp, count] : {std::pair{0.0, 100}, {10.0, 60}, {10.5, 40}, {20.0, 100}}) {
    grid.begin(stamp, {0, 0, 0});
    for (int i = 0; i < count; ++i) grid.add({10.0 * i + stamp, 10.0 * stamp, 0.5});
    const auto voxels = grid.end();
    EXPECT_EQ(voxels->size(), stamp == 10.5 ? 100u : static_cast<unsigned>(count)) << stamp;
    EXPECT_FALSE(voxels->isTruncated()) << stamp;
  }
}

TEST(VoxelGrid, AVoxelThatIsKeptStaysForOneCloudAndIsNotSeen) {
  for (const double decay : {0.0, 10.0}) {
    VoxelSettings settings = settingsOf(1.0);
    settings.decay = decay;
    VoxelGrid grid(settings);
    grid.begin(0.0, Vector3d::Zero());
    grid.add({0.5, 0.5, 0.5});
    grid.keep({7, 0, 0});
    const Aabb all{Vector3d::Constant(-9.0), Vector3d::Constant(9.0)};
    EXPECT_EQ(cellsOf(*grid.seen(all)), (Cells{{0, 0, 0}}));
    EXPECT_TRUE(grid.seen({Vector3d::Constant(5.0), Vector3d::Constant(9.0)})->isEmpty());
    EXPECT_EQ(cellsOf(*grid.end()), (Cells{{0, 0, 0}, {7, 0, 0}}));
    if (decay > 0.0) {
      EXPECT_EQ(cellsOf(*grid.at(10.5)), (Cells{{7, 0, 0}}));
    }
    grid.clear();
    grid.begin(0.0, Vector3d::Zero());
    grid.add({0.5, 0.5, 0.5});
    grid.keep({7, 0, 0});
    grid.end();
    grid.begin(1.0, Vector3d::Zero());
    grid.add({0.5, 0.5, 0.5});
    EXPECT_EQ(cellsOf(*grid.end()), (Cells{{0, 0, 0}}));
    EXPECT_TRUE(grid.unseen(all).empty());
    grid.begin(2.0, Vector3d::Zero());
    grid.keep({0, 0, 0});
    EXPECT_TRUE(grid.seen(all)->isEmpty());
    EXPECT_EQ(grid.unseen(all), (std::vector<VoxelCell>{{0, 0, 0}}));
    EXPECT_TRUE(grid.unseen({{9.0, 0.0, 0.0}, {10.0, 1.0, 1.0}}).empty());
    EXPECT_EQ(grid.end()->size(), 1u);
    grid.begin(3.0, Vector3d::Zero());
    EXPECT_EQ(grid.end()->size(), decay > 0.0 ? 1u : 0u);  // seen less than `decay` ago
  }
}

// The oracle: the last stamp of each cell. The time asked for may be later than the next clouds'.
TEST(VoxelGrid, DecayIsThatOfAListOfStamps) {
  RandomInputs random;
  VoxelSettings settings = settingsOf(0.1);
  settings.decay = 0.75;
  VoxelGrid grid(settings);
  std::map<std::array<int, 3>, double> last_seen;
  double stamp = 0.0;
  for (int cloud = 0; cloud < 300; ++cloud) {
    stamp += random.integer(0, 3) * 0.125;
    grid.begin(stamp, Vector3d::Zero());
    for (int i = random.integer(0, 20); i > 0; --i) {
      const VoxelCell cell(random.integer(-6, 6), random.integer(-6, 6), random.integer(-2, 2));
      grid.add(0.1 * (cell.cast<double>() + random.vector(0.1, 0.9)));
      last_seen[{cell[0], cell[1], cell[2]}] = stamp;
    }
    const auto wanted = [&](double now) {
      Cells cells;
      for (auto one = last_seen.begin(); one != last_seen.end();) {
        if (now - one->second <= settings.decay)
          cells.insert((one++)->first);
        else
          one = last_seen.erase(one);
      }
      return cells;
    };
    ASSERT_EQ(cellsOf(*grid.end()), wanted(stamp)) << "cloud " << cloud;
    if (random.integer(0, 2) != 0) continue;
    const double now = stamp + random.integer(0, 6) * 0.125;
    ASSERT_EQ(cellsOf(*grid.at(now)), wanted(now)) << "after cloud " << cloud;
  }
}

TEST(VoxelGrid, OfTooManyVoxelsTheNearestStayAndTheRestIsSaidToBeMissing) {
  RandomInputs random;
  VoxelSettings settings = settingsOf(0.1);
  settings.max_voxels = 50;
  for (int round = 0; round < 100; ++round) {
    VoxelGrid grid(settings);
    const Vector3d sensor = random.vector(-3.0, 3.0);
    grid.begin(0.0, sensor);
    const int reach = random.integer(4, 40);
    Cells added;
    while (added.size() < 60) {
      const VoxelCell cell(random.integer(-reach, reach), random.integer(-reach, reach),
                           random.integer(-reach, reach));
      added.insert({cell[0], cell[1], cell[2]});
      grid.add(0.1 * (cell.cast<double>() + Vector3d::Constant(0.5)));
    }
    const auto voxels = grid.end();
    EXPECT_TRUE(voxels->isTruncated());
    const Cells kept = cellsOf(*voxels);
    ASSERT_EQ(kept.size(), 50u);
    const auto away = [&](const std::array<int, 3>& c) {
      return (0.1 * Vector3d(c[0] + 0.5, c[1] + 0.5, c[2] + 0.5) - sensor).norm();
    };
    double furthest_kept = 0.0, nearest_dropped = 1e9;
    for (const auto& cell : added) {
      if (kept.count(cell) > 0) {
        furthest_kept = std::max(furthest_kept, away(cell));
      } else {
        nearest_dropped = std::min(nearest_dropped, away(cell));
      }
    }
    EXPECT_LE(furthest_kept, nearest_dropped + 1e-12);
    grid.begin(1.0, sensor);
    grid.add({0, 0, 0});
    EXPECT_FALSE(grid.end()->isTruncated());
  }
}

TEST(VoxelGrid, AnEndlessCloudKeepsWhatIsNearAndNoMore) {
  RandomInputs random;
  VoxelSettings settings = settingsOf(0.01);
  settings.max_voxels = 1000;
  for (const double decay : {0.0, 1.0}) {
    settings.decay = decay;
    VoxelGrid grid(settings);
    grid.begin(0.0, Vector3d::Zero());
    for (int i = 0; i < 200000; ++i) grid.add(random.vector(-50.0, 50.0));
    for (int i = 0; i < 100; ++i) grid.add({0.01 * i, 0.0, 0.0});  // near, and last
    const auto voxels = grid.end();
    EXPECT_TRUE(voxels->isTruncated());
    EXPECT_LE(voxels->size(), 1000u);
    const Cells cells = cellsOf(*voxels);
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(cells.count({i, 0, 0}) || cells.count({i - 1, 0, 0}));
    }
    grid.begin(0.5, Vector3d::Zero());
    EXPECT_EQ(grid.end()->isTruncated(), decay > 0.0) << "what was left out is not forgotten yet";
    grid.begin(1.25, Vector3d::Zero());
    EXPECT_FALSE(grid.end()->isTruncated());
  }
}

TEST(VoxelGrid, SettingsOutOfTheirRangeAreRefused) {
  const auto refused = [](const std::function<void(VoxelSettings&)>& change) {
    VoxelSettings settings;
    change(settings);
    EXPECT_THROW(VoxelGrid{settings}, InputError);
  };
  refused([](VoxelSettings& s) { s.voxel_size = 0.0; });
  refused([](VoxelSettings& s) { s.voxel_size = NAN; });
  refused([](VoxelSettings& s) { s.decay = -1.0; });
  refused([](VoxelSettings& s) { s.decay = NAN; });
  refused([](VoxelSettings& s) { s.min_points = 0; });
  refused([](VoxelSettings& s) { s.max_voxels = 0; });
  VoxelGrid grid{VoxelSettings{}};
  EXPECT_THROW(grid.begin(NAN, Vector3d::Zero()), InputError);
  EXPECT_THROW(grid.begin(0.0, Vector3d(NAN, 0, 0)), InputError);
}

}  // namespace collision_pairs::test_voxel_grid
