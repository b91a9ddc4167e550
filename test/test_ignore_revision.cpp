// Lists of pairs are known by what the caller says of them, never by where they are.
#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "everything_in.h"
#include "ignored_pairs.h"
#include "pairs_kept.h"
#include "random_case.h"

namespace collision_pairs::test_ignore_revision {

void expectSame(const CollisionReport& found, const CollisionReport& wanted) {
  EXPECT_EQ(everythingIn(found), everythingIn(wanted));
  const auto& listed = found.ignored;  // in order, and none twice
  EXPECT_EQ(std::adjacent_find(listed.begin(), listed.end(), std::greater_equal<>()), listed.end());
}

CheckSettings randomSettings(RandomInputs& random) {
  CheckSettings settings;
  settings.alarm_distance = random.integer(0, 1) ? 0.1 : 0.0;
  settings.min_distance = random.integer(0, 1);
  settings.verdict_only = random.integer(0, 3) == 0;
  return settings;
}

/// An allowed collision matrix that changes in place, and counts who asks.
struct Matrix {
  int salt = 0;
  std::map<ModelPair, int> asked;

  MayIgnore predicate() {
    return [this](std::uint32_t first, std::uint32_t second) {
      ++asked[{first, second}];
      return ignores(first, second);
    };
  }
  bool ignores(std::uint32_t first, std::uint32_t second) const {
    return (31 * first + 17 * second + static_cast<std::uint32_t>(salt)) % 5 < 2;
  }
};

struct Round {
  explicit Round(RandomInputs& random) {
    const RandomCase its(random);
    scene = CollisionScene::build(its.description);
    poses = randomPosesOf(random, its, *scene);
  }
  std::shared_ptr<const CollisionScene> scene;
  BodyPoses poses;
};

// 0 is no number of a list: it keeps nothing, and does not hide that the number has changed.
TEST(AListOfPairs, IsAskedOncePerNumberAndAnewWhenItChanges) {
  RandomInputs random;
  int nb_kept = 0, nb_ignored = 0;
  for (int round = 0; round < 60; ++round) {
    const RandomCase its(random);
    const auto scene = CollisionScene::build(its.description);
    CollisionDetector detector(scene), fresh(scene);
    Matrix matrix, other;
    const MayIgnore predicate = matrix.predicate();  // one address for all lists
    std::uint64_t revision = 0;
    for (int check = 0; check < 40; ++check) {
      if (random.integer(0, 4) == 0) {
        const std::uint64_t before = revision;
        revision = static_cast<std::uint64_t>(random.integer(0, 3));
        if (revision == 0 || revision != before) matrix.asked.clear();
      } else if (revision == 0) {
        matrix.asked.clear();
      }
      matrix.salt = revision == 0 ? check : static_cast<int>(revision);
      const BodyPoses poses = randomPosesOf(random, its, *scene);
      CheckSettings settings = randomSettings(random);
      other.salt = matrix.salt;
      settings.may_ignore = other.predicate();
      other.asked.clear();
      fresh.detect(poses, settings);
      settings.may_ignore = predicate;
      settings.ignore_revision = revision;
      const std::size_t nb_before = matrix.asked.size();
      expectSame(detector.detect(poses, settings), fresh.report());
      for (const auto& [pair, times] : matrix.asked) EXPECT_EQ(times, 1);
      nb_kept += matrix.asked.size() - nb_before < other.asked.size();
      nb_ignored += !detector.report().ignored.empty();
    }
  }
  EXPECT_GT(nb_kept, 100);
  EXPECT_GT(nb_ignored, 100);
}

TEST(AListOfPairs, WithoutANumberIsAskedAnew) {
  RandomInputs random;
  int nb_asked = 0;
  for (int round = 0; round < 40; ++round) {
    const Round with(random);
    Matrix matrix;
    CheckSettings settings;
    settings.may_ignore = matrix.predicate();
    CollisionDetector detector(with.scene);
    for (int check = 0; check < 2; ++check) detector.detect(with.poses, settings);
    for (const auto& [pair, times] : matrix.asked) EXPECT_EQ(times, 2);
    nb_asked += !matrix.asked.empty();
  }
  EXPECT_GT(nb_asked, 20);
}

TEST(AListOfPairs, OfAnyLengthAsksForEachPairOnce) {
  std::map<ModelPair, int> asked;
  const MayIgnore may_ignore = [&](std::uint32_t first, std::uint32_t second) {
    ++asked[{first, second}];
    return (first + second) % 3 == 0;
  };
  constexpr std::uint32_t MODELS = 60;
  IgnoredPairs pairs;
  std::vector<ModelPair> ignored;
  for (const std::uint64_t revision : {7, 7, 8}) {
    pairs.begin(may_ignore, revision);
    ignored.clear();
    for (std::uint32_t a = 0; a < MODELS; ++a) {
      for (std::uint32_t b = a + 1; b < MODELS; ++b) {
        ASSERT_EQ(pairs.has(b, a), (a + b) % 3 == 0);
        ASSERT_EQ(pairs.has(a, b), (a + b) % 3 == 0);
        if ((a + b) % 3 == 0) ignored.push_back({a, b});
      }
    }
    EXPECT_EQ(pairs.list(), ignored);
  }
  EXPECT_EQ(asked.size(), MODELS * (MODELS - 1) / 2);
  for (const auto& [pair, times] : asked) ASSERT_EQ(times, 2) << pair.first << " " << pair.second;
}

TEST(ASelection, ThatIsBuiltWhereAnotherWasIsNotTakenForIt) {
  RandomInputs random;
  int nb_differing = 0;
  for (int round = 0; round < 60; ++round) {
    const auto [scene, poses] = Round(random);
    CollisionDetector detector(scene);
    std::optional<PairSelection> place(std::in_place, scene, Restriction{});
    CheckSettings settings;
    settings.selection = std::shared_ptr<const PairSelection>(std::shared_ptr<void>(), &*place);
    std::size_t nb_pairs = 0;
    for (const auto among : {PairSelection::Among::SELF, PairSelection::Among::WORLD}) {
      place.emplace(scene, Restriction{}, among);
      CheckSettings anew = settings;
      anew.selection = std::make_shared<PairSelection>(scene, Restriction{}, among);
      CollisionDetector fresh(scene);
      expectSame(detector.detect(poses, settings), fresh.detect(poses, anew));
      nb_differing +=
          detector.report().pairs.size() != std::exchange(nb_pairs, detector.report().pairs.size());
    }
  }
  EXPECT_GT(nb_differing, 20);
}

// A scene, too: a detector keeps its own alive, and a selection must be of that one.
TEST(AListOfPairs, OfAnotherSceneIsNotAskedForThisOne) {
  RandomInputs random;
  for (int round = 0; round < 40; ++round) {
    const RandomCase its(random);
    Matrix matrix;
    CheckSettings settings;
    settings.may_ignore = matrix.predicate();
    settings.ignore_revision = 1;
    std::optional<CollisionDetector> detector;
    for (const int salt : {0, 1, 2}) {
      const auto scene = CollisionScene::build(its.description);
      const BodyPoses poses = randomPosesOf(random, its, *scene);
      matrix.salt = salt;
      detector.emplace(scene);  // where the one before was, which has asked for revision 1
      CheckSettings anew = settings;
      anew.ignore_revision = 0;
      CollisionDetector fresh(scene);
      expectSame(detector->detect(poses, settings), fresh.detect(poses, anew));
    }
  }
}

TEST(APair, IsLeftIfAnAllowedOneIsKept) {
  RandomInputs random;
  int nb_with_world = 0;
  for (int round = 0; round < 30; ++round) {
    const auto scene = CollisionScene::build(RandomCase(random).description);
    const auto& models = scene->models();
    std::vector<ModelPair> all;
    for (std::uint32_t a = 0; a < models.size(); ++a) {
      for (std::uint32_t b = a + 1; b < models.size(); ++b) {
        const bool one_moves = models[a].body >= 0 || models[b].body >= 0;
        if (one_moves && scene->filter().allowed(a, b)) all.emplace_back(a, b);
      }
    }
    const auto isLeft = [&](const auto& is_kept) {
      return hasPair(*scene, scene->filter(), is_kept);
    };
    EXPECT_FALSE(isLeft([](auto, auto) { return false; }));
    for (const ModelPair& pair : all) {
      EXPECT_TRUE(isLeft([&](auto a, auto b) { return ModelPair(a, b) == pair; }));
      nb_with_world += models[pair.first].body < 0 || models[pair.second].body < 0;
    }
    const auto isOther = [&](auto a, auto b) {
      return std::find(all.begin(), all.end(), ModelPair(a, b)) == all.end();
    };
    EXPECT_FALSE(isLeft(isOther));
  }
  EXPECT_GT(nb_with_world, 30);
}

}  // namespace collision_pairs::test_ignore_revision
