#include "simulated_limiters.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace collision_pairs {

Limiter lawLimiter(std::shared_ptr<LimiterLaw> law,
                   std::shared_ptr<CertifiedSurroundings> surroundings) {
  return [law = std::move(law), surroundings = std::move(surroundings)](const LimiterView& view) {
    surroundings->setState(view.state);
    const LimiterDecision decision =
        law->decide({view.now, view.stamp, view.obstacles_age, view.command}, *surroundings);
    law->published(view.now, decision);
    return decision.command;
  };
}

Limiter servoLimiter(std::shared_ptr<CertifiedSurroundings> surroundings) {
  constexpr double SELF = 0.01, SCENE = 0.02;  // m: its default thresholds
  constexpr double PERIOD = 0.1;               // s: its default rate of checks is 10 Hz
  struct State {
    double checked = -1.0, scale = 1.0;
  };
  return [state = std::make_shared<State>(),
          surroundings = std::move(surroundings)](const LimiterView& view) {
    if (view.now - state->checked >= PERIOD) {
      state->checked = view.now;
      surroundings->setState(view.state);
      std::vector<NearPair> near;
      std::string why;
      const std::vector<double> any(view.command.size(), 1.0);
      surroundings->nearPairs(SCENE, any, near, why);
      state->scale = 1.0;
      const CollisionScene& scene = *surroundings->scene();
      const auto isLink = [&](const std::string& name) {
        const auto& model = scene.models()[scene.findModel(name)];
        return model.body >= 0 && !model.is_object;
      };
      for (const NearPair& pair : near) {
        const double threshold = isLink(pair.first) && isLink(pair.second) ? SELF : SCENE;
        const double k = -std::log(0.001) / threshold;
        if (pair.distance <= 0.0) state->scale = 0.0;
        if (pair.distance >= threshold) continue;
        state->scale = std::min(state->scale, std::exp(k * (pair.distance - threshold)));
      }
    }
    std::vector<double> passed = view.command;
    for (double& x : passed) x = std::isfinite(x) ? x * state->scale : 0.0;
    return passed;
  };
}

}  // namespace collision_pairs
