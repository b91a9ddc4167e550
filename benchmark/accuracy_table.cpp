// Prints the accuracy table of docs/accuracy.md: accuracy_table [POSES_PER_ROW] [OUT.csv]
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "accuracy_rows.h"

namespace collision_pairs {
namespace {

constexpr double BAND = 1e-9 * 0.2;  // metres: of the bodies' size

struct Column {
  std::vector<double> values;
  double worst() { return at(1.0); }
  double at(double quantile) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(quantile * static_cast<double>(values.size() - 1))];
  }
};

struct Row {
  int wrong = 0, degraded = 0;
  Column distance, depth, witness, normal;
};

Row measure(RandomInputs& random, const std::string& kind_a, const std::string& kind_b, int poses) {
  Row row;
  NarrowPhase narrow_phase;
  constexpr std::array<Separation, 5> SEPARATIONS{Separation::APART, Separation::NEAR,
                                                  Separation::SLIGHT, Separation::DEEP,
                                                  Separation::TWO_MILLIMETRES};
  for (int i = 0; i < poses; ++i) {
    const Shape a = randomShape(random, kind_a), b = randomShape(random, kind_b);
    const auto A = prepareShape(a), B = prepareShape(b);
    const Eigen::Isometry3d X_AB =
        randomPose(random, narrow_phase, *A, *B, SEPARATIONS[static_cast<std::size_t>(i) % 5]);
    const PairDistance result =
        narrow_phase.distance(*A, *B, X_AB, std::numeric_limits<double>::infinity());
    const AnswerError error = judge(oracleBody(a), oracleBody(b), X_AB, result, BAND);
    row.wrong += error.wrong_verdict;
    row.degraded += result.certainty == Certainty::DEGRADED;
    (result.touches() ? row.depth : row.distance).values.push_back(error.distance);
    row.witness.values.push_back(error.witness);
    row.normal.values.push_back(error.normal);
  }
  return row;
}

void printTable(int poses, std::ostream& csv) {
  RandomInputs random;
  const std::vector<std::string> kinds{"box", "sphere", "cylinder", "capsule", "convex"};
  csv << "first,second,poses,wrong_verdicts,degraded,quantity,worst,p999\n";
  std::printf(
      "| pair | wrong yes/no | degraded | distance | depth | witness points | normal |\n"
      "|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    for (std::size_t j = i; j < kinds.size(); ++j) {
      Row row = measure(random, kinds[i], kinds[j], poses);
      std::printf("| %s-%s | %d | %d |", kinds[i].c_str(), kinds[j].c_str(), row.wrong,
                  row.degraded);
      const std::array<std::pair<const char*, Column*>, 4> columns{{{"distance", &row.distance},
                                                                    {"depth", &row.depth},
                                                                    {"witness", &row.witness},
                                                                    {"normal", &row.normal}}};
      for (const auto& [quantity, column] : columns) {
        std::printf(" %.1e / %.1e |", column->worst(), column->at(0.999));
        csv << kinds[i] << ',' << kinds[j] << ',' << poses << ',' << row.wrong << ','
            << row.degraded << ',' << quantity << ',' << column->worst() << ',' << column->at(0.999)
            << '\n';
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  const int poses = argc > 1 ? std::atoi(argv[1]) : 10000;
  std::ofstream csv(argc > 2 ? argv[2] : "/dev/null");
  collision_pairs::printTable(poses, csv);
  return 0;
}
