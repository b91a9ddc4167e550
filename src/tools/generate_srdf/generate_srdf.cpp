// generate_srdf: a URDF in, an SRDF out that switches off the pairs of links that need no check.
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "collision_pairs/input_error.h"
#include "pair_verdicts.h"
#include "progress_bar.h"
#include "scene_files.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double LEAST_PROBABILITY = 1e-12;  // 5e12 states would show less

struct Options {
  std::string robot, srdf, out, report;
  std::uint64_t samples = 50000, seed = 1;
  unsigned searches = 20, threads = 0;
  ClassRules rules;
  bool disable_default = false;
  std::string narrow_phase = "native";
};

void declare(CommandLine& command_line, Options& options) {
  command_line.operand(options.robot, "ROBOT.urdf", "the robot's URDF");
  command_line.input("srdf", options.srdf, "GIVEN.srdf",
                     "existing SRDF, which is kept and completed");
  command_line.option("samples", options.samples, "COUNT", "number of random joint states");
  command_line.option("seed", options.seed, "SEED", "seed of the random joint states");
  declareThreads(command_line, options.threads);
  command_line.option("confidence", options.rules.confidence, "SHARE",
                      "confidence of each bound, between 0 and 1");
  command_line.option(
      "max-probability", options.rules.max_probability, "SHARE",
      "'never' requires that the bound on the probability of contact is at most this");
  command_line.metres("clearance", options.rules.clearance,
                      "pairs that come this near are still checked, but those that nothing moves");
  command_line.option("searches", options.searches, "COUNT",
                      "searches for a contact, per pair without contact in random states");
  command_line.flag("disable-default", options.disable_default,
                    "disable pairs that touch with all joints at zero, even if not always");
  command_line.option("narrow-phase", options.narrow_phase, "NAME",
                      "method for pairs of shapes: native or fcl");
  command_line.output("out", options.out, "OUT.srdf", "output file (default: standard output)", "",
                      "srdf");
  command_line.output("report", options.report, "PAIRS.csv", "write a table of all pairs");
}

void refuseWrong(const Options& options) {
  const auto isShare = [](double value) { return value > 0.0 && value < 1.0; };
  if (options.samples == 0) throw InputError("--samples must be 1 or more");
  if (!isShare(options.rules.confidence)) {
    throw InputError("--confidence must lie between 0 and 1, like 0.99");
  }
  const double probability = options.rules.max_probability;
  if (!(probability >= LEAST_PROBABILITY && probability < 1.0)) {
    throw InputError("--max-probability must lie between 1e-12 and 1, like 1e-4");
  }
}

std::vector<PairEvidence> gather(const Options& options,
                                 const std::shared_ptr<const CollisionScene>& scene,
                                 const JointSampler& sampler) {
  std::vector<PairEvidence> evidence;
  {
    ProgressBar bar("random states", options.samples);
    const auto show = [&](std::uint64_t done) { bar.show(done); };
    evidence = countContacts(scene, sampler,
                             {options.samples, options.threads, show, options.rules.clearance});
  }
  ProgressBar bar("search", evidence.size());
  const auto show = [&](std::uint64_t done) { bar.show(done); };
  searchContacts(scene, sampler, {options.searches, options.samples, options.threads, show},
                 evidence);
  return evidence;
}

/// Explains the numbers in the lines, above the first of them.
SrdfLine headerOf(const Options& options) {
  return {
      formatted("generate_srdf: %llu random states, seed %llu, %u searches; bounds at "
                "confidence %g, never and always up to probability %g, clearance %g m",
                static_cast<unsigned long long>(options.samples),
                static_cast<unsigned long long>(options.seed), options.searches,
                options.rules.confidence, options.rules.max_probability, options.rules.clearance),
      "", "", ""};
}

/// None if there is no pair to add to a given SRDF: a second run does not change the output of the
/// first.
std::vector<SrdfLine> linesFor(const std::vector<PairVerdict>& verdicts, bool is_given,
                               const Options& options) {
  const bool adds_a_pair = std::any_of(verdicts.begin(), verdicts.end(),
                                       [](const PairVerdict& v) { return !v.reason.empty(); });
  if (is_given && !adds_a_pair) return {};
  std::vector<SrdfLine> lines = srdfLines(verdicts, options.rules);
  lines.insert(lines.begin(), headerOf(options));
  return lines;
}

void generate(const Options& options) {
  refuseWrong(options);
  const auto robot = readRobot(options.robot);
  std::optional<Srdf> given;
  TextFrom given_text;
  if (!options.srdf.empty()) {
    given_text = textFromFile(options.srdf);
    given = srdfFrom(given_text, *robot, warn);
  }
  SceneSettings settings;
  settings.narrow_phase = parseNarrowPhase(options.narrow_phase);
  const auto scene = CollisionScene::build(robot, Srdf{}, nullptr, settings);  // every pair
  if (!scene->unchecked().empty()) warn(scene->unchecked() + ": no pair is counted");
  const JointSampler sampler(robot, options.seed);
  if (!sampler.standingJoints().empty()) {
    warn("joints without a range to draw from are taken as zero: " +
         joined(sampler.standingJoints()));
  }
  const auto evidence = gather(options, scene, sampler);
  const auto verdicts = decide(evidence, *scene, given, options.rules, options.disable_default);
  const std::vector<SrdfLine> lines = linesFor(verdicts, given.has_value(), options);
  const std::string srdf = srdfWithLines(given_text.content, robot->name(), lines);
  if (!options.report.empty()) {
    writeTextFile(options.report, [&](std::ostream& out) {
      writePairTable(verdicts, *scene, sampler, options.rules, out);
    });
  }
  writeTextFile(options.out, [&](std::ostream& out) { out << srdf; });
  warnOf(verdicts, options.rules);
  std::cerr << "seed " << options.seed << ", " << summaryOf(verdicts) << '\n';
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  return runTool(argc, argv,
                 {"generate_srdf",
                  "Finds the pairs of links that need no collision check, and justifies each."},
                 declare, generate);
}
