#include "pair_statistics.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <set>

#include "in_parallel.h"
#include "pair_probe.h"

namespace collision_pairs {
namespace {

// Distances found limit later queries only within a block, so that results are identical whichever
// thread processes which block.
constexpr std::uint64_t BLOCK = 256;
// A smaller improvement does not justify a complete query: links that rotate about a common axis
// have nearly the same distance in every state.
constexpr double WORTHWHILE = 0.99;

std::vector<PairEvidence> allowedPairs(const CollisionScene& scene, const JointSampler& sampler) {
  const auto& links = scene.robot().links();
  std::set<std::pair<int, int>> adjacent;
  for (const auto& [a, b] : scene.robot().adjacentLinks()) {
    adjacent.insert(std::minmax(scene.findModel(links[a].name), scene.findModel(links[b].name)));
  }
  std::vector<PairEvidence> pairs;
  const auto& models = scene.models();
  for (std::uint32_t a = 0; a < models.size(); ++a) {
    for (std::uint32_t b = a + 1; b < models.size(); ++b) {
      if (!scene.filter().allowed(a, b)) continue;
      PairEvidence pair;
      pair.first = a;
      pair.second = b;
      pair.adjacent = adjacent.count({static_cast<int>(a), static_cast<int>(b)}) > 0;
      pair.rigid = models[a].body == models[b].body;
      pair.not_moved =
          sampler.drawnInPartBetween(scene.robotBody(models[a]), scene.robotBody(models[b]));
      pairs.push_back(pair);
    }
  }
  return pairs;
}

/// The least distance that is above it; none is for 0, since what touches has been asked for.
double above(double clearance) {
  return clearance > 0.0 ? std::nextafter(clearance, std::numeric_limits<double>::infinity()) : 0.0;
}

void askPair(std::uint64_t state, double clearance, PairProbe& probe, PairEvidence& pair) {
  ++pair.trials;
  double distance = pair.nearest;
  if (probe.touches(pair.first, pair.second)) {
    ++pair.contacts;
    distance = 0.0;
  } else if (!pair.adjacent && pair.nearest > 0.0) {
    // Beyond `limit` nothing is of interest.
    double limit = state < MEASURED_STATES ? WORTHWHILE * pair.nearest : 0.0;
    if (pair.nearest > clearance) limit = std::max(limit, above(clearance));
    if (limit > 0.0) distance = probe.distance(pair.first, pair.second, limit);
    if (distance >= limit) return;
  }
  if (distance >= pair.nearest) return;
  pair.nearest = distance;
  pair.nearest_state = state;
}

bool isAsked(const PairEvidence& pair, std::uint64_t state) {
  if (pair.rigid) return state == 0;
  return !pair.adjacent || state < MEASURED_STATES;
}

/// Adds the states begin … end - 1 to `pairs`.
void countBlock(std::uint64_t begin, std::uint64_t end, const JointSampler& sampler,
                double clearance, PairProbe& probe, std::vector<PairEvidence>& pairs) {
  std::vector<double> positions;
  for (std::uint64_t state = begin; state < end; ++state) {
    sampler.draw(state, positions);
    probe.place(positions);
    for (PairEvidence& pair : pairs) {
      if (isAsked(pair, state)) askPair(state, clearance, probe, pair);
    }
  }
}

/// Blocks may come in any order.
void merge(const std::vector<PairEvidence>& block, std::vector<PairEvidence>& all) {
  const auto nearness = [](const PairEvidence& p) {
    return std::make_pair(p.nearest, p.nearest_state);
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].trials += block[i].trials;
    all[i].contacts += block[i].contacts;
    if (nearness(block[i]) < nearness(all[i])) {
      std::tie(all[i].nearest, all[i].nearest_state) = nearness(block[i]);
    }
  }
}

}  // namespace

std::vector<PairEvidence> countContacts(const std::shared_ptr<const CollisionScene>& scene,
                                        const JointSampler& sampler,
                                        const SamplingSettings& settings) {
  const std::vector<PairEvidence> start = allowedPairs(*scene, sampler);
  std::vector<PairEvidence> all = start;
  PairProbe zero_probe(scene);
  zero_probe.place(scene->robot().zeroPositions());
  const double beyond = above(settings.clearance);
  for (PairEvidence& pair : all) {
    pair.touches_at_zero = zero_probe.touches(pair.first, pair.second);
    pair.is_near_at_zero = !pair.touches_at_zero && beyond > 0.0 &&
                           zero_probe.distance(pair.first, pair.second, beyond) < beyond;
  }
  const std::uint64_t nb_blocks = settings.samples / BLOCK + (settings.samples % BLOCK > 0);
  std::uint64_t done = 0;
  std::mutex mutex;
  std::vector<std::optional<PairProbe>> probes(nbThreads(settings.threads, nb_blocks));
  inParallel(probes.size(), nb_blocks, [&](std::size_t thread, std::size_t number) {
    if (!probes[thread]) probes[thread].emplace(scene);
    const std::uint64_t begin = number * BLOCK;
    const std::uint64_t end = begin + std::min(BLOCK, settings.samples - begin);
    std::vector<PairEvidence> block = start;
    countBlock(begin, end, sampler, settings.clearance, *probes[thread], block);
    const std::lock_guard<std::mutex> lock(mutex);
    merge(block, all);
    done += end - begin;
    if (settings.progress) settings.progress(done);
  });
  return all;
}

}  // namespace collision_pairs
