// Worst error of the signed distance, relative to the bodies' size, against their size and against
// their offset from the origin: accuracy_scale OUT.csv [POSES]. Plotted by
// scripts/plot_accuracy_scale.py.
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "accuracy_rows.h"

namespace collision_pairs {
namespace {

constexpr double SIZE = 0.2;  // metres: of the bodies that accuracy_rows.h makes

// Bodies of size 0.2 * factor m, overlapping to one size apart. An offset is put into both poses,
// which then are all that a caller has to make X_AB from.
double worstRelativeError(const std::string& kind_a, const std::string& kind_b, double factor,
                          double offset, int poses) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  double worst = 0.0;
  for (int i = 0; i < poses; ++i) {
    const Shape a = scaled(randomShape(random, kind_a), factor);
    const Shape b = scaled(randomShape(random, kind_b), factor);
    const Eigen::Isometry3d X_AB_wanted = random.pose(2.0 * SIZE * factor);
    Eigen::Isometry3d X_WA = random.pose(0.0);
    X_WA.translation() = offset * Eigen::Vector3d(1.0, -0.7, 0.4);
    const Eigen::Isometry3d X_WB = X_WA * X_AB_wanted;
    const Eigen::Isometry3d X_AB = X_WA.inverse() * X_WB;
    const PairDistance result = narrow_phase.distance(*prepareShape(a), *prepareShape(b), X_AB,
                                                      std::numeric_limits<double>::infinity());
    const AnswerError error =
        judge(oracleBody(a), oracleBody(b), X_AB_wanted, result, 1e-9 * SIZE * factor);
    worst = std::max(worst, error.distance / (SIZE * factor));
  }
  return worst;
}

void writeRows(const char* path, int poses) {
  std::ofstream csv(path);
  csv << "varied,first,second,value,worst_relative_error\n";
  const std::vector<std::pair<std::string, std::string>> pairs{
      {"box", "box"},       {"box", "sphere"},   {"capsule", "capsule"},
      {"convex", "convex"}, {"box", "cylinder"}, {"cylinder", "cylinder"}};
  for (const auto& [a, b] : pairs) {
    for (int power = -6; power <= 6; ++power) {
      const double factor = std::pow(10.0, power) / SIZE;
      csv << "size," << a << ',' << b << ',' << factor * SIZE << ','
          << worstRelativeError(a, b, factor, 0.0, poses) << '\n';
    }
    for (int power = 0; power <= 8; ++power) {
      const double offset = std::pow(10.0, power);
      csv << "offset," << a << ',' << b << ',' << offset << ','
          << worstRelativeError(a, b, 1.0, offset, poses) << '\n';
    }
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: accuracy_scale OUT.csv [POSES]\n";
    return 2;
  }
  collision_pairs::writeRows(argv[1], argc > 2 ? std::atoi(argv[2]) : 300);
  return 0;
}
