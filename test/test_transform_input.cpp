// Which transforms are taken, and how old a pose may be.
#include <cmath>

#include <gmock/gmock.h>

#include "collision_pairs/collision_scene.h"
#include "tf_poses.h"
#include "transform_test.h"

namespace collision_pairs::test_transform_input {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr double TOLERANCE = 0.5;  // s

TEST_F(Transforms, FromTheFutureAreRefusedAndNeverDisplaceAPresentOne) {
  receive("a", 999.9, 1.0);
  for (int i = 0; i < 100; ++i) receive("a", 4600.0 + 0.01 * i, 2.0);
  EXPECT_EQ(newestOf("a"), 1.0);
  EXPECT_THAT(input_.refused(), ElementsAre(HasSubstr("'a': its stamp is 36")));
  receive("a", 999.95, 3.0);
  EXPECT_EQ(newestOf("a"), 3.0);
  EXPECT_THAT(input_.refused(), IsEmpty());
}

TEST_F(Transforms, ThatAreNotFiniteOrNotRotationsAreRefused) {
  const std::pair<double, const char*> wrong[] = {{std::nan(""), "its quaternion is not finite"},
                                                  {0.0, "its quaternion is of length 0, not 1"},
                                                  {2.0, "its quaternion is of length 2, not 1"}};
  for (const auto& [w, says] : wrong) {
    auto message = linkAt("a", now_, 1.0);
    message.transforms[0].transform.rotation.w = w;
    input_.take(message, false, now_);
    EXPECT_THAT(input_.refused(), ElementsAre(HasSubstr(std::string("'a': ") + says)));
  }
  receive("a", 1000.0, HUGE_VAL);
  EXPECT_FALSE(knows("a"));
  EXPECT_THAT(input_.refused(), ElementsAre(HasSubstr("'a': its position is not finite")));
}

TEST_F(Transforms, OfOneMessageTheSoundOnesAreTaken) {
  auto message = linkAt("a", ros::Time(0), 1.0);
  message.transforms.push_back(linkAt("b", now_, 1.0).transforms[0]);
  input_.take(message, false, now_);
  EXPECT_FALSE(knows("a"));
  EXPECT_TRUE(knows("b"));
}

TEST_F(Transforms, ThatAreTooOldOrWithoutAStampOrContradictOthersAreNamed) {
  receive("a", 1000.0, 1.0);
  receive("a", 998.9, 2.0);
  EXPECT_EQ(newestOf("a"), 1.0);
  receive("b", 0.0, 1.0);
  input_.take(linkAt("c", ros::Time(4600.0), 2.0), true, now_);
  receive("c", 999.75, 1.0);
  play(1000.0, 1000.1, [&] {
    receiveBy("/honest", "d", now_.toSec(), 0.0);
    receiveBy("/liar", "d", now_.toSec() - 0.007, 3.0);
  });
  EXPECT_THAT(input_.refused(),
              ElementsAre(HasSubstr("'a': it was 1.10 s old when it arrived"),
                          HasSubstr("'b': its stamp is zero"),
                          HasSubstr("'c': it is published both on /tf and"),
                          HasSubstr("'d': '/honest' and '/liar' both publish it")));
}

TEST_F(Transforms, BeforeTheClockRunsAreRefusedUnlessStatic) {
  now_ = ros::Time(0);
  receive("a", 1000.0, 1.0);
  EXPECT_FALSE(knows("a"));
  input_.take(linkAt("b", ros::Time(5), 1.0), true, now_);
  EXPECT_TRUE(knows("b"));
}

TEST_F(Transforms, AreForgottenWhenTheClockGoesBackButForStaticOnes) {
  input_.take(linkAt("fixed", ros::Time(0), 1.0), true, now_);
  receive("a", 1000.0, 1.0);
  input_.followClock(ros::Time(1000.5));
  EXPECT_TRUE(knows("a"));
  input_.followClock(ros::Time(500.0));
  EXPECT_FALSE(knows("a"));
  EXPECT_TRUE(knows("fixed"));
  EXPECT_EQ(input_.nbClockJumps(), 1u);
}

TEST_F(Transforms, OfAnyStampAreSurvived) {
  for (const auto& stamp : {ros::TIME_MAX, ros::Time(4294967295u, 0), ros::Time(0, 1)}) {
    input_.take(linkAt("fixed", stamp, 1.0), true, now_);
    EXPECT_TRUE(knows("fixed")) << stamp;
    input_.take(linkAt("a", stamp, 1.0), false, now_);
  }
  for (const double now : {1.0, 4294967294.0}) {
    input_.take(linkAt("b", ros::TIME_MAX, 1.0), false, ros::Time(now));
    EXPECT_THAT(input_.refused(), ElementsAre(HasSubstr("ahead of the clock"))) << now;
  }
  for (int i = 0; i < 2; ++i) {  // nothing can be added to it
    input_.take(linkAt("b", ros::TIME_MAX, 1.0), false, ros::TIME_MAX);
  }
}

TEST_F(Transforms, OfAnotherPassOfTheClockHaveGapsOfTheirOwn) {
  for (const double stamp : {490.0, 495.0, 999.0, 492.0, 493.0, 498.0, 498.5}) {
    now_ = ros::Time(stamp);
    receive("a", stamp, 1.0);
  }
  EXPECT_NO_THROW(input_.lookUp("root", "a", ros::Time(492.5)));
  EXPECT_NO_THROW(input_.lookUp("root", "a", ros::Time(498.25))) << "once between 495 and 999";
  EXPECT_THROW(input_.lookUp("root", "a", ros::Time(495.0)), InputError);
}

TEST_F(Transforms, StayWhenThreadsTellTheClockOutOfOrder) {
  receive("a", 999.9, 1.0);
  input_.followClock(ros::Time(1000.0 - 0.09));
  EXPECT_TRUE(knows("a"));
  EXPECT_EQ(input_.nbClockJumps(), 0u);
  input_.followClock(ros::Time(1000.0 - 0.18));
  EXPECT_FALSE(knows("a")) << "small steps add up";
  EXPECT_EQ(input_.nbClockJumps(), 1u);
}

TEST_F(Transforms, AreTakenWholeAndCounted) {
  auto message = linkAt("a", now_, 1.0);
  auto& transform = message.transforms[0].transform;
  transform.translation.y = 2.0;
  transform.translation.z = 3.0;
  const Eigen::Quaterniond q = Eigen::Quaterniond(0.1, 0.3, 0.5, 0.7).normalized();
  transform.rotation.w = q.w();
  transform.rotation.x = q.x();
  transform.rotation.y = q.y();
  transform.rotation.z = q.z();
  for (const bool is_static : {false, true}) {
    TransformInput input;
    EXPECT_EQ(input.nbTaken(), 0u);
    input.take(message, is_static, now_);
    EXPECT_EQ(input.nbTaken(), 1u);
    const auto found = input.lookUp("root", "a", ros::Time(0));
    EXPECT_EQ(found.X_TS.translation(), Eigen::Vector3d(1, 2, 3));
    EXPECT_TRUE(found.X_TS.linear().isApprox(q.toRotationMatrix(), 1e-12));
    EXPECT_EQ(found.stamp, is_static ? ros::Time(0) : now_);
  }
}

TEST_F(Transforms, ThatAreRefusedAreNamedUpToAThousand) {
  for (int i = 0; i < 1001; ++i) receive("f" + std::to_string(i), 0.0, 1.0);
  EXPECT_EQ(input_.refused().size(), 1000u);
  input_.followClock(ros::Time(500.0));
  EXPECT_THAT(input_.refused(), IsEmpty()) << "of a clock that went back";
}

TEST_F(Transforms, ThatAreRefusedAreNamedForTwoSecondsAfterTheLast) {
  receive("a", 0.0, 1.0);
  const double steady = input_.now().steady;
  input_.followClock({now_, steady + 1.9});
  EXPECT_THAT(input_.refused(), ElementsAre(HasSubstr("'a'")));
  input_.followClock({now_, steady + 2.1});
  EXPECT_THAT(input_.refused(), IsEmpty());
}

TEST_F(Transforms, AreSuspectAlsoWhereTheClockStandsStillAfterALittleStepBack) {
  TransformInput input(TransformSettings{PoseLimits{0.03, 1.0, TOLERANCE}, true});
  input.followClock({now_, 0.0});
  for (int i = 0; i < 5; ++i) input.followClock({now_ - ros::Duration(0.05), 0.02 * i});
  EXPECT_THAT(input.clockProblem(), HasSubstr("/clock stands still"));
  EXPECT_EQ(input.nbClockJumps(), 0u);
  EXPECT_EQ(input.now().stamp, now_) << "until the clock has caught up";
}

TEST_F(Transforms, AreSuspectWhileASimulatedClockStandsStill) {
  const auto problemOf = [&](double max_pose_age, bool is_simulated, bool allow_paused,
                             const ros::Time& now) {
    TransformInput input(
        TransformSettings{PoseLimits{max_pose_age, 1.0, TOLERANCE}, is_simulated, allow_paused});
    input.followClock({now, 7.0});
    EXPECT_EQ(input.clockProblem(), "");
    input.followClock({now, 7.25});
    const std::string problem = input.clockProblem();
    if (!now.isZero()) input.followClock({now + ros::Duration(0.01), 7.5});
    EXPECT_EQ(input.clockProblem(), "") << "it goes on";
    return problem;
  };
  EXPECT_THAT(problemOf(0.03, true, false, now_), HasSubstr("/clock stands still since 0.25 s"));
  EXPECT_EQ(problemOf(0.03, true, true, now_), "");
  EXPECT_EQ(problemOf(0.0, true, false, now_), "") << "no age matters";
  EXPECT_EQ(problemOf(0.03, true, false, ros::Time(0)), "") << "it has not begun";
  EXPECT_EQ(problemOf(9.0, true, false, now_), "") << "not yet";
  EXPECT_EQ(problemOf(0.03, false, false, now_), "") << "a real clock";
}

/// A sphere on a joint for each of "a" and "b", and one fixed to the root.
class Ages : public Transforms {
 protected:
  static std::shared_ptr<const CollisionScene> twoLinks() {
    std::string urdf = "<robot name='r'>";
    for (const char* link : {"root", "a", "b"}) {
      urdf += std::string("<link name='") + link +
              "'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>";
    }
    for (const char* link : {"a", "b"}) {
      urdf += std::string("<joint name='to_") + link +
              "' type='floating'><parent link='root'/><child link='" + link + "'/></joint>";
    }
    const auto robot = RobotModel::fromUrdf(urdf + "</robot>", {});
    Srdf none;
    return CollisionScene::build(robot, none, nullptr);
  }
  StampedPoses latest(const std::vector<std::string>& static_joints = {}) const {
    const TfPoses poses(input_, scene_->robot(), scene_->bodies(), "root", static_joints);
    return poses.latest(now_);
  }

  std::shared_ptr<const CollisionScene> scene_ = twoLinks();
};

/// An arm that floats above its root, with a tool fixed on it at x = 3.
class OneOfItsLinks : public Transforms {
 protected:
  Eigen::Vector3d arm(const std::string& frame) const {
    const TfPoses poses(input_, scene_->robot(), scene_->bodies(), frame);
    const StampedPoses found = poses.latest(now_);
    EXPECT_THAT(found.problems, IsEmpty());
    EXPECT_EQ(found.nb_asked, 1u) << "the other one is the frame";
    return found.poses.X_WB[scene_->models()[scene_->findModel("arm")].body].translation();
  }
  static std::shared_ptr<const CollisionScene> armWithTool() {
    const auto sphere = [](const std::string& link) {
      return "<link name='" + link +
             "'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>";
    };
    const auto robot = RobotModel::fromUrdf(
        "<robot name='r'>" + sphere("root") + sphere("arm") + sphere("tool") +
            "<joint name='j' type='floating'><parent link='root'/><child link='arm'/></joint>"
            "<joint name='k' type='fixed'><parent link='arm'/><child link='tool'/>"
            "<origin xyz='3 0 0'/></joint></robot>",
        {});
    return CollisionScene::build(robot, Srdf{}, nullptr);
  }
  std::shared_ptr<const CollisionScene> scene_ = armWithTool();
};

TEST_F(OneOfItsLinks, TellsWhereTheWholeBodyIs) {
  receive("tool", 999.9, 5.0);
  EXPECT_EQ(arm("root"), Eigen::Vector3d(2, 0, 0));
}

TEST_F(OneOfItsLinks, IsNamedIfNoneOfThemIsKnown) {
  input_.take(linkAt("elsewhere", ros::Time(999.9), 1.0), false, now_);
  const StampedPoses found =
      TfPoses(input_, scene_->robot(), scene_->bodies(), "root").latest(now_);
  EXPECT_THAT(found.problems, ElementsAre(HasSubstr("link 'arm'")));
  EXPECT_EQ(found.nb_asked, 1u);
  EXPECT_EQ(found.nb_found, 0u);
}

TEST_F(OneOfItsLinks, MayBeTheFrameOfTheReports) {
  receive("tool", 999.9, 5.0);
  EXPECT_EQ(arm("tool"), Eigen::Vector3d(-3, 0, 0));
}

TEST_F(Ages, AreCountedAgainstNow) {
  receive("a", 999.0, 1.0);
  receive("b", 999.0, 2.0);
  EXPECT_THAT(latest().problems, IsEmpty());
  now_ += ros::Duration(1e-3);
  EXPECT_THAT(latest().problems,
              ElementsAre(HasSubstr("'a': its newest transform is 1.00 s old"), HasSubstr("'b'")));
  EXPECT_THAT(latest().poses.known, UnorderedElementsAre(1, 0, 0));
}

/// The same with other limits: of the age, and of that relative to the newest.
class OtherAges : public Ages {
 protected:
  void expect(double max_pose_age, double max_transform_age, double now,
              const std::initializer_list<std::pair<const char*, double>>& received,
              const testing::Matcher<std::vector<std::string>>& problems) {
    TransformInput input(PoseLimits{max_pose_age, max_transform_age, TOLERANCE});
    for (const auto& [link, stamp] : received) {
      input.take(linkAt(link, ros::Time(stamp), 1.0), false, ros::Time(stamp));
    }
    const TfPoses poses(input, scene_->robot(), scene_->bodies(), "root");
    found_ = poses.latest(ros::Time(now));
    EXPECT_THAT(found_.problems, problems);
  }
  StampedPoses found_;
};

TEST_F(OtherAges, AreNoMatterAtZero) {
  expect(0.0, 1.0, 99999.0, {{"a", 999.0}, {"b", 999.0}}, IsEmpty());
}

TEST_F(OtherAges, AreCountedAgainstTheNewestToo) {
  expect(0.0, 1.5, 1000.0, {{"b", 998.0}, {"a", 1000.0}},
         ElementsAre(HasSubstr("'b': its newest transform is 2.00 s older")));
  expect(0.0, 2.0, 1000.0, {{"b", 998.0}, {"a", 1000.0}}, ElementsAre(HasSubstr("'a'")));
}

TEST_F(OtherAges, OfOneLinkDoNotHoldTheOthersBack) {
  expect(1.0, 5.0, 1000.0, {{"b", 998.0}, {"a", 998.5}, {"a", 999.0}, {"a", 1000.0}},
         ElementsAre(HasSubstr("'b'")));
  EXPECT_EQ(found_.stamp, ros::Time(1000.0));
}

TEST_F(Ages, DoNotApplyToStaticTransforms) {
  input_.take(linkAt("a", ros::Time(1.0), 1.0), true, now_);
  input_.take(linkAt("b", ros::Time(1.0), 1.0), true, now_);
  now_ += ros::Duration(1000.0);
  EXPECT_THAT(latest({"to_a", "to_b"}).problems, IsEmpty());
  EXPECT_TRUE(latest({"to_a", "to_b"}).stamp.isZero());
}

TEST_F(Ages, OfAChainOfStaticFramesThatBypassesTheJointCannotBeToldEither) {
  for (const char* frame : {"root", "a"}) {
    auto message = linkAt(frame, ros::Time(0), 1.0);
    message.transforms[0].header.frame_id = "table";
    input_.take(message, true, now_);
  }
  receive("b", 1000.0, 2.0);
  EXPECT_THAT(latest().problems, ElementsAre(HasSubstr("'a': only /tf_static places it")));
}

}  // namespace collision_pairs::test_transform_input
