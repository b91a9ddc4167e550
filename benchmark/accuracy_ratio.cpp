// Answers a hair from contact against an oracle of 100 digits, by the pair of shapes and the ratio
// of their sizes: accuracy_ratio OUT.csv [POSES]
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "close_pairs.h"

namespace collision_pairs {
namespace {

struct Cell {
  int nb_wrong = 0, nb_contradictions = 0, nb_bound = 0, nb_degraded = 0;
  double worst = 0.0, worst_of_goal = 0.0;  // of EXACT distances, over the smaller body; the goal
};

Cell measure(RandomInputs& random, const std::string& kind_a, const std::string& kind_b,
             double ratio, int poses) {
  Cell cell;
  for (int i = 0; i < poses; ++i) {
    const double offset = i % 2 ? std::pow(10.0, random.uniform(0.0, 8.0)) : 0.0;
    const ClosePair pair = closePair(random, kind_a, kind_b, ratio, offset);
    const CloseAnswer answer = ask(pair);
    cell.nb_wrong += answer.wrong_verdict;
    cell.nb_contradictions += answer.contradiction;
    cell.nb_bound += answer.found.certainty == Certainty::BOUND;
    cell.nb_degraded += answer.found.certainty == Certainty::DEGRADED;
    cell.worst = std::max(cell.worst, answer.error / pair.smaller());
    cell.worst_of_goal = std::max(cell.worst_of_goal, answer.error / pair.goal());
  }
  return cell;
}

void writeRows(std::ostream& csv, int poses) {
  RandomInputs random;
  const auto& kinds = convexKinds();
  csv << "first,second,ratio,poses,wrong,contradictions,bound,degraded,worst_over_smaller,"
         "worst_over_goal\n";
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    for (std::size_t j = i; j < kinds.size(); ++j) {
      for (int power = 0; power <= 12; ++power) {
        const double ratio = std::pow(10.0, power);
        const Cell cell = measure(random, kinds[i], kinds[j], ratio, poses);
        csv << kinds[i] << ',' << kinds[j] << ',' << ratio << ',' << poses << ',' << cell.nb_wrong
            << ',' << cell.nb_contradictions << ',' << cell.nb_bound << ',' << cell.nb_degraded
            << ',' << cell.worst << ',' << cell.worst_of_goal << std::endl;
      }
    }
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: accuracy_ratio OUT.csv [POSES]\n";
    return 2;
  }
  std::ofstream csv(argv[1]);
  csv.precision(2);
  collision_pairs::writeRows(csv, argc > 2 ? std::atoi(argv[2]) : 200);
  return 0;
}
