#include "scene_sources.h"

#include <set>
#include <stdexcept>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/mesh_loader.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

std::shared_ptr<const RobotModel> loadGeometry(RobotSource& source, const std::string& prefix,
                                               const std::set<std::string>& needed) {
  return source.withGeometryOf(
      [&](const std::string& link) { return needed.count(withPrefix(prefix, link)) > 0; });
}

Srdf parsed(const TextFrom& xml, const RobotModel& robot, const Warn& warn) {
  Srdf srdf = naming(xml.origin, [&] { return Srdf::fromXml(xml.content); });
  for (const std::string& warning : srdf.warnings) warn(xml.origin + ": " + warning);
  if (!srdf.robot.empty() && srdf.robot != robot.name()) {
    warn(xml.origin + ": it is of robot '" + srdf.robot + "', but the URDF is of robot '" +
         robot.name() + "'");
  }
  return srdf;
}

}  // namespace

std::shared_ptr<const RobotModel> robotFrom(const TextFrom& urdf, const Warn& warn) {
  const auto robot = naming(urdf.origin, [&] {
    return RobotModel::fromUrdf(urdf.content, relativeTo(urdf.folder, makeMeshLoader(warn)));
  });
  for (const std::string& warning : robot->warnings()) warn(urdf.origin + ": " + warning);
  return robot;
}

Srdf srdfFrom(const TextFrom& xml, const RobotModel& robot, const Warn& warn) {
  Srdf srdf = parsed(xml, robot, warn);
  const auto unknown = srdf.unknownLinks(namesOf(robot.links()));
  if (!unknown.empty()) warn(xml.origin + ": not links of the robot, ignored: " + joined(unknown));
  return srdf;
}

RobotSource::RobotSource(const std::string& urdf, MeshLoader load_mesh)
    : urdf_(urdf), load_mesh_(std::move(load_mesh)) {
  skeleton_ =
      RobotModel::fromUrdf(urdf, [this](const std::string& uri, const Eigen::Vector3d& scale) {
        auto stand_in = std::make_shared<TriangleMesh>();
        stand_in->name = uri;
        stand_in->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        stand_in->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
        references_[stand_in.get()] = {uri, scale};
        return stand_in;
      });
  loaded_ = skeleton_->withElements([](const Link&) { return std::vector<Element>(); });
  has_geometry_.resize(skeleton_->links().size(), 0);
}

const std::shared_ptr<const RobotModel>& RobotSource::withGeometryOf(
    const std::function<bool(const std::string&)>& wanted) {
  std::vector<char> now = has_geometry_;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (wanted(skeleton_->links()[i].name)) now[i] = 1;
  }
  if (now == has_geometry_) return loaded_;
  std::size_t i = 0;
  std::vector<std::string> missing;
  const auto elementsOf = [&](const Link& link) {
    const bool is_new = now[i] && !has_geometry_[i];
    const Link& described = skeleton_->links()[i++];
    missing = link.missing;
    return is_new ? load(described, missing) : link.elements;
  };
  loaded_ = loaded_->withElements(elementsOf, [&](const Link&) { return missing; });
  has_geometry_ = now;
  return loaded_;
}

std::vector<Element> RobotSource::load(const Link& link, std::vector<std::string>& missing) {
  std::vector<Element> elements;
  for (const Element& element : link.elements) {
    const auto* mesh = std::get_if<Mesh>(&element.shape);
    if (!mesh) {
      elements.push_back(element);
      continue;
    }
    const Reference& reference = references_.at(mesh->mesh.get());
    try {
      const Shape shape = Mesh{load_mesh_(reference.uri, reference.scale)};
      validateShape(shape);
      elements.push_back({shape, element.X_LE});
    } catch (const std::exception& error) {
      missing.push_back(error.what());
    }
  }
  return elements;
}

std::unique_ptr<RobotSource> robotSource(const TextFrom& urdf, const MeshLoader& load_mesh,
                                         const Warn& warn) {
  auto source = naming(urdf.origin, [&] {
    return std::make_unique<RobotSource>(urdf.content, relativeTo(urdf.folder, load_mesh));
  });
  for (const std::string& what : source->skeleton()->warnings()) warn(urdf.origin + ": " + what);
  return source;
}

void SceneSources::Robot::readSrdf(const TextFrom& xml, const Warn& warn) {
  srdf = parsed(xml, *source->skeleton(), warn);
  srdf_text = xml.content;
}

void SceneSources::readSettings(const TextFrom& yaml) {
  config = readSceneSettings(yaml);
  settings_text = yaml.content;
  setClouds(config.clouds);
}

void SceneSources::setClouds(std::vector<CloudConfig> configs) {
  config.clouds = std::move(configs);
  clouds.clear();
  for (const CloudConfig& cloud : config.clouds) clouds.push_back(obstacleOf(cloud));
}

SceneDescription describeScene(SceneSources& sources, std::vector<RigidObject> objects,
                               const Restriction& restriction) {
  SceneDescription description;
  for (const SceneSources::Robot& robot : sources.robots) {
    description.robots.push_back({robot.source->skeleton(), robot.srdf, robot.prefix});
  }
  if (sources.world) description.world = sources.world->skeleton();
  description.objects = std::move(objects);
  if (sources.config.floor) description.objects.push_back(*sources.config.floor);
  description.clouds = sources.clouds;
  description.restriction = restriction.empty() ? sources.config.restriction : restriction;
  description.settings = sources.config.settings;

  const std::set<std::string> needed = CollisionScene::neededModels(description);
  for (std::size_t i = 0; i < sources.robots.size(); ++i) {
    const SceneSources::Robot& robot = sources.robots[i];
    description.robots[i].model = loadGeometry(*robot.source, robot.prefix, needed);
  }
  if (sources.world) description.world = loadGeometry(*sources.world, "", needed);
  return description;
}

}  // namespace collision_pairs
