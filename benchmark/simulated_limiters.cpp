#include "simulated_limiters.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace collision_pairs {

Limiter lawLimiter(std::shared_ptr<LimiterLaw> law,
                   std::shared_ptr<CertifiedSurroundings> surroundings) {
  return [law = std::move(law), surroundings = std::move(surroundings)](const LimiterView& view) {
    LimiterDecision decision = law->stop("no command");
    if (!view.command.empty()) {
      surroundings->setState(view.state);
      decision =
          law->decide({view.now, view.stamp, view.obstacles_age, view.command}, *surroundings);
    }
    law->published(view.now, decision);
    return decision.command;
  };
}

NodeLimiter::NodeLimiter(const LimiterScene& scene, RandomInputs& random, bool obeys, bool overruns)
    : random_(random),
      obeys_(obeys),
      overruns_(overruns),
      law_(scene.settings()),
      watch_(scene.joints(), scene.settings(), false),
      surroundings_(scene.seen(), scene.joints(), Fidelity::MESH) {}

Passed NodeLimiter::operator()(const LimiterView& view) {
  constexpr double TIME_TO_DECIDE = 0.02, OFTEN = 0.005, SELDOM = 0.03;  // s
  double took = 0.0;
  LimiterDecision decision = law_.stop("no command");
  if (!view.command.empty()) {
    const auto moves = [](double x) { return x != 0.0; };
    const bool asks = std::any_of(view.command.begin(), view.command.end(), moves);
    if (obeys_ && asks) watch_.asked(view.now);
    took = random_.uniform(0.0, overruns_ && random_.integer(0, 99) == 0 ? SELDOM : OFTEN);
    surroundings_.setState(view.state);
    const double publish_by = view.now + TIME_TO_DECIDE;
    decision =
        law_.decide({publish_by, view.stamp, view.obstacles_age, view.command}, surroundings_);
    if (took > TIME_TO_DECIDE) decision = law_.stop("overrun");
    if (obeys_ && !watch_.fault(view.now).empty()) decision = law_.stop("fault");
    if (!decision.reason.empty()) reason_ = decision.reason;
  }
  const double published = view.now + took;
  law_.published(published, decision);
  watch_.published(published, published, decision.command);
  return {decision.command, took};
}

bool NodeLimiter::measured(double now, double stamp, const std::vector<double>& positions) {
  const bool was_sound = watch_.fault(now).empty();
  for (std::size_t j = 0; j < positions.size(); ++j) {
    watch_.measured({j, stamp, positions[j]}, now);
  }
  const std::string fault = watch_.fault(now);
  if (!was_sound || fault.empty()) return false;
  if (nb_faults_++ == 0) {
    first_fault_ = now;
    fault_ = fault;
  }
  return obeys_;
}

Limiter servoLimiter(std::shared_ptr<CertifiedSurroundings> surroundings) {
  static constexpr double SELF = 0.01, SCENE = 0.02;  // m: its default thresholds
  static constexpr double PERIOD = 0.1;               // s: its default rate of checks is 10 Hz
  struct State {
    double checked = -1.0, scale = 1.0;
  };
  return [state = std::make_shared<State>(),
          surroundings = std::move(surroundings)](const LimiterView& view) {
    if (view.command.empty()) return view.command;
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
