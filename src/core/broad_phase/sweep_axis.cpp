#include "sweep_axis.h"

namespace collision_pairs {

int sweepAxis(const Spread& spread) {
  constexpr double CROWDED = 1.0 / 3.0;
  constexpr double WORTH_IT = 1.0 / 3.0;
  int widest = 0;
  int sparsest = 0;
  for (int k = 1; k < 3; ++k) {
    if (spread.deviation[k] > spread.deviation[widest]) widest = k;
    if (spread.crowd(k) < spread.crowd(sparsest)) sparsest = k;
  }
  const double crowd = spread.crowd(widest);
  const bool bad = crowd > CROWDED && spread.crowd(sparsest) < WORTH_IT * crowd;
  return bad ? sparsest : widest;
}

}  // namespace collision_pairs
