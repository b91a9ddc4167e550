#include <atomic>
#include <stdexcept>

#include <gtest/gtest.h>

#include "collision_pairs/batch_check.h"
#include "demo_scene.h"
#include "random_inputs.h"

namespace collision_pairs::test_batch_check {

class Batch : public testing::Test {
 protected:
  Batch() : scene_(CollisionScene::build(robotFrom(slidingBoxes(6)), std::nullopt, nullptr)) {
    settings_.min_distance = true;
    for (int i = 0; i < 500; ++i) {
      BodyPoses poses;
      poses.resize(scene_->bodies().size());
      for (auto& X_WB : poses.X_WB) X_WB.translation() = random_.vector(-2.0, 2.0);
      states_.push_back(poses);
    }
  }

  std::vector<double> distances(unsigned threads) {
    std::vector<double> found(states_.size());
    BatchCheck batch(scene_, threads);
    batch.run(
        states_.size(), settings_, [&](std::size_t i, BodyPoses& poses) { poses = states_[i]; },
        [&](std::size_t i, const CollisionReport& r) { found[i] += r.min_distance; });
    return found;
  }

  RandomInputs random_;
  std::shared_ptr<const CollisionScene> scene_;
  CheckSettings settings_;
  std::vector<BodyPoses> states_;
};

TEST_F(Batch, AnswersEachStateOnceAndTheSameAtAnyNumberOfThreads) {
  CollisionDetector detector(scene_);
  std::vector<double> expected;
  for (const BodyPoses& poses : states_) {
    expected.push_back(detector.detect(poses, settings_).min_distance);
  }
  for (const unsigned threads : {1u, 2u, 7u, 0u}) EXPECT_EQ(distances(threads), expected);
}

TEST_F(Batch, PassesOnTheFirstFailureAndCanBeUsedAgain) {
  BatchCheck batch(scene_, 3);
  const auto pose = [&](std::size_t i, BodyPoses& poses) { poses = states_[i]; };
  EXPECT_THROW(batch.run(500, settings_, pose,
                         [](std::size_t i, const CollisionReport&) {
                           if (i == 77) throw std::runtime_error("stop");
                         }),
               std::runtime_error);
  std::atomic<int> taken{0};
  batch.run(500, settings_, pose, [&](std::size_t, const CollisionReport&) { ++taken; });
  EXPECT_EQ(taken, 500);
}

TEST_F(Batch, OfNothingIsNothing) {
  BatchCheck batch(scene_, 2);
  batch.run(
      0, settings_, [](std::size_t, BodyPoses&) { FAIL(); },
      [](std::size_t, const CollisionReport&) { FAIL(); });
}

}  // namespace collision_pairs::test_batch_check
