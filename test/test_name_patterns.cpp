// Names in rules: as patterns of the shell, or taken literally.
#include <algorithm>

#include <gtest/gtest.h>

#include "arm_scene.h"
#include "random_inputs.h"

namespace collision_pairs {
namespace test_name_patterns {

using Verdict = PairRule::Verdict;

/// Of the scene without an object, or empty.
std::string whyNotWithout(const CollisionScene& scene, const std::string& name) {
  try {
    scene.with({{}, {name}});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(NamePatterns, AreThoseOfTheShell) {
  EXPECT_TRUE(matches("left_*", "left_elbow"));
  EXPECT_TRUE(matches("*", "left/elbow"));
  EXPECT_TRUE(matches("finger_?", "finger_1"));
  EXPECT_TRUE(matches("finger_[12]", "finger_2"));
  EXPECT_FALSE(matches("finger_?", "finger_12"));
  EXPECT_FALSE(matches("elbow", "elbow_2"));
  EXPECT_TRUE(isPattern("a*"));
  EXPECT_FALSE(isPattern("a-b.c/d"));
}

TEST(NamePatterns, MeanTheNameThatTheyAreToo) {
  for (const char* name : {"box[1]", "what?", "a\\b", "["})
    EXPECT_TRUE(matches(name, name)) << name;
  EXPECT_TRUE(matches("box[1]", "box1"));
  EXPECT_FALSE(matches("a\\b", "ab"));
}

std::string nameOfPatternCharacters(RandomInputs& random) {
  const std::string characters("*?[]!-\\ab1/\0", 12);
  std::string name;
  for (int i = random.integer(1, 4); i > 0; --i) name += characters[random.integer(0, 11)];
  return name;
}

TEST(NamePatterns, LiterallyMatchThatNameAlone) {
  RandomInputs random;
  int matched_otherwise = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string a = nameOfPatternCharacters(random), b = nameOfPatternCharacters(random);
    EXPECT_FALSE(isPattern(literally(a)));
    EXPECT_EQ(withoutMark(literally(a)), a);
    EXPECT_TRUE(matches(literally(a), a)) << a;
    EXPECT_EQ(matches(literally(a), b), a == b) << a << " and " << b;
    EXPECT_EQ(matches(literally(a), literally(b)), a == literally(b)) << a << " and " << b;
    matched_otherwise += a != b && matches(a, b);
  }
  EXPECT_GT(matched_otherwise, 200);
}

// What a scene that treats each name literally gives for names that are no patterns, it gives for
// names that are.
TEST(NamePatterns, TakenLiterallyGiveThePairsOfAnyOtherNames) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    const std::vector<std::string> plain = {"crate", "table", "tool", "hat", "lid"};
    std::vector<std::string> odd;
    while (odd.size() < plain.size()) {
      const std::string name = nameOfPatternCharacters(random);
      if (std::find(odd.begin(), odd.end(), name) == odd.end()) odd.push_back(name);
    }
    const auto any = [&] { return random.integer(0, 4); };
    SceneDescription description = armScene("");
    SceneDescription described = armScene("");
    for (int i = 0; i < 5; ++i) {
      const std::string link = random.integer(0, 1) ? "wrist" : "";
      description.objects.push_back(ball(plain[i], link));
      described.objects.push_back(ball(odd[i], link));
    }
    for (int i = random.integer(1, 5); i > 0; --i) {
      const auto verdict = random.integer(0, 1) ? Verdict::ALLOW : Verdict::DENY;
      const int a = any(), b = any();
      const bool by_pattern = random.integer(0, 1);
      description.settings.pair_rules.push_back({verdict, plain[a], by_pattern ? "*" : plain[b]});
      described.settings.pair_rules.push_back(
          {verdict, literally(odd[a]), by_pattern ? "*" : literally(odd[b])});
    }
    if (random.integer(0, 1)) {
      const int a = any();
      description.restriction.names = {plain[a], "head"};
      described.restriction.names = {literally(odd[a]), "head"};
    }
    const auto scene = CollisionScene::build(description), other = CollisionScene::build(described);
    const auto named = [&](const std::string& name) {
      const auto found = std::find(plain.begin(), plain.end(), name);
      return found == plain.end() ? name : odd[found - plain.begin()];
    };
    Names expected;
    for (const auto& [a, b] : allowedPairs(*scene)) {
      expected.insert(std::minmax(named(a), named(b)));
    }
    EXPECT_EQ(allowedPairs(*other), expected) << "round " << round;
    const int gone = any();
    EXPECT_EQ(whyNotWithout(*other, odd[gone]) == "", whyNotWithout(*scene, plain[gone]) == "");
  }
}

TEST(NamePatterns, ANameTakenLiterallyMustExist) {
  SceneDescription description = armScene("");
  description.objects = {ball("box1")};
  const std::string why = ", which is not a link of robot 'test'; did you mean 'box1'?";
  description.restriction.names = {literally("box[1]")};
  EXPECT_EQ(refusal(description), "the restriction names 'box[1]'" + why);
  description.restriction.names.clear();
  description.settings.pair_rules = {{PairRule::Verdict::DENY, literally("box?"), "*"}};
  EXPECT_EQ(refusal(description), "pair_rules names 'box?'" + why);
  description.settings.pair_rules = {{PairRule::Verdict::DENY, "box?", "*"}};
  EXPECT_EQ(refusal(description), "accepted");
}

}  // namespace test_name_patterns
}  // namespace collision_pairs
