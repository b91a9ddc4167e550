// Millions of events in any order, and what the monitor makes of them: deterministic simulation,
// after FoundationDB's. Longer runs: COLLISION_PAIRS_SIMULATED_EVENTS=10000000.
#include <chrono>
#include <cstdlib>

#include <gtest/gtest.h>

#include "random_inputs.h"
#include "simulation/simulated_node.h"

namespace simulation {
namespace {

constexpr int EVENTS = 300;       // of a seed
constexpr double RECOVERY = 2.0;  // s

struct Outcome {
  std::string violation;
  std::size_t digest = 0;
  int nb_events = 0, nb_limited = 0;
  std::map<Verdict, int> counts;
};

Outcome run(const Scenario& setup, const std::vector<Event>& events, bool recovers) {
  SimulatedNode node(setup);
  Outcome outcome;
  for (const Event& event : events) {
    node.happen(event);
    ++outcome.nb_events;
    if (!node.violation().empty()) break;
  }
  if (node.violation().empty() && recovers) node.recover(RECOVERY);
  outcome.violation = node.violation();
  outcome.digest = node.digest();
  outcome.counts = node.counts;
  outcome.nb_limited = node.nb_limited;
  return outcome;
}

/// The fewest events that still violate the claim, as far as leaving out blocks of them leads.
std::vector<Event> shrunk(const Scenario& setup, std::vector<Event> events, bool recovers) {
  const auto beginOfViolation = [&](const std::vector<Event>& some) {
    return run(setup, some, recovers).violation.substr(0, 15);  // the rest has names and numbers
  };
  const std::string claim = beginOfViolation(events);
  const auto fails = [&](const std::vector<Event>& fewer) {
    return beginOfViolation(fewer) == claim;
  };
  for (std::size_t block = events.size() / 2; block > 0; block /= 2) {
    for (std::size_t at = 0; at < events.size();) {
      std::vector<Event> fewer = events;
      const std::size_t end = std::min(at + block, events.size());
      double dt = 0.0;
      for (std::size_t i = at; i < end; ++i) dt += fewer[i].dt;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(at),
                  fewer.begin() + static_cast<std::ptrdiff_t>(end));
      if (at < fewer.size()) fewer[at].dt += dt;
      if (fails(fewer)) {
        events = fewer;
      } else {
        at = end;
      }
    }
  }
  return events;
}

std::string printed(const Scenario& setup, const std::vector<Event>& events) {
  std::string all = setup.text();
  for (const Event& event : events) all += event.text();
  return all;
}

TEST(MonitorSimulation, NothingThatTouchesOrIsNotKnownIsFreeAndWhatIsSoundIsSoonFree) {
  const char* const given = std::getenv("COLLISION_PAIRS_SIMULATED_EVENTS");
  const int wanted = given ? std::atoi(given) : 200000;
  const unsigned first = collision_pairs::givenSeed();
  std::map<Verdict, int> counts;
  int nb_events = 0, nb_limited = 0;
  unsigned seed = first;
  for (; nb_events < wanted; ++seed) {
    Generator generator(seed);
    const Scenario setup = generator.setup();
    const std::vector<Event> events = generator.events(setup, EVENTS);
    const Outcome outcome = run(setup, events, true);
    nb_events += outcome.nb_events;
    nb_limited += outcome.nb_limited;
    for (const auto& [verdict, count] : outcome.counts) counts[verdict] += count;
    if (outcome.violation.empty()) continue;
    const bool while_sound = run(setup, events, false).violation.empty();
    const auto fewest = shrunk(setup, events, while_sound);
    FAIL() << "seed " << seed << ", after " << nb_events << " events: " << outcome.violation
           << "\nfewest events (" << fewest.size()
           << "): " << run(setup, fewest, while_sound).violation << '\n'
           << printed(setup, fewest);
  }
  std::printf(
      "%u sequences, %d events: %d free, %d in collision, %d unknown; the limiter could "
      "decide %d times\n",
      seed - first, nb_events, counts[Verdict::FREE], counts[Verdict::COLLISION],
      counts[Verdict::UNKNOWN], nb_limited);
  for (const Verdict verdict : {Verdict::FREE, Verdict::COLLISION, Verdict::UNKNOWN}) {
    EXPECT_GT(counts[verdict], wanted / 100) << static_cast<int>(verdict);
  }
  EXPECT_GT(nb_limited, wanted / 10);
}

TEST(MonitorSimulation, NothingGrowsWithoutBound) {
  for (unsigned seed = collision_pairs::givenSeed(), end = seed + 2; seed < end; ++seed) {
    Generator generator(seed);
    const Scenario setup = generator.setup();
    const std::vector<Event> events = generator.events(setup, 20000);
    const std::string violation = run(setup, events, false).violation;
    if (violation.empty()) continue;
    const auto fewest = shrunk(setup, events, false);
    FAIL() << "seed " << seed << ": " << violation << "\nfewest events (" << fewest.size()
           << "): " << run(setup, fewest, false).violation << '\n'
           << printed(setup, fewest);
  }
}

TEST(MonitorSimulation, TheSameEventsGiveTheSameReports) {
  for (unsigned seed = collision_pairs::givenSeed(), end = seed + 20; seed < end; ++seed) {
    Generator generator(seed);
    const Scenario setup = generator.setup();
    const std::vector<Event> events = generator.events(setup, EVENTS);
    EXPECT_EQ(run(setup, events, true).digest, run(setup, events, true).digest) << seed;
  }
}

}  // namespace
}  // namespace simulation
