// A scene goes into a message and comes back as the same scene: no master needed.
#include <functional>
#include <iomanip>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ros/serialization.h>

#include "collision_pairs/collision_detector.h"
#include "monitored_robot.h"
#include "object_messages.h"
#include "random_robot.h"
#include "refusal.h"
#include "scene_message.h"
#include "yaml_values.h"

namespace collision_pairs::test_scene_message {

using testing::AllOf;
using testing::HasSubstr;

constexpr int POSTURES = 4;
const char* const KINDS[] = {"aabb", "spheres", "obb", "convex", "mesh"};

std::string linkOf(RandomInputs& random) {
  return (random.integer(0, 1) ? "left/link_" : "right/link_") +
         std::to_string(random.integer(0, 2));
}

/// Two robots, left and right, of at least three links each.
YAML::Node randomSettings(RandomInputs& random) {
  YAML::Node map(YAML::NodeType::Map);
  const auto maybe = [&] { return random.integer(0, 2) == 0; };
  const auto pair = [&](const char* other) {
    YAML::Node names;
    names.push_back(linkOf(random));
    names.push_back(other);
    return names;
  };
  if (maybe()) map["padding"] = random.uniform(0.0, 0.1);
  if (maybe()) map["link_padding"][linkOf(random)] = random.uniform(0.0, 0.2);
  if (maybe()) map["link_fidelity"][linkOf(random)] = KINDS[random.integer(0, 4)];
  if (maybe()) map["max_hull_vertices"] = random.integer(4, 30);
  if (maybe()) map["ignored_links"].push_back(linkOf(random));
  if (maybe()) map["static_joints"].push_back("left/joint_*");
  if (maybe()) map["cylinder_as_capsule"].push_back("right/*");
  if (maybe()) map["links"].push_back("left/*");
  if (maybe()) map["allow_empty_scene"] = true;
  if (maybe()) {
    YAML::Node entry;
    entry["pair"] = pair("right/*");
    entry["padding"] = random.uniform(0.0, 0.3);
    map["pair_padding"].push_back(entry);
  }
  for (int i = random.integer(0, 2); i > 0; --i) {
    YAML::Node rule;
    rule[random.integer(0, 1) ? "allow" : "deny"] = pair(random.integer(0, 1) ? "*" : "thing_*");
    map["pair_rules"].push_back(rule);
  }
  if (maybe()) {
    map["floor"]["height"] = random.uniform(-2.0, -0.5);
    map["floor"]["touch_links"].push_back(linkOf(random));
  }
  if (maybe()) {
    YAML::Node cloud;
    cloud["topic"] = "camera/points";
    cloud["voxel_size"] = random.uniform(0.01, 0.1);
    cloud["touch_links"].push_back(linkOf(random));
    map["clouds"].push_back(cloud);
  }
  return map;
}

std::string randomSrdf(RandomInputs& random) {
  std::string xml;
  for (int i = random.integer(0, 3); i > 0; --i) {
    xml += "<disable_collisions link1='link_" + std::to_string(random.integer(0, 1)) +
           "' link2='link_2' reason='Never'/>";
  }
  if (random.integer(0, 1)) xml += "<disable_default_collisions link='link_1'/>";
  return "<robot name='random'>" + xml + "</robot>";
}

/// As the node reads them.
SceneParameters randomParameters(RandomInputs& random) {
  const Warn ignore = [](const std::string&) {};
  SceneParameters parameters;
  for (const char* prefix : {"left", "right"}) {
    SceneSources::Robot robot;
    robot.source =
        robotSource({"urdf", randomUrdf(random, random.integer(3, 6))}, testMesh, ignore);
    if (random.integer(0, 1)) robot.readSrdf({"srdf", randomSrdf(random)}, ignore);
    robot.prefix = prefix;
    parameters.sources.robots.push_back(std::move(robot));
  }
  if (random.integer(0, 1)) {
    parameters.sources.world =
        robotSource({"world", "<robot name='w'>" +
                                  linkWith("cell", "<mesh filename='slab'/>",
                                           "<origin xyz='0.4 0 0.2' rpy='0.3 0 0'/>") +
                                  "</robot>"},
                    testMesh, ignore);
  }
  if (random.integer(0, 1)) parameters.fixed_frame = "map";
  PoseLimits limits;
  limits.max_pose_age = random.uniform(0.0, 3.0);
  limits.clock_tolerance = random.uniform(0.0, 3.0);
  parameters.sources.readSettings({"settings", settingsText(randomSettings(random), limits)});
  for (const CloudConfig& cloud : parameters.sources.config.clouds) {
    parameters.cloud_topics.push_back("/somewhere/" + cloud.topic);
  }
  return parameters;
}

SceneChange randomAddition(RandomInputs& random, const std::string& name) {
  using shape_msgs::SolidPrimitive;
  SceneChange change;
  SceneObject& object = change.object;
  const auto pose = [&](double reach) { return toPose(random.pose(reach)); };
  object.name = name;
  object.pose = pose(1.0);
  object.primitives = {primitive(SolidPrimitive::BOX, {0.2, 0.1, random.uniform(0.1, 0.3)})};
  if (random.integer(0, 1)) object.primitives[0] = primitive(SolidPrimitive::CONE, {0.2, 0.1});
  if (random.integer(0, 2) == 0) {
    object.primitives.push_back(primitive(SolidPrimitive::SPHERE, {0.1}));
    object.primitive_poses = {pose(0.2), pose(0.2)};
  }
  if (random.integer(0, 2) == 0) object.mesh_resources = {"fork"};
  if (random.integer(0, 2) == 0) {
    object.meshes = {messageOf(LShape().mesh())};
    object.mesh_poses = {pose(0.2)};
  }
  if (random.integer(0, 4) == 0) {
    object.planes.resize(1);
    object.planes[0].coef = {0.3, 0.1, 1.0, 1.5};
  }
  if (random.integer(0, 1)) {
    object.attached_link = object.header.frame_id = linkOf(random);
    object.planes.clear();
  }
  if (random.integer(0, 1)) object.touch_links = {linkOf(random), "thing_0"};
  if (random.integer(0, 2) == 0) object.padding = random.uniform(0.0, 0.1);
  return change;
}

/// The names, pairs and pose sources of a scene, and the reports of some postures, all to the last
/// bit.
std::string described(const ActiveScene& active) {
  const CollisionScene& scene = *active.scene;
  std::ostringstream text;
  text << std::hexfloat << "frame " << active.frame << '\n';
  for (const CollisionModel& model : scene.models()) text << model.name << ' ';
  text << '\n';
  for (std::uint32_t a = 0; a < scene.models().size(); ++a) {
    for (std::uint32_t b = 0; b < scene.models().size(); ++b) {
      text << scene.filter().allowed(a, b);
    }
  }
  for (const auto& cloud : active.clouds) text << '\n' << cloud->topic();
  CollisionDetector detector(active.scene);
  CheckSettings settings;
  settings.alarm_distance = 3.0;
  RandomInputs random(7);
  for (int i = 0; i < POSTURES; ++i) {
    std::vector<Eigen::Isometry3d> X_RB;
    scene.robot().forwardKinematics(randomPositions(random, scene.robot()), X_RB);
    BodyPoses poses;
    scene.gatherPoses(X_RB, poses);
    poses.voxels.resize(scene.clouds().size());
    const CollisionReport& report = detector.detect(poses, settings);
    text << "\nverdict " << static_cast<int>(report.verdict);
    for (const PairReport& pair : report.pairs) {
      text << "\n  " << scene.models()[pair.first].name << ' ' << scene.models()[pair.second].name
           << ' ' << pair.distance;
    }
  }
  return text.str();
}

class Scenes {
 public:
  explicit Scenes(const ros::Time& now) : monitor_(TransformSettings()) { monitor_.advance(now); }

  void take(SceneJob job) {
    job.run();
    ASSERT_TRUE(monitor_.scenes().take(job));
  }
  void load(SceneParameters parameters) { take(monitor_.scenes().load(std::move(parameters))); }
  void load(const Scene& message) {
    take(monitor_.scenes().load(parametersOf(message, testMesh, [](const std::string&) {}),
                                objectsOf(message, testMesh)));
  }
  void update(const std::vector<SceneChange>& changes) {
    take(monitor_.scenes().update(changes, readAdded(changes, testMesh)));
  }
  void advance(const ros::Time& now) { monitor_.advance(now); }
  Scene message() const { return toMessage(monitor_.scenes().stored()); }
  std::string described() const {
    return test_scene_message::described(*monitor_.scenes().active());
  }

 private:
  Monitor monitor_;
};

std::string bytesOf(const Scene& message) {
  const ros::SerializedMessage bytes = ros::serialization::serializeMessage(message);
  return {reinterpret_cast<const char*>(bytes.buf.get()), bytes.num_bytes};
}

Scene received(const Scene& message) {
  Scene copy;
  ros::SerializedMessage bytes = ros::serialization::serializeMessage(message);
  bytes.message_start = bytes.buf.get() + 4;  // after the length
  ros::serialization::deserializeMessage(bytes, copy);
  return copy;
}

/// A random scene with a history; false: its parameters contradict its robots.
bool fill(RandomInputs& random, Scenes& scenes) {
  try {
    scenes.load(randomParameters(random));
    std::vector<SceneChange> changes;
    const int count = random.integer(0, 4);
    for (int i = 0; i < count; ++i) {
      changes.push_back(randomAddition(random, "thing_" + std::to_string(i)));
      if (random.integer(0, 1)) scenes.update(std::exchange(changes, {}));
    }
    if (!changes.empty()) scenes.update(changes);
    if (count == 0) return true;
    SceneChange change = randomAddition(random, "thing_0");
    change.operation = random.integer(0, 1) ? SceneChange::MOVE : SceneChange::REMOVE;
    change.object.header.frame_id = scenes.message().objects.front().header.frame_id;
    scenes.update({change});
    return true;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::Not(HasSubstr("revision")));
    return false;
  }
}

TEST(SceneMessage, IsSufficientToBuildTheSameScene) {
  RandomInputs random;
  int nb_filled = 0, nb_objects = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    Scenes original(ros::Time(10, 500)), copy(ros::Time(99));
    if (!fill(random, original)) continue;
    ++nb_filled;
    const Scene message = original.message();
    nb_objects += static_cast<int>(message.objects.size());
    const Scene arrived = received(message);
    EXPECT_EQ(bytesOf(arrived), bytesOf(message));
    copy.load(arrived);
    EXPECT_EQ(copy.described(), original.described());
    Scene again = copy.message();
    again.header.stamp = message.header.stamp;
    again.revision = message.revision;
    EXPECT_EQ(bytesOf(again), bytesOf(message));
    copy.load(received(message));  // over objects that are there
    EXPECT_EQ(copy.described(), original.described());
  }
  EXPECT_GT(nb_filled, 20);
  EXPECT_GT(nb_objects, 20);
}

class TheMessage : public testing::Test {
 protected:
  TheMessage() {
    scenes_.load(parametersOf(slidingBoxes(2)));
    SceneChange change;
    change.object = boxObject("crate", poseAt(0, 2, 0));
    scenes_.update({change});
    change.object = boxObject("tool", poseAt(0, 0, 1));
    change.object.header.frame_id = change.object.attached_link = "a";
    scenes_.update({change});
    message_ = scenes_.message();
  }

  std::string refusalOf(const std::function<void(Scene&)>& spoil) const {
    Scene spoilt = message_;
    spoil(spoilt);
    return refusal([&] {
      Scenes scenes(ros::Time(1));
      scenes.load(spoilt);
    });
  }

  Scenes scenes_{ros::Time(5)};
  Scene message_;
};

TEST_F(TheMessage, CountsTheScenesAndSaysSinceWhenItCounts) {
  EXPECT_EQ(message_.revision, 3u);
  EXPECT_EQ(message_.header.stamp, ros::Time(5));
  EXPECT_EQ(message_.header.frame_id, "root");
  scenes_.advance(ros::Time(8));
  EXPECT_EQ(scenes_.message().header.stamp, ros::Time(5)) << "it has not changed";
  SceneChange clear;
  clear.operation = SceneChange::CLEAR;
  scenes_.update({clear});
  EXPECT_EQ(scenes_.message().header.stamp, ros::Time(8));
  EXPECT_EQ(scenes_.message().revision, 4u);
  scenes_.update({});
  EXPECT_EQ(scenes_.message().revision, 4u) << "nothing has changed";
}

TEST_F(TheMessage, ThatIsWrongIsRefusedWithItsRevisionAndThePart) {
  EXPECT_EQ(refusalOf([](Scene&) {}), "accepted");
  EXPECT_EQ(refusalOf([](Scene& s) { s.header.frame_id.clear(); }),
            "scene of revision 3: header.frame_id is empty");
  EXPECT_EQ(refusalOf([](Scene& s) { s.robots.clear(); }), "scene of revision 3: it has no robot");
  EXPECT_THAT(refusalOf([](Scene& s) { s.robots[0].urdf = "<robot>"; }),
              HasSubstr("scene of revision 3: robots[0]/urdf: "));
  EXPECT_THAT(refusalOf([](Scene& s) { s.robots[0].srdf = s.robots[0].urdf; }),
              HasSubstr("scene of revision 3: robots[0]/srdf: "));
  EXPECT_THAT(refusalOf([](Scene& s) { s.world = "cell"; }),
              HasSubstr("scene of revision 3: world: "));
  EXPECT_THAT(refusalOf([](Scene& s) { s.settings = "pading: 0.1"; }),
              HasSubstr("scene of revision 3: settings: 'pading' is not a setting"));
  EXPECT_THAT(refusalOf([](Scene& s) { s.settings = "[padding: {"; }),
              HasSubstr("scene of revision 3: settings: "));
  EXPECT_EQ(refusalOf([](Scene& s) { s.cloud_topics = {"/camera"}; }),
            "scene of revision 3: cloud_topics has 1 entries, but settings have 0 clouds");
  EXPECT_THAT(refusalOf([](Scene& s) { s.objects[1].pose.orientation.w = 0.0; }),
              HasSubstr("scene of revision 3: object 'tool': its pose is invalid"));
  for (const char* frame : {"", "a", "/root"}) {
    EXPECT_EQ(refusalOf([&](Scene& s) { s.objects[0].header.frame_id = frame; }),
              "scene of revision 3: object 'crate': its pose is in frame '" + std::string(frame) +
                  "', but must be in 'root'");
  }
  EXPECT_THAT(refusalOf([](Scene& s) { s.objects[1].header.frame_id = "root"; }),
              HasSubstr("must be in 'a'"));
  EXPECT_THAT(refusalOf([](Scene& s) { s.objects[1] = s.objects[0]; }),
              HasSubstr("object 'crate': it is listed twice"));
  EXPECT_THAT(refusalOf([](Scene& s) { s.objects[0].name.clear(); }), HasSubstr("it has no name"));
  EXPECT_THAT(refusalOf([](Scene& s) { s.objects[0].mesh_resources = {"file:///none.stl"}; }),
              AllOf(HasSubstr("scene of revision 3: object 'crate'"), HasSubstr("mesh")));
  EXPECT_THAT(
      refusalOf([](Scene& s) { s.objects[1].attached_link = s.objects[1].header.frame_id = "z"; }),
      HasSubstr("'z'"));
}

TEST_F(TheMessage, ReplacesTheObjectsSoThatTheFrameMayChange) {
  Scene other = message_;
  other.header.frame_id = other.objects[0].header.frame_id = "map";
  other.objects.pop_back();
  scenes_.load(other);
  EXPECT_EQ(scenes_.message().header.frame_id, "map");
  EXPECT_EQ(scenes_.message().objects.size(), 1u);
  EXPECT_THAT(refusal([&] { scenes_.load(parametersOf(slidingBoxes(2))); }),
              HasSubstr("object 'crate' is fixed in frame 'map'"))
      << "they are kept";
}

// Each part counts: a scene without it is another one.
TEST_F(TheMessage, WithoutAnyOfItsPartsIsAnotherScene) {
  Scene whole = message_;
  whole.robots[0].srdf =
      "<robot name='r'><disable_collisions link1='a' link2='b' reason='Never'/></robot>";
  whole.world = "<robot name='w'>" + boxLink("cell", 1.0) + "</robot>";
  whole.settings = "padding: 0.01\nclouds: [{topic: camera}]";
  whole.cloud_topics = {"/camera"};
  whole.objects[0].touch_links = {"a"};
  whole.objects[0].padding = 0.1;
  const auto describedAs = [](const Scene& message) {
    Scenes scenes(ros::Time(1));
    scenes.load(message);
    return scenes.described();
  };
  const std::string expected = describedAs(whole);
  EXPECT_EQ(describedAs(received(whole)), expected);
  const std::vector<std::function<void(Scene&)>> edits = {
      [](Scene& s) { s.header.frame_id = s.objects[0].header.frame_id = "map"; },
      [](Scene& s) { s.robots[0].srdf.clear(); },
      [](Scene& s) { s.world.clear(); },
      [](Scene& s) { s.settings = "clouds: [{topic: camera}]"; },
      [](Scene& s) { s.cloud_topics = {"/other/camera"}; },
      [](Scene& s) { s.objects.pop_back(); },
      [](Scene& s) { s.objects[0].name = "cart"; },
      [](Scene& s) { s.objects[0].touch_links.clear(); },
      [](Scene& s) { s.objects[0].padding = 0.0; },
      [](Scene& s) { s.objects[1].pose.position.x += 1e-9; },
      [](Scene& s) { s.objects[1].attached_link = s.objects[1].header.frame_id = "b"; },
      [](Scene& s) { s.objects[1].primitives[0].dimensions[2] *= 0.5; },
      [](Scene& s) {
        s.robots.push_back(s.robots[0]);
        s.robots.back().prefix = "other";
      }};
  for (std::size_t i = 0; i < edits.size(); ++i) {
    Scene edited = whole;
    edits[i](edited);
    EXPECT_NE(describedAs(edited), expected) << "edit " << i;
  }
}

}  // namespace collision_pairs::test_scene_message
