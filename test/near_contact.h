// A scene asked in every way about states a hair before contact: what one way sees, all see.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/batch_check.h"
#include "collision_pairs/collision_detector.h"
#include "joint_sampler.h"
#include "random_inputs.h"

namespace collision_pairs {

using NamePair = std::pair<std::string, std::string>;
using States = std::vector<std::vector<double>>;

// Metres. States are so near contact that rounding matters, and reports reach further.
constexpr double NEAREST = 1e-9, FURTHEST = 1e-3, NEAR = 1e-4, PADDING = 0.005;
// What two answers may differ by, from docs/accuracy.md: 64 roundings of the coordinates, for each
// of the two; with a cylinder 1e-9, for FCL 1e-7 of the bodies' size.
constexpr double ROUNDINGS = 2.0 * 64.0 * std::numeric_limits<double>::epsilon();
constexpr double OF_CYLINDERS = 2e-9, OF_FCL = 2e-7;

struct Answer {
  Verdict verdict = Verdict::UNKNOWN;
  std::map<NamePair, PairReport> pairs;
  double min_distance = 0.0;
};

inline CheckSettings verdictOnly() {
  CheckSettings settings;
  settings.verdict_only = true;
  return settings;
}

/// Asks one scene with one kind of settings. States are by joint, in the order of `joints`.
class Way {
 public:
  Way(const SceneDescription& description, const CheckSettings& settings, CloudVoxels voxels,
      SceneCache& cache)
      : scene_(CollisionScene::build(description, &cache)), detector_(scene_), settings_(settings) {
    poses_.voxels = std::move(voxels);
  }

  Answer ask(const std::vector<double>& positions) {
    scene_->robot().forwardKinematics(positions, X_RB_);
    scene_->gatherPoses(X_RB_, poses_);
    const CollisionReport& report = detector_.detect(poses_, settings_);
    Answer answer{report.verdict, {}, report.min_distance};
    for (const PairReport& pair : report.pairs) {
      const std::string &a = scene_->models()[pair.first].name,
                        &b = scene_->models()[pair.second].name;
      answer.pairs[std::minmax(a, b)] = pair;
    }
    return answer;
  }
  bool isFree(const std::vector<double>& positions) {
    return ask(positions).verdict == Verdict::FREE;
  }
  const std::shared_ptr<const CollisionScene>& scene() const { return scene_; }

 private:
  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  CheckSettings settings_;
  BodyPoses poses_;
  std::vector<Eigen::Isometry3d> X_RB_;
};

class NearContact {
 public:
  /// `coordinates`: metres, none is larger.
  NearContact(SceneDescription description, CloudVoxels voxels, double coordinates)
      : description_(std::move(description)),
        voxels_(std::move(voxels)),
        rounding_(ROUNDINGS * coordinates) {
    denyUsualContacts();
    verdict_ = make(description_, verdictOnly());
    CheckSettings report;
    report.alarm_distance = FURTHEST;
    add("report", description_, report);
    CheckSettings tolerant = report;
    tolerant.tolerance = NEAREST;
    add("tolerance", description_, tolerant, NEAREST);
    CheckSettings in_time = report;
    in_time.time_budget = 1e6;
    add("time budget", description_, in_time);
    CheckSettings smallest = report;
    smallest.min_distance = true;
    add("least distance", description_, smallest);
    SceneDescription other = description_;
    other.settings.narrow_phase = NarrowPhaseMethod::FCL;
    add("fcl", other, report, OF_FCL, true);
    for (const auto method : {NarrowPhaseMethod::NATIVE, NarrowPhaseMethod::FCL}) {
      other = description_;
      other.settings.narrow_phase = method;
      other.settings.padding = PADDING;
      padded_.push_back(make(other, report));
      padded_verdict_.push_back(make(other, verdictOnly()));
    }
    smallest.alarm_distance = 0.0;
    smallest_ = make(description_, smallest);
  }

  using Rename = std::function<std::string(const std::string&)>;
  /// The same bodies in another arrangement, with the same joints; `rename` is its own inverse.
  void addArrangement(const std::string& name, SceneDescription description,
                      const Rename& rename = {}) {
    description.settings.pair_rules = description_.settings.pair_rules;
    for (PairRule& rule : description.settings.pair_rules) {
      if (rename) rule.first = rename(rule.first), rule.second = rename(rule.second);
    }
    CheckSettings report;
    report.alarm_distance = FURTHEST;
    add(name, description, report, 0.0, true);
    ways_.back().rename = rename;
  }

  /// About `count` states from free ones towards ones in contact, to a hair before contact.
  States statesNearContact(RandomInputs& random, int count) {
    const JointSampler sampler = samplerOf(*verdict_, random);
    const auto pairs = static_cast<std::size_t>(count / STATES_OF_A_WAY);
    States free, in_contact, states;
    std::vector<double> q;
    for (std::uint64_t i = 0; i < 20 * pairs && std::min(free.size(), in_contact.size()) < pairs;
         ++i) {
      sampler.draw(i, q);
      (verdict_->isFree(q) ? free : in_contact).push_back(q);
    }
    for (std::size_t i = 0; i < std::min({pairs, free.size(), in_contact.size()}); ++i) {
      std::vector<double> apart = free[i], touching = in_contact[i];
      for (int halving = 0; halving < 50; ++halving) {
        const std::vector<double> middle = between(apart, touching, 0.5);
        (verdict_->isFree(middle) ? apart : touching) = middle;
      }
      for (int k = 0; k < STATES_OF_A_WAY; ++k) {
        const double exponent = random.uniform(std::log10(NEAREST), std::log10(FURTHEST));
        states.push_back(between(apart, free[i], std::pow(10.0, exponent)));
      }
    }
    return states;
  }

  void expectOneAnswer(const std::vector<double>& q) {
    std::vector<Answer> answers;
    for (const Asked& way : ways_) answers.push_back(renamed(way.way->ask(q), way.rename));
    const Answer& report = answers.front();
    std::set<NamePair> seen;
    for (std::size_t i = 0; i < ways_.size(); ++i) {
      SCOPED_TRACE(ways_[i].name);
      expectSame(report, answers[i], ways_[i], seen);
      if (testing::Test::HasFatalFailure()) return;
    }
    nb_near += seen.size();
    nb_questions += ways_.size() + 6;
    ASSERT_EQ(verdict_->isFree(q), report.verdict == Verdict::FREE);
    for (std::size_t i = 0; i < padded_.size(); ++i) {
      const Answer padded = padded_[i]->ask(q);
      ASSERT_EQ(padded_verdict_[i]->isFree(q), padded.verdict == Verdict::FREE);
      for (const auto& [names, pair] : report.pairs) {
        // A pair of two links keeps twice the padding, one with an object once.
        ASSERT_EQ(padded.pairs.count(names), 1u) << names.first << ", " << names.second;
        ASSERT_EQ(padded.pairs.at(names).state, PairState::CONTACT);
      }
    }
    double least = smallest_->ask(q).min_distance;
    for (const auto& [names, pair] : report.pairs) ASSERT_LE(least, pair.distance + slackOf(names));
    ASSERT_EQ(report.verdict == Verdict::FREE, least > 0.0);
  }

  void expectBatchAgrees(const States& states) {
    BatchCheck batch(verdict_->scene(), 1);
    const std::size_t count = std::max(states.size(), BatchCheck::STATES_WORTH_A_STAGE);
    std::vector<Verdict> verdicts(count);
    batch.runJoints(
        count, verdictOnly(),
        [&](std::size_t i, std::vector<double>& q) { q = states[i % states.size()]; }, voxels_,
        [&](std::size_t i, const CollisionReport& found) { verdicts[i] = found.verdict; });
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(verdicts[i] == Verdict::FREE, verdict_->isFree(states[i % states.size()])) << i;
    }
    nb_questions += count;
  }

  const SceneDescription& description() const { return description_; }
  std::uint64_t nb_questions = 0, nb_near = 0;

 private:
  static constexpr int STATES_OF_A_WAY = 4;
  struct Asked {
    std::string name;
    double slack;  ///< metres by which distances may differ from the report's, beside rounding
    bool rounds;   ///< nearer to contact than that, its contacts may differ
    std::unique_ptr<Way> way;
    Rename rename = {};
  };

  static std::vector<double> between(const std::vector<double>& a, const std::vector<double>& b,
                                     double share) {
    std::vector<double> middle = a;
    for (std::size_t i = 0; i < a.size(); ++i) middle[i] += share * (b[i] - a[i]);
    return middle;
  }

  static JointSampler samplerOf(const Way& way, RandomInputs& random) {
    const auto& scene = way.scene();
    return JointSampler(std::shared_ptr<const RobotModel>(scene, &scene->robot()),
                        static_cast<std::uint64_t>(random.integer(0, 1 << 30)));
  }

  std::unique_ptr<Way> make(const SceneDescription& description, const CheckSettings& settings) {
    return std::make_unique<Way>(description, settings, voxels_, cache_);
  }
  void add(const std::string& name, const SceneDescription& description,
           const CheckSettings& settings, double slack = 0.0, bool rounds = false) {
    ways_.push_back({name, slack, rounds, make(description, settings), {}});
  }

  static Answer renamed(Answer answer, const Rename& rename) {
    if (!rename) return answer;
    std::map<NamePair, PairReport> pairs;
    for (const auto& [names, pair] : answer.pairs) {
      pairs[std::minmax(rename(names.first), rename(names.second))] = pair;
    }
    answer.pairs = pairs;
    return answer;
  }

  /// So that few states are in contact.
  void denyUsualContacts() {
    CheckSettings contacts;
    contacts.alarm_distance = 0.0;
    const auto way = make(description_, contacts);
    RandomInputs random;
    const JointSampler sampler = samplerOf(*way, random);
    std::map<NamePair, int> nb_contacts;
    std::vector<double> q;
    for (std::uint64_t i = 0; i < 200; ++i) {
      sampler.draw(i, q);
      for (const auto& [names, pair] : way->ask(q).pairs) ++nb_contacts[names];
    }
    for (const auto& [names, count] : nb_contacts) {
      if (count <= 30) continue;
      description_.settings.pair_rules.push_back(
          {PairRule::Verdict::DENY, names.first, names.second});
    }
  }

  double slackOf(const NamePair& names) const {
    double slack = rounding_;
    const CollisionScene& scene = *verdict_->scene();
    for (const std::string& name : {names.first, names.second}) {
      const CollisionModel& model = scene.models()[static_cast<std::size_t>(scene.findModel(name))];
      for (std::uint32_t i = 0; i < model.nb_elements; ++i) {
        const Shape& shape = scene.elements()[model.first_element + i].shape;
        if (std::holds_alternative<Cylinder>(shape)) slack = rounding_ + OF_CYLINDERS;
      }
    }
    return slack;
  }

  /// Each near pair of one is in the other.
  void expectSame(const Answer& report, const Answer& other, const Asked& way,
                  std::set<NamePair>& seen) {
    for (const auto& [one, another] : {std::pair(&report, &other), std::pair(&other, &report)}) {
      for (const auto& [names, pair] : one->pairs) {
        if (pair.distance > NEAR) continue;
        SCOPED_TRACE(names.first + ", " + names.second + " at " +
                     std::to_string(1e9 * pair.distance) + " nm");
        seen.insert(names);
        ASSERT_EQ(another->pairs.count(names), 1u);
        const PairReport& same = another->pairs.at(names);
        const double slack = slackOf(names) + way.slack;
        if (pair.state != same.state) {
          ASSERT_TRUE(way.rounds);
          ASSERT_LE(std::max(pair.distance, same.distance), slack);
        } else if (pair.state != PairState::CONTACT) {
          ASSERT_NEAR(pair.distance, same.distance, slack);
        }
      }
    }
  }

  SceneDescription description_;
  SceneCache cache_;
  CloudVoxels voxels_;
  double rounding_;
  std::vector<Asked> ways_;
  std::unique_ptr<Way> verdict_, smallest_;
  std::vector<std::unique_ptr<Way>> padded_, padded_verdict_;
};

}  // namespace collision_pairs
