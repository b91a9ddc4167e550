// Faces that coincide in decimals are in contact for every question, however the doubles that hold
// them are rounded; a few times that further apart they are not.
#include <gtest/gtest.h>

#include "abutting.h"
#include "collision_pairs/batch_check.h"
#include "collision_pairs/occupied_voxels.h"
#include "motion_fixtures.h"

namespace collision_pairs::test_abutting {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr int VOXEL = 50, FAR = 1000000;  // millimetres
constexpr double FCL_GAP = 1e-4;          // metres: FCL's own tolerances are smaller

void expectContact(NarrowPhase& narrow_phase, const PreparedShape& A, const PreparedShape& B,
                   const Isometry3d& X_AB, double offset, bool is_contact) {
  ASSERT_EQ(narrow_phase.touches(A, B, X_AB, 0.0, offset), is_contact);
  for (const double limit : {0.0, 1e-9, 1.0, INF}) {
    for (const double tolerance : {0.0, 1e-3}) {
      const PairDistance found = narrow_phase.distance(A, B, X_AB, limit, {tolerance, 0.0}, offset);
      ASSERT_EQ(found.distance <= 0.0, is_contact) << found.distance << ", limit " << limit;
      if (is_contact) {
        ASSERT_GE(found.distance, -1.0);
      }
    }
  }
  if (!is_contact) return;
  ASSERT_TRUE(narrow_phase.touches(A, B, X_AB, 0.01, offset));
  ASSERT_LE(narrow_phase.distance(A, B, X_AB, 1.0, {0.0, 0.01}, offset).distance, 0.0);
}

TEST(Abutting, AllPairsOfShapesAreInContactForTheNarrowPhaseAndApartAFewBandsFurther) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  for (int i = 0; i < 1000; ++i) {
    const Abutting where(random, VOXEL, i % 3 == 0 ? FAR : i % 3 == 1 ? 1000 : 0);
    const auto kind = [&] {
      return ABUTTING_KINDS[static_cast<std::size_t>(random.integer(0, 6))];
    };
    const std::string kind_a = kind(), kind_b = kind();
    const auto method = i % 10 == 0 ? NarrowPhaseMethod::FCL : NarrowPhaseMethod::NATIVE;
    const auto A = prepareShape(reachingTo(kind_a, metres(where.a), 1.0), method);
    const auto B = prepareShape(reachingTo(kind_b, metres(where.b), -1.0), method);
    const Isometry3d X_MW = i % 2 ? random.pose(0.0) : Isometry3d::Identity();  // M: of a map
    const Vector3d p_MA = X_MW * where.p_WA(), p_MB = X_MW * where.p_WB();
    Isometry3d X_AB = Isometry3d::Identity();
    X_AB.linear() = X_MW.linear().transpose() * X_MW.linear();
    X_AB.translation() = X_MW.linear().transpose() * (p_MB - p_MA);
    const double offset = p_MA.norm() + p_MB.norm();
    SCOPED_TRACE(std::to_string(i) + ": " + kind_a + ", " + kind_b);
    ASSERT_NO_FATAL_FAILURE(expectContact(narrow_phase, *A, *B, X_AB, offset, true));
    ASSERT_NO_FATAL_FAILURE(expectContact(narrow_phase, *B, *A, X_AB.inverse(), offset, true));
    Isometry3d X_within = X_AB;
    X_within.translation().x() += where.halfABand();
    ASSERT_NO_FATAL_FAILURE(expectContact(narrow_phase, *A, *B, X_within, offset, true));
    const bool by_fcl = method == NarrowPhaseMethod::FCL;
    X_AB.translation().x() += by_fcl ? FCL_GAP : where.severalBands();
    ASSERT_NO_FATAL_FAILURE(expectContact(narrow_phase, *A, *B, X_AB, offset, false));
    ASSERT_NO_FATAL_FAILURE(expectContact(narrow_phase, *B, *A, X_AB.inverse(), offset, false));
  }
}

/// A link that slides along x beside an object, or beside one voxel.
struct Scenes {
  Scenes(const Abutting& the_place, const std::string& kind_a, const std::string& kind_b)
      : where(the_place) {
    const std::string y = std::to_string(metres(where.y)), z = std::to_string(metres(where.z));
    description = described(
        RobotModel::fromUrdf("<robot name='sliding'>" + emptyLink("root") +
                                 linkWith("slider", linkReachingTo(kind_b, where.b)) +
                                 joint("slide", "prismatic", "root", "slider", "0 " + y + " " + z,
                                       "<axis xyz='1 0 0'/><limit lower='-2000' upper='2000'/>") +
                                 "</robot>",
                             abuttingMesh),
        {});
    if (kind_a == "voxel") {
      description.clouds.push_back(cloudOf("cloud", metres(VOXEL), {}));
      const VoxelCell cell((where.face - VOXEL) / VOXEL, cellOf(where.y), cellOf(where.z));
      voxels = {std::make_shared<const OccupiedVoxels>(metres(VOXEL), std::vector{cell})};
      return;
    }
    RigidObject object = boxAt("object", where.p_WA(), Vector3d::Ones());
    object.elements = {{reachingTo(kind_a, metres(where.a), 1.0), Isometry3d::Identity()}};
    description.objects.push_back(object);
  }

  static int cellOf(int millimetres) {
    return static_cast<int>(std::floor(static_cast<double>(millimetres) / VOXEL));
  }

  std::shared_ptr<const CollisionScene> build(NarrowPhaseMethod method, double padding) {
    description.settings.narrow_phase = method;
    description.settings.padding = padding;
    return CollisionScene::build(description);
  }

  /// The same verdict at `position` of the joint for every kind of check.
  void expectVerdict(const std::shared_ptr<const CollisionScene>& scene, double position,
                     Verdict wanted) {
    CollisionDetector detector(scene);
    BodyPoses poses;
    poses.voxels = voxels;
    std::vector<Isometry3d> X_RB;
    scene->robot().forwardKinematics({position}, X_RB);
    scene->gatherPoses(X_RB, poses);
    for (const double alarm_distance : {0.0, 0.01}) {
      for (const int how : {0, 1, 2, 3, 4}) {
        CheckSettings settings;
        settings.alarm_distance = alarm_distance;
        settings.verdict_only = how == 1;
        settings.min_distance = how == 2;
        settings.tolerance = how == 3 ? 1e-3 : 0.0;
        settings.time_budget = how == 4 ? 1e6 : 0.0;
        const CollisionReport& report = detector.detect(poses, settings);
        ASSERT_EQ(report.verdict, wanted) << "check " << how << ", alarm " << alarm_distance;
        for (const PairReport& pair : report.pairs) {
          ASSERT_EQ(pair.distance <= 0.0, wanted == Verdict::COLLISION);
        }
      }
    }
  }

  Verdict ofMotion(const std::shared_ptr<const CollisionScene>& scene, double from, double to) {
    return MotionCheck(scene).check({{from}, {to}}, {}, {}, voxels).verdict;
  }

  Abutting where;
  SceneDescription description;
  CloudVoxels voxels;
};

TEST(Abutting, LinksObjectsAndVoxelsAreInContactForEveryCheckAndApartAFewBandsFurther) {
  RandomInputs random;
  for (int i = 0; i < 300; ++i) {
    const Abutting where(random, VOXEL, i % 3 == 0 ? FAR : i % 3 == 1 ? 1000 : 0);
    const std::string links[] = {"box", "sphere", "cylinder", "slab", "barred"};
    const std::string kind_b = links[random.integer(0, 4)];
    const std::string kind_a = random.integer(0, 2) == 0
                                   ? "voxel"
                                   : ABUTTING_KINDS[static_cast<std::size_t>(random.integer(0, 6))];
    SCOPED_TRACE(std::to_string(i) + ": " + kind_a + ", " + kind_b);
    Scenes scenes(where, kind_a, kind_b);
    const double touching = where.p_WB().x(), apart = touching + where.severalBands();
    const auto native = scenes.build(NarrowPhaseMethod::NATIVE, 0.0);
    ASSERT_NO_FATAL_FAILURE(scenes.expectVerdict(native, touching, Verdict::COLLISION));
    const double within = touching + where.halfABand();
    ASSERT_NO_FATAL_FAILURE(scenes.expectVerdict(native, within, Verdict::COLLISION));
    ASSERT_NO_FATAL_FAILURE(scenes.expectVerdict(native, apart, Verdict::FREE));
    ASSERT_EQ(scenes.ofMotion(native, touching, touching), Verdict::COLLISION);
    ASSERT_EQ(scenes.ofMotion(native, within, within), Verdict::COLLISION);
    ASSERT_NE(scenes.ofMotion(native, touching, touching + 0.2), Verdict::FREE);
    ASSERT_EQ(scenes.ofMotion(native, touching + 0.02, touching + 0.2), Verdict::FREE);
    const auto fcl = scenes.build(NarrowPhaseMethod::FCL, 0.0);
    ASSERT_NO_FATAL_FAILURE(scenes.expectVerdict(fcl, touching, Verdict::COLLISION));
    ASSERT_NO_FATAL_FAILURE(scenes.expectVerdict(fcl, touching + FCL_GAP, Verdict::FREE));
    const auto padded = scenes.build(NarrowPhaseMethod::NATIVE, 0.005);
    ASSERT_NO_FATAL_FAILURE(scenes.expectVerdict(padded, touching, Verdict::COLLISION));
  }
}

TEST(Abutting, ABatchSaysWhatOneCheckSays) {
  RandomInputs random;
  for (const std::string kind : {"box", "cylinder", "barred"}) {
    const Abutting where(random, VOXEL, 1000);
    Scenes scenes(where, kind, "barred");
    BatchCheck batch(scenes.build(NarrowPhaseMethod::NATIVE, 0.0), 1);
    CheckSettings settings;
    settings.verdict_only = true;
    const double touching = where.p_WB().x();
    std::vector<Verdict> verdicts(BatchCheck::STATES_WORTH_A_STAGE);
    batch.runJoints(
        verdicts.size(), settings,
        [&](std::size_t i, std::vector<double>& q) {
          const double gaps[] = {where.severalBands(), 0.0, where.halfABand()};
          q = {touching + gaps[i % 3]};
        },
        {}, [&](std::size_t i, const CollisionReport& found) { verdicts[i] = found.verdict; });
    ASSERT_GT(batch.stageMemory(), 0u);
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
      ASSERT_EQ(verdicts[i], i % 3 ? Verdict::COLLISION : Verdict::FREE) << kind << ' ' << i;
    }
  }
}

}  // namespace collision_pairs::test_abutting
