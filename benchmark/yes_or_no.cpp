// Yes or no of pairs with a cylinder: how fast, beside the distance and FCL, and whether the sign
// of the distance is the same: yes_or_no [POSES_PER_PAIR] [POSES_OF_SLIVERS]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include <fcl/narrowphase/collision.h>

#include "benchmark/cylinder_rows.h"

namespace collision_pairs {
namespace {

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr int REPETITIONS = 21, NB_TIMED = 2000;

struct TimedPair {
  std::shared_ptr<const PreparedShape> A, B;
  Eigen::Isometry3d X_AB;
  fcl::CollisionObjectd fcl_a, fcl_b;
};

std::shared_ptr<fcl::CollisionGeometryd> fclShape(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return std::make_shared<fcl::Boxd>(box->size);
  if (const auto* c = std::get_if<Capsule>(&shape)) {
    return std::make_shared<fcl::Capsuled>(c->radius, c->length);
  }
  const auto& c = std::get<Cylinder>(shape);
  return std::make_shared<fcl::Cylinderd>(c.radius, c.length);
}

// Overlapping, at random, bodies of about 20 cm.
std::vector<TimedPair> overlappingPairs(RandomInputs& random, const std::string& kind_a,
                                        const std::string& kind_b) {
  std::vector<TimedPair> pairs;
  NarrowPhase narrow_phase;
  while (pairs.size() < NB_TIMED) {
    const Shape a = randomShape(random, kind_a), b = randomShape(random, kind_b);
    const Eigen::Isometry3d X_AB = random.pose(0.15);
    const auto A = prepareShape(a), B = prepareShape(b);
    if (narrow_phase.distance(*A, *B, X_AB, INF).distance > 0.0) continue;
    pairs.push_back({A, B, X_AB, fcl::CollisionObjectd(fclShape(a)),
                     fcl::CollisionObjectd(fclShape(b), fcl::Transform3d(X_AB))});
  }
  return pairs;
}

template <class Ask>
double nanosecondsEach(const std::vector<TimedPair>& pairs, const Ask& ask) {
  const auto begin = std::chrono::steady_clock::now();
  for (const TimedPair& pair : pairs) {
    if (!ask(pair)) std::abort();
  }
  const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - begin;
  return time.count() / static_cast<double>(pairs.size());
}

// The three in turn, so that all meet the same noise; medians of means.
void time(RandomInputs& random, const std::string& kind_a, const std::string& kind_b) {
  const std::vector<TimedPair> pairs = overlappingPairs(random, kind_a, kind_b);
  NarrowPhase narrow_phase;
  std::array<std::vector<double>, 3> times;
  for (int i = 0; i < REPETITIONS; ++i) {
    times[0].push_back(nanosecondsEach(pairs, [&](const TimedPair& pair) {
      return narrow_phase.touches(*pair.A, *pair.B, pair.X_AB);
    }));
    times[1].push_back(nanosecondsEach(pairs, [&](const TimedPair& pair) {
      return narrow_phase.distance(*pair.A, *pair.B, pair.X_AB, 0.0).touches();
    }));
    times[2].push_back(nanosecondsEach(pairs, [&](const TimedPair& pair) {
      fcl::CollisionResultd result;
      fcl::collide(&pair.fcl_a, &pair.fcl_b, fcl::CollisionRequestd(), result);
      return true;  // its verdict may be wrong
    }));
  }
  for (auto& t : times) std::nth_element(t.begin(), t.begin() + REPETITIONS / 2, t.end());
  const auto median = [&](int who) { return times[who][REPETITIONS / 2]; };
  std::printf("| %s-%s | %.0f | %.0f | %.0f | %.1fx |", kind_a.c_str(), kind_b.c_str(), median(0),
              median(1), median(2), median(2) / median(0));
  std::fflush(stdout);
}

// What touches() and the sign of distance() say differently, further than rounding from touching.
struct Differences {
  void count(NarrowPhase& narrow_phase, const PosedPair& pair) {
    const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
    const PairDistance found = narrow_phase.distance(*A, *B, pair.X_AB, INF);
    if (narrow_phase.touches(*A, *B, pair.X_AB) == found.touches()) return;
    const double size = extentOf(pair.a) + extentOf(pair.b) + pair.X_AB.translation().norm();
    ++(std::abs(found.distance) <= 1e-15 * size ? within_rounding : others);
  }

  int within_rounding = 0, others = 0;
};

void compare(RandomInputs& random, const std::string& kind_a, const std::string& kind_b,
             int poses) {
  NarrowPhase narrow_phase;
  Differences differences;
  for (int i = 0; i < poses; ++i) {
    const Shape a = randomShape(random, kind_a), b = randomShape(random, kind_b);
    differences.count(narrow_phase, {a, b, random.pose(0.25)});
  }
  std::printf(" %d | %d | %d |\n", poses, differences.others, differences.within_rounding);
}

void compareSlivers(RandomInputs& random, int poses) {
  NarrowPhase narrow_phase;
  Differences differences;
  for (int i = 0; i < poses; ++i) {
    differences.count(narrow_phase, sliverPair(random, narrow_phase, i));
  }
  std::printf("| slivers | | | | | %d | %d | %d |\n", poses, differences.others,
              differences.within_rounding);
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  const int poses = argc > 1 ? std::atoi(argv[1]) : 250000;
  const int slivers = argc > 2 ? std::atoi(argv[2]) : 250000;
  RandomInputs random;
  std::printf(
      "| pair | yes or no, ns | distance, ns | FCL, ns | FCL / ours | poses | other verdict than "
      "the distance | the same within rounding |\n"
      "|---|---|---|---|---|---|---|---|\n");
  const std::vector<std::pair<std::string, std::string>> kinds{
      {"cylinder", "cylinder"}, {"box", "cylinder"}, {"cylinder", "capsule"}};
  for (const auto& [kind_a, kind_b] : kinds) {
    time(random, kind_a, kind_b);
    compare(random, kind_a, kind_b, poses);
  }
  compareSlivers(random, slivers);
  return 0;
}
