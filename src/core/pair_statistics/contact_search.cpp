// searchContacts(): searches for contacts that are too rare to show up in random states.
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "in_parallel.h"
#include "pair_probe.h"
#include "pair_statistics.h"

namespace collision_pairs {
namespace {

constexpr int STEPS = 200;  // steps are then too small to matter
constexpr double WORTHWHILE_STEP =
    0.99;                           // reduction of the distance that justifies as many steps again
constexpr int STARTS = 100;         // random states, of which the nearest is the start of a search
constexpr double FIRST_STEP = 0.1;  // relative to a joint's range
constexpr double GROWTH = 1.5;
const double SHRINKAGE = std::pow(GROWTH, -0.25);  // so that one success in five keeps the size

/// The search for one pair at a time.
class Search {
 public:
  Search(const std::shared_ptr<const CollisionScene>& scene, const JointSampler& sampler)
      : scene_(*scene), sampler_(sampler), probe_(scene), random_(sampler.stream(0)) {}

  void run(const RandomStream& random, unsigned searches, PairEvidence& pair) {
    random_ = random;
    pair_ = &pair;
    joints_ = sampler_.jointsBetween(scene_.robotBody(scene_.models()[pair.first]),
                                     scene_.robotBody(scene_.models()[pair.second]));
    if (joints_.empty()) return;
    sampler_.draw(pair.nearest_state, best_);
    best_distance_ = pair.nearest;
    for (unsigned i = 0; i < searches && pair.nearest > 0.0; ++i) {
      if (i > 0) beginAnew();
      descend();
      pair.nearest = std::min(pair.nearest, best_distance_);
    }
    if (pair.nearest == 0.0) pair.found_state = best_;
  }

 private:
  void beginAnew() {
    best_distance_ = std::numeric_limits<double>::infinity();
    for (int i = 0; i < STARTS; ++i) {
      tried_ = best_;
      for (const int joint : joints_) {
        tried_[joint] = sampler_.ranges()[joint].at(random_.uniform());
      }
      keepIfNearer();
    }
  }

  void descend() {
    double before;
    do {
      before = best_distance_;
      takeSteps();
    } while (best_distance_ < WORTHWHILE_STEP * before);
  }

  void takeSteps() {
    double step = FIRST_STEP;
    for (int i = 0; i < STEPS && best_distance_ > 0.0; ++i) {
      tried_ = best_;
      for (const int joint : joints_) {
        const auto& [lower, upper] = sampler_.ranges()[joint];
        const double move = step * (2.0 * random_.uniform() - 1.0) * (upper - lower);
        tried_[joint] = std::clamp(tried_[joint] + move, lower, upper);
      }
      step = std::min(step * (keepIfNearer() ? GROWTH : SHRINKAGE), 1.0);
    }
  }

  bool keepIfNearer() {
    sampler_.robot().applyMimics(tried_);
    probe_.placePair(pair_->first, pair_->second, tried_);
    const double distance = probe_.distance(pair_->first, pair_->second, best_distance_);
    if (distance >= best_distance_) return false;
    best_distance_ = distance;
    best_ = tried_;
    return true;
  }

  const CollisionScene& scene_;
  const JointSampler& sampler_;
  PairProbe probe_;
  RandomStream random_;
  const PairEvidence* pair_ = nullptr;
  std::vector<int> joints_;
  std::vector<double> best_, tried_;  // one entry per joint of the robot
  double best_distance_ = 0.0;        // at best_, metres
};

}  // namespace

void searchContacts(const std::shared_ptr<const CollisionScene>& scene, const JointSampler& sampler,
                    const SearchSettings& settings, std::vector<PairEvidence>& pairs) {
  std::mutex mutex;
  std::uint64_t done = 0;
  std::vector<std::optional<Search>> searches(nbThreads(settings.threads, pairs.size()));
  inParallel(searches.size(), pairs.size(), [&](std::size_t thread, std::size_t i) {
    if (!searches[thread]) searches[thread].emplace(scene, sampler);
    PairEvidence& pair = pairs[i];
    const bool touches = pair.contacts > 0 || pair.touches_at_zero;
    if (!pair.adjacent && !pair.rigid && !touches) {
      searches[thread]->run(sampler.stream(settings.first_free_state + i), settings.searches, pair);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    ++done;
    if (settings.progress) settings.progress(done);
  });
}

}  // namespace collision_pairs
