// Checks that end at a number of contacts, or where a predicate says that it has seen enough.
#include <algorithm>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "demo_scene.h"
#include "random_case.h"

namespace collision_pairs::test_ends_early {

/// All contacts of a report between elements that are certainly in contact, in the order in which
/// a check without time budget finds them.
std::vector<Contact> certainContacts(const CollisionReport& report, const CollisionScene& scene) {
  std::vector<Contact> contacts;
  for (const PairReport& pair : report.pairs) {
    if (pair.state != PairState::CONTACT) continue;
    for (std::uint32_t i = 0; i < pair.nb_contacts; ++i) {
      const Contact& contact = report.contacts[pair.first_contact + i];
      if (contact.depth >= 0.0) contacts.push_back(contact);
    }
  }
  const auto key = [&](const Contact& contact) {
    const auto [low, high] = std::minmax(contact.elements.first, contact.elements.second);
    const bool is_cloud = scene.cloudOf(high) >= 0;
    return std::make_tuple(is_cloud, low, high);
  };
  std::sort(contacts.begin(), contacts.end(),
            [&](const Contact& a, const Contact& b) { return key(a) < key(b); });
  return contacts;
}

void expectSame(const Contact& found, const Contact& wanted) {
  EXPECT_EQ(found.elements, wanted.elements);
  EXPECT_EQ(found.voxel, wanted.voxel);
  EXPECT_EQ(found.depth, wanted.depth);
  EXPECT_EQ(found.p_WFirst, wanted.p_WFirst);
  EXPECT_EQ(found.p_WSecond, wanted.p_WSecond);
  EXPECT_EQ(found.nhat_W, wanted.nhat_W);
}

/// Every pair of the report is one of `whole`, of some of its elements, to the last bit.
void expectPartOf(const CollisionReport& whole, const CollisionReport& part) {
  for (const PairReport& pair : part.pairs) {
    const auto same = std::find_if(whole.pairs.begin(), whole.pairs.end(), [&](const auto& other) {
      return other.first == pair.first && other.second == pair.second;
    });
    ASSERT_TRUE(same != whole.pairs.end());
    EXPECT_GE(pair.distance, same->distance);
    const auto first = whole.contacts.begin() + same->first_contact;
    for (std::uint32_t i = 0; i < pair.nb_contacts; ++i) {
      const Contact& contact = part.contacts[pair.first_contact + i];
      const auto its = std::find_if(first, first + same->nb_contacts, [&](const Contact& other) {
        return other.elements == contact.elements;
      });
      ASSERT_TRUE(its != first + same->nb_contacts);
      expectSame(contact, *its);
    }
  }
}

/// The same scene and poses, with settings of every kind, all at once and up to some contacts.
class RandomEnds {
 public:
  explicit RandomEnds(RandomInputs& random)
      : its_(random), scene_(CollisionScene::build(withMore(random, its_.description))) {
    poses_ = randomPosesOf(random, its_, *scene_);
    settings_.alarm_distance = random.integer(0, 1) ? 0.1 : 0.0;
    const Fidelity rungs[] = {Fidelity::MESH, Fidelity::MESH, Fidelity::CONVEX, Fidelity::OBB,
                              Fidelity::AABB};
    settings_.fidelity = rungs[random.integer(0, 4)];
    settings_.min_distance = random.integer(0, 1);
    settings_.list_boxes = random.integer(0, 3) == 0;
    if (random.integer(0, 1)) {
      settings_.may_ignore = [](std::uint32_t a, std::uint32_t b) { return (a + b) % 3 == 0; };
    }
    whole_ = CollisionDetector(scene_).detect(poses_, settings_);
    contacts_ = certainContacts(whole_, *scene_);
  }

  /// `settings`: those of this, that may end early. Returns whether it did.
  bool expectFirstContacts(const CheckSettings& settings, std::size_t count) {
    const CollisionReport& report = detector_.detect(poses_, settings);
    EXPECT_EQ(report.ended_early, count > 0 && count <= contacts_.size());
    if (!report.ended_early) {
      EXPECT_EQ(report.verdict, whole_.verdict);
      EXPECT_EQ(report.min_distance, whole_.min_distance);
      EXPECT_EQ(report.min_distance_is_bound, whole_.min_distance_is_bound);
      EXPECT_EQ(report.pairs.size(), whole_.pairs.size());
      EXPECT_EQ(report.contacts.size(), whole_.contacts.size());
      EXPECT_EQ(report.ignored, whole_.ignored);
    } else {
      EXPECT_EQ(report.verdict, Verdict::COLLISION);
      EXPECT_TRUE(report.min_distance_is_bound);
      EXPECT_FALSE(report.nearest);
      double smallest = 0.0;
      for (const PairReport& pair : report.pairs) smallest = std::min(smallest, pair.distance);
      EXPECT_EQ(report.min_distance, smallest);
      EXPECT_TRUE(std::includes(whole_.ignored.begin(), whole_.ignored.end(),
                                report.ignored.begin(), report.ignored.end()));
    }
    const auto& listed = settings.list_boxes ? whole_.candidates : std::vector<BoxPair>();
    EXPECT_EQ(report.candidates, listed);
    expectPartOf(whole_, report);
    const auto found = certainContacts(report, *scene_);
    const std::size_t wanted = report.ended_early ? count : contacts_.size();
    EXPECT_EQ(found.size(), wanted);
    for (std::size_t i = 0; i < std::min(found.size(), wanted); ++i) {
      expectSame(found[i], contacts_[i]);
    }
    return report.ended_early;
  }

  bool areInContact(const BoxPair& elements) const {
    return std::any_of(contacts_.begin(), contacts_.end(),
                       [&](const Contact& contact) { return contact.elements == elements; });
  }

  const CheckSettings& settings() const { return settings_; }
  const std::vector<Contact>& contacts() const { return contacts_; }
  const CollisionReport& whole() const { return whole_; }
  CollisionDetector& detector() { return detector_; }
  const BodyPoses& poses() const { return poses_; }
  const CollisionScene& scene() const { return *scene_; }

 private:
  /// Hulls with few vertices may extend beyond the boxes, which are then the better bound.
  static SceneDescription withMore(RandomInputs& random, SceneDescription description) {
    description.objects.push_back(heap(random));
    description.objects.back().X_PO = random.pose(0.4);
    if (random.integer(0, 2) == 0) description.settings.max_hull_vertices = 8;
    return description;
  }

  RandomCase its_;
  std::shared_ptr<const CollisionScene> scene_;
  BodyPoses poses_;
  CheckSettings settings_;
  CollisionDetector detector_{scene_};
  CollisionReport whole_;
  std::vector<Contact> contacts_;
};

TEST(ACheckWithMaxContacts, ReportsTheFirstOfAllContactsAndSaysThatItEnded) {
  RandomInputs random;
  int nb_ended = 0, nb_whole = 0;
  for (int round = 0; round < 300 && !testing::Test::HasFailure(); ++round) {
    SCOPED_TRACE(round);
    RandomEnds ends(random);
    CheckSettings settings = ends.settings();
    for (const int more : {1, 2, 5, 1000}) {
      settings.max_contacts = static_cast<std::uint32_t>(more);
      (ends.expectFirstContacts(settings, settings.max_contacts) ? nb_ended : nb_whole) += 1;
    }
  }
  EXPECT_GT(nb_ended, 100);
  EXPECT_GT(nb_whole, 100);
}

TEST(ACheckWithAPredicate, ShowsItEachContactOnceAndEndsWhereItSaysSo) {
  RandomInputs random;
  int nb_ended = 0;
  for (int round = 0; round < 200 && !testing::Test::HasFailure(); ++round) {
    SCOPED_TRACE(round);
    RandomEnds ends(random);
    const auto last = static_cast<std::size_t>(random.integer(1, 6));
    std::vector<Contact> shown;
    CheckSettings settings = ends.settings();
    settings.is_enough = [&](const Contact& contact) {
      shown.push_back(contact);
      return shown.size() == last;
    };
    nb_ended += ends.expectFirstContacts(settings, last);
    ASSERT_EQ(shown.size(), std::min(last, ends.contacts().size()));
    for (std::size_t i = 0; i < shown.size(); ++i) expectSame(shown[i], ends.contacts()[i]);
  }
  EXPECT_GT(nb_ended, 50);
}

// MoveIt's max_contacts_per_pair and max_contacts.
TEST(ACheckWithAPredicate, CanLimitTheContactsOfAPairOfModelsAndThoseOfAll) {
  RandomInputs random;
  int nb_more = 0;
  for (int round = 0; round < 100; ++round) {
    RandomEnds ends(random);
    const auto modelsOf = [&](const Contact& contact) {
      const auto& elements = ends.scene().elements();
      return std::make_pair(elements[contact.elements.first].model,
                            elements[contact.elements.second].model);
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> kept, in_all;
    std::size_t nb_kept = 0;
    CheckSettings settings = ends.settings();
    settings.is_enough = [&](const Contact& contact) {
      if (kept[modelsOf(contact)]++ == 0) ++nb_kept;
      return nb_kept == 3;
    };
    ends.detector().detect(ends.poses(), settings);
    for (const Contact& contact : ends.contacts()) ++in_all[modelsOf(contact)];
    EXPECT_EQ(nb_kept, std::min<std::size_t>(in_all.size(), 3));
    for (const auto& [pair, count] : kept) nb_more += count > 1;
  }
  EXPECT_GT(nb_more, 0);
}

TEST(ACheckThatMayEndEarly, UnderATimeBudgetStillReportsOnlyWhatIsTrue) {
  RandomInputs random;
  int nb_ended = 0, nb_spent = 0;
  for (int round = 0; round < 300 && !testing::Test::HasFailure(); ++round) {
    SCOPED_TRACE(round);
    RandomEnds ends(random);
    CheckSettings settings = ends.settings();
    settings.max_contacts = static_cast<std::uint32_t>(random.integer(1, 3));
    double now = 0.0;
    ends.detector().setClock([&] { return now += 1.0; });
    settings.time_budget = random.integer(0, 1) ? 1e6 : random.integer(1, 20);
    // The report may have contacts of elements that were not settled as well.
    std::size_t nb_found = 0;
    settings.is_enough = [&](const Contact& contact) {
      ++nb_found;
      EXPECT_TRUE(ends.areInContact(contact.elements));
      return false;
    };
    const CollisionReport& report = ends.detector().detect(ends.poses(), settings);
    EXPECT_LE(nb_found, settings.max_contacts);
    EXPECT_EQ(report.ended_early, nb_found == settings.max_contacts);
    if (nb_found > 0) {
      EXPECT_EQ(report.verdict, Verdict::COLLISION);
    } else if (!ends.contacts().empty()) {
      EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
    }
    if (settings.time_budget == 1e6) {
      EXPECT_EQ(nb_found, std::min<std::size_t>(settings.max_contacts, ends.contacts().size()));
      expectPartOf(ends.whole(), report);
    }
    nb_ended += report.ended_early;
    nb_spent += report.budget_spent;
  }
  EXPECT_GT(nb_ended, 50);
  EXPECT_GT(nb_spent, 20);
}

TEST(AVerdict, EndsAtTheFirstContactWhateverElseIsSet) {
  CollisionDetector detector(
      CollisionScene::build(robotFrom(slidingBoxes(3)), std::nullopt, nullptr));
  BodyPoses poses;
  poses.resize(3);  // all at the origin
  CheckSettings settings;
  settings.verdict_only = true;
  settings.max_contacts = 2;
  settings.is_enough = [](const Contact&) -> bool { throw std::logic_error("not asked"); };
  const CollisionReport& report = detector.detect(poses, settings);
  EXPECT_EQ(report.pairs.size(), 1u);
  EXPECT_TRUE(report.ended_early);
  EXPECT_FALSE(report.min_distance_is_bound);
  settings.verdict_only = false;
  EXPECT_THROW(detector.detect(poses, settings), std::logic_error);
  EXPECT_EQ(detector.report().verdict, Verdict::UNKNOWN);
  settings.is_enough = nullptr;
  EXPECT_EQ(detector.detect(poses, settings).contacts.size(), 2u);
  settings.max_contacts = 0;
  EXPECT_EQ(detector.detect(poses, settings).contacts.size(), 3u);
  EXPECT_FALSE(detector.report().ended_early);
}

}  // namespace collision_pairs::test_ends_early
