// Prints docs/accuracy.md's table of pairs with a cylinder that are hard to measure:
// accuracy_cylinders [POSES_PER_ROW]
#include <cstdio>
#include <cstdlib>

#include "cylinder_rows.h"

namespace collision_pairs {
namespace {

// Of the smaller body's size. Depths are closed in to the first, or as far as so many cones do.
constexpr double ORACLE_TOLERANCE = 1e-7;
constexpr int MAX_CONES = 300000;

struct Worst {
  int wrong = 0, degraded = 0, bounds = 0, touching = 0;
  double distance = 0.0, exact_depth = 0.0, bound = 0.0, witness = 0.0;
};

Worst measure(const CylinderRow& row, int poses) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  Worst worst;
  for (int i = 0; i < poses; ++i) {
    const PosedPair pair = row.make(random, i);
    const double size = std::min(extentOf(pair.a), extentOf(pair.b));
    const PairDistance result =
        narrow_phase.distance(*prepareShape(pair.a), *prepareShape(pair.b), pair.X_AB,
                              std::numeric_limits<double>::infinity());
    const CylinderError error = judgeCylinder(pair, result, ORACLE_TOLERANCE * size, MAX_CONES);
    const bool is_bound = result.certainty == Certainty::BOUND;
    worst.wrong += error.wrong_verdict;
    worst.degraded += result.certainty == Certainty::DEGRADED;
    worst.touching += result.touches();
    worst.bounds += is_bound;
    worst.distance = std::max(worst.distance, error.distance / size);
    double& depth = is_bound ? worst.bound : worst.exact_depth;
    depth = std::max(depth, error.depth / size);
    worst.witness = std::max(worst.witness, error.witness / size);
  }
  return worst;
}

void printRows(const std::vector<CylinderRow>& rows, int poses) {
  for (const CylinderRow& row : rows) {
    const Worst worst = measure(row, poses);
    std::printf("| %s | %d | %d | %.1e | %.1e | %.1e | %.0f %% | %.1e |\n", row.name.c_str(),
                worst.wrong, worst.degraded, worst.distance, worst.exact_depth, worst.bound,
                100.0 * worst.bounds / std::max(worst.touching, 1), worst.witness);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  const int poses = argc > 1 ? std::atoi(argv[1]) : 50;
  std::printf(
      "| pair | wrong yes/no | degraded | distance | depth | `BOUND` | are `BOUND` | witness "
      "points |\n"
      "|---|---|---|---|---|---|---|---|\n");
  printRows(coaxialRows(), poses);
  printRows(uponItselfRows(), poses);
  printRows(mixedRows(1e3), poses);
  printRows(mixedRows(1e6), poses);
  printRows(thinRows(), poses);
  return 0;
}
