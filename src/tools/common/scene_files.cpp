#include "scene_files.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"
#include "collision_pairs/voxel_grid.h"
#include "csv.h"
#include "joint_limits.h"
#include "pcd_file.h"
#include "scene_sources.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

/// The configurations of the chosen topics: from the settings, or else the default.
std::vector<CloudConfig> cloudsOf(const SceneOptions& options,
                                  const std::vector<CloudConfig>& in_settings, const Warn& tell) {
  std::vector<CloudConfig> clouds;
  for (const std::string& topic : options.cloud_topics) {
    CloudConfig cloud;
    cloud.topic = topic;
    if (findCloud(clouds, cloud.name())) {
      throw InputError("--clouds: topic '" + topic + "' is listed twice");
    }
    if (const CloudConfig* found = findCloud(in_settings, cloud.name())) {
      cloud = *found;
    } else if (!in_settings.empty()) {
      tell(options.settings + ": no entry of clouds has topic '" + topic + "': using the defaults");
    }
    clouds.push_back(std::move(cloud));
  }
  return clouds;
}

bool isRestricted(const SceneOptions& options) {
  return !options.group.empty() || !options.links.empty();
}

// A check of a whole robot reports missing meshes even if no pair needs them, but for links that
// are to be ignored.
void readAllMeshes(SceneSources& sources) {
  const auto& ignored = sources.config.settings.ignored_links;
  for (const SceneSources::Robot& robot : sources.robots) {
    robot.source->withGeometryOf([&](const std::string& link) {
      const std::string name = withPrefix(robot.prefix, link);
      return std::none_of(ignored.begin(), ignored.end(),
                          [&](const NamePattern& pattern) { return matches(pattern, name); });
    });
  }
  if (sources.world) sources.world->withGeometryOf([](const std::string&) { return true; });
}

SceneSources readSources(const TextFrom& urdf, const TextFrom& srdf, const SceneOptions& options,
                         const Warn& tell) {
  SceneSources sources;
  const MeshLoader load_mesh = makeMeshLoader(tell);
  sources.robots.emplace_back();
  SceneSources::Robot& robot = sources.robots.back();
  robot.source = robotSource(urdf, load_mesh, tell);
  if (!srdf.origin.empty()) robot.srdf = srdfFrom(srdf, *robot.source->skeleton(), tell);
  if (!options.world.empty()) {
    sources.world = robotSource(textFromFile(options.world), load_mesh, tell);
  }
  if (!options.settings.empty()) {
    sources.config = readSceneConfigFile(options.settings);
  }
  std::vector<CloudConfig> clouds = cloudsOf(options, sources.config.clouds, tell);
  const std::string ignored = warningOfIgnored(sources.config, clouds, sources.world != nullptr);
  if (!ignored.empty()) tell(options.settings + ": " + ignored);
  sources.setClouds(std::move(clouds));
  if (!options.cloud.empty()) sources.clouds.push_back(cloudOf("cloud", options.voxel_size, {}));
  apply(options, sources);
  return sources;
}

/// From a file, or else the bag's only one; empty if there is neither.
TextFrom chooseText(const std::string& path, const std::map<std::string, std::string>& in_bag,
                    const std::set<std::string>& changing, const std::string& option) {
  if (!path.empty()) return textFromFile(path);
  if (in_bag.empty()) return {};
  if (in_bag.size() > 1) {
    throw InputError("several robots in it (" + in_bag.begin()->first + ", " +
                     std::next(in_bag.begin())->first + "); choose one with " + option);
  }
  const auto& [topic, text] = *in_bag.begin();
  if (changing.count(topic) > 0) {
    throw InputError("the text on " + topic + " changes within it; give " + option +
                     ", or split the bag");
  }
  return {"topic " + topic, text};
}

/// The rest of the sentence that CollisionScene::unchecked() begins.
std::string saysNothing(const CollisionScene& scene) {
  return scene.mayBeFree()
             ? ": what is free is so because allow_empty_scene permits it"
             : ": nothing is free; if that is meant, permit it by allow_empty_scene: true in "
               "--settings";
}

}  // namespace

void apply(const SceneOptions& options, SceneSources& sources) {
  SceneSettings& settings = sources.config.settings;
  settings.fidelity = Fidelity::MESH;
  if (!options.narrow_phase.empty()) settings.narrow_phase = parseNarrowPhase(options.narrow_phase);
  if (options.max_hull_vertices != 0) settings.max_hull_vertices = options.max_hull_vertices;
  if (isRestricted(options)) sources.config.restriction = {options.group, options.links};
  // Points of links that are in no pair are not obstacles either.
  if (!isRestricted(options) || !sources.clouds.empty()) readAllMeshes(sources);
}

std::shared_ptr<const RobotModel> readRobot(const std::string& path) {
  return robotFrom(textFromFile(path), warn);
}

void declareScene(CommandLine& command_line, SceneOptions& options) {
  command_line.input("world", options.world, "WORLD.urdf",
                     "URDF of static obstacles; its root coincides with the robot's root");
  command_line.input(
      "settings", options.settings, "SETTINGS.yaml",
      "scene settings (rules, paddings, ...), in the format of the node's parameter file");
  command_line.option("narrow-phase", options.narrow_phase, "NAME",
                      "method for pairs of shapes: native (default) or fcl");
  command_line.option("group", options.group, "GROUP",
                      "only pairs with a link that this group moves");
  command_line.option("links", options.links, "LINK...",
                      "only pairs with one of these links, names or patterns");
}

void declareFidelity(CommandLine& command_line, SceneOptions& options) {
  command_line.option("fidelity", options.fidelity, "NAME", "aabb, spheres, obb, convex or mesh");
}

void declareBroadPhase(CommandLine& command_line, SceneOptions& options) {
  command_line.option("broad-phase", options.broad_phase, "NAME",
                      "auto: few boxes each against each, many by direct sweep and "
                      "prune; sweep: always that");
}

void declareRobot(CommandLine& command_line, SceneOptions& options) {
  command_line.operand(options.urdf, "ROBOT.urdf", "the robot's URDF");
  command_line.input("srdf", options.srdf, "ROBOT.srdf", "pairs that it disables are not checked");
  declareScene(command_line, options);
  command_line.input("cloud", options.cloud, "CLOUD.pcd",
                     "points in the frame of the robot's root link, without points of the robot "
                     "itself; one obstacle of voxels, named 'cloud'");
  command_line.option("voxel-size", options.voxel_size, "METRES",
                      "edge length of a voxel; required by --cloud");
  command_line.together("cloud", "voxel-size");
  declareFidelity(command_line, options);
}

std::string listedPair(const CollisionScene& scene, std::uint32_t first, std::uint32_t second) {
  return listedName(scene.models()[first].name) + '|' + listedName(scene.models()[second].name);
}

CloudVoxels readCloud(const SceneOptions& options, const CollisionScene& scene) {
  if (options.cloud.empty() || scene.clouds().empty()) return {};
  std::vector<Eigen::Vector3d> points;
  try {
    points = readPcd(readBinaryFile(options.cloud));
  } catch (const InputError& error) {
    const std::string what = error.what();
    const bool names_file = what.compare(0, options.cloud.size(), options.cloud) == 0;
    throw InputError(names_file ? what : options.cloud + ": " + what);
  }
  VoxelSettings settings;
  settings.voxel_size = options.voxel_size;
  settings.max_voxels = std::numeric_limits<std::uint32_t>::max();
  VoxelGrid grid(settings);
  grid.begin(0.0, Eigen::Vector3d::Zero());
  for (const Eigen::Vector3d& point : points) grid.add(point);
  CloudVoxels voxels = {grid.end()};
  const PointCounts& counts = grid.counts();
  if (counts.out_of_range > 0) {
    throw InputError(options.cloud + ": " + std::to_string(counts.out_of_range) +
                     " points are more than 2^20 voxels of " + std::to_string(options.voxel_size) +
                     " m from the robot's root; increase --voxel-size or remove them");
  }
  if (counts.not_finite == points.size()) {
    throw InputError(options.cloud +
                     ": it has no finite point: a camera that sees nothing is "
                     "probably broken");
  }
  if (counts.not_finite > 0) {
    warn(options.cloud + ": " + std::to_string(counts.not_finite) + " of " +
         std::to_string(points.size()) + " points are not finite and were ignored");
  }
  return voxels;
}

void requireWhole(const SceneDescription& scene, const std::string& urdf,
                  const std::string& world) {
  const auto require = [](const RobotModel& model, const std::string& origin) {
    for (const Link& link : model.links()) {
      if (link.missing.empty()) continue;
      throw InputError(origin + ": URDF: link '" + link.name + "': " + link.missing.front());
    }
  };
  for (const SceneRobot& robot : scene.robots) require(*robot.model, urdf);
  if (scene.world) require(*scene.world, world);
}

void reviewScene(const CollisionScene& scene, const SceneOptions& options, const Warn& tell) {
  const std::string& unchecked = scene.unchecked();
  if (isRestricted(options) && scene.models().empty() && !scene.mayBeFree()) {
    throw InputError("--group and --links leave no pair to check");
  }
  if (!unchecked.empty()) tell(unchecked + saysNothing(scene));
  const std::vector<std::string> open_meshes = scene.openMeshes();
  if (!open_meshes.empty()) tell(joined(open_meshes, "; "));
}

std::shared_ptr<const CollisionScene> buildScene(const SceneOptions& options, Fidelity fidelity) {
  const TextFrom srdf = options.srdf.empty() ? TextFrom() : textFromFile(options.srdf);
  SceneSources sources = readSources(textFromFile(options.urdf), srdf, options, warn);
  sources.config.settings.fidelity = fidelity;
  const SceneDescription description = describeScene(sources, {}, {});
  requireWhole(description, options.urdf, options.world);
  const auto scene = CollisionScene::build(description);
  reviewScene(*scene, options, warn);
  return scene;
}

void warnOf(const JointStates& states, const RobotModel& robot, const std::string& what) {
  if (!states.joints_at_zero.empty()) {
    warn("joints without a column are taken as zero, and a state is free only with them at zero: " +
         joined(states.joints_at_zero));
  }
  for (const std::string& sentence : outsideLimits(states.positions, robot, what)) warn(sentence);
}

void declareThreads(CommandLine& command_line, unsigned& threads) {
  command_line.option("threads", threads, "COUNT", "0: one per core; does not affect the output");
}

void declareBatch(CommandLine& command_line, unsigned& threads, std::string& out) {
  declareThreads(command_line, threads);
  command_line.output("out", out, "OUT.csv", "output file (default: standard output)");
}

BagRobot robotOf(const BagIndex& bag, const SceneOptions& options) {
  BagRobot robot{chooseText(options.urdf, bag.urdfs, bag.changing, "--urdf"), {}};
  if (robot.urdf.origin.empty()) {
    throw InputError("there is no robot_description in it; give --urdf");
  }
  const std::string urdf = options.urdf.empty() ? bag.urdfs.begin()->first : options.urdf;
  std::map<std::string, std::string> srdfs;
  for (const auto& [topic, text] : bag.srdfs) {
    const bool is_beside = options.urdf.empty() && !isOutsideNamespaceOf(urdf, topic);
    if (is_beside || !options.srdf.empty()) {
      srdfs.emplace(topic, text);
    } else {
      warn("topic " + topic + " is not used: it may be of another robot than " + urdf +
           "; --srdf gives one");
    }
  }
  robot.srdf = chooseText(options.srdf, srdfs, bag.changing, "--srdf");
  return robot;
}

SceneSources sourcesOf(const BagRobot& robot, const SceneOptions& options, const Warn& tell) {
  return readSources(robot.urdf, robot.srdf, options, tell);
}

}  // namespace collision_pairs
