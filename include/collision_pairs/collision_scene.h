// Everything a check needs that does not change between cycles.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/narrow_phase.h"
#include "collision_pairs/pair_filter.h"
#include "collision_pairs/robot_model.h"
#include "collision_pairs/scene_description.h"
#include "collision_pairs/srdf.h"
#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

/// A link with geometry, or an object, that is in at least one allowed pair.
struct CollisionModel {
  std::string name;
  int body;  ///< index of its pose in the detector's input, -1 if it never moves
  std::uint32_t first_element;
  std::uint32_t nb_elements;
  bool is_object = false;  ///< not a link
  /// The link of robot() that an object is attached to; -1: none.
  int attached_link = -1;
};

struct MeshBounds;
class FineSpheres;

/// The geometry of an element on one rung of the ladder of fidelities.
struct Rung {
  std::shared_ptr<const PreparedShape> shape;
  Eigen::Isometry3d X_ER;  ///< pose of the shape in the element's frame; identity except for OBB
  /// Metres by which the shape must be enlarged to enclose the next rung in exact arithmetic.
  double margin = 0.0;
  /// The shape may extend beyond the coarser rung, whose bound can then be the better one.
  bool loose = false;
};

struct SceneElement {
  std::uint32_t model;
  int body;                ///< as in CollisionModel
  Eigen::Isometry3d X_BE;  ///< pose in its body's frame; in W if it never moves
  /// The finest geometry that its link is checked with.
  Fidelity finest = Fidelity::MESH;
  /// Indexed by Fidelity; AABB and SPHERES have no entry. Shapes are shared between rungs where
  /// they are the same, and null where no allowed pair needs them. Shared between scenes.
  std::shared_ptr<const std::array<Rung, 5>> rungs;
  const Rung& rung(Fidelity fidelity) const { return (*rungs)[static_cast<int>(fidelity)]; }
  /// Metres that it keeps to everything else; and the amount by which its box is enlarged: the
  /// same, or half of the largest padding of any of its pairs.
  double padding = 0.0, box_padding = 0.0;
  /// Its box in W for the pose X_WE, enlarged by box_padding. For a mesh it encloses the tight box
  /// and exceeds it by up to 1e-4 of the mesh's size, because it uses only a few outermost
  /// vertices, which costs a fifth of using all.
  Aabb boxAt(const Eigen::Isometry3d& X_WE) const;
  std::shared_ptr<const MeshBounds> mesh_bounds;  ///< null for a primitive
  /// The geometry at SPHERES, made when it is first requested. Null for a primitive.
  std::shared_ptr<const FineSpheres> spheres;
  /// A box along the axes of E that encloses the element, including rounding: centre and half size,
  /// metres, in E. Infinite for a half-space.
  Eigen::Vector3d box_center, box_half;
  Shape shape;  ///< the original shape
};

/// A point cloud: a model with one element, a cube, which is placed at every voxel of a check.
struct SceneCloud {
  std::uint32_t model;
  std::uint32_t element;
  double voxel_size;  ///< metres
};

/// A rigid body of a robot whose pose is an input of the detector.
struct SceneBody {
  int body;  ///< in RobotModel::bodies()
  std::string link;
};

class ElementMaker;
class SelfFilter;
struct SceneClasses;

/// Changes of the objects of a scene.
struct SceneChanges {
  /// Added, or put in place of the object with the same name: moved, attached, detached.
  std::vector<RigidObject> objects;
  std::vector<std::string> removed;  ///< names of objects; comes before `objects`
};

/// Keeps prepared meshes for later scenes. Meshes are known by their content (name, vertices and
/// triangles), whoever loaded them, and each is prepared once. What no scene holds any more, and
/// the last sixteen scenes did not use, is dropped. One may serve all threads.
class SceneCache {
 public:
  SceneCache();
  ~SceneCache();

 private:
  friend class SceneBuilder;
  friend class SceneEditor;
  friend class SelfFilter;
  std::unique_ptr<ElementMaker> maker_;
};

/// An immutable snapshot, shared by all threads; a change replaces it as a whole. Models are
/// numbered in the order of their names, so pairs sorted by id are sorted by name. Elements of
/// static models come first, those of clouds (clouds()) last.
class CollisionScene {
 public:
  /// Robots are checked against themselves, each other, the world and the objects; static pairs are
  /// not checked. Throws InputError if two models have the same name, or if the description names a
  /// link that does not exist (the error suggests the closest name).
  /// Cost: mostly the preparation of meshes that are not in `cache`; then about 2 µs per element.
  static std::shared_ptr<const CollisionScene> build(SceneDescription description,
                                                     SceneCache* cache = nullptr);

  /// The names of the models that the scene of this description has. Does not use the meshes, so a
  /// caller can find out which links' meshes to load: elements of other links may be missing.
  static std::set<std::string> neededModels(const SceneDescription& description);

  /// One robot, checked against itself and against `world` (may be null), whose root is placed at
  /// the robot's root link. Throws as above.
  static std::shared_ptr<const CollisionScene> build(std::shared_ptr<const RobotModel> robot,
                                                     const std::optional<Srdf>& srdf,
                                                     std::shared_ptr<const RobotModel> world,
                                                     const SceneSettings& settings = {});

  /// The scene that build() makes of the description with these changes, to the last bit; shares
  /// with this one what has not changed. Throws InputError as build() does, if an object that is to
  /// be removed does not exist, and if a link comes into its first pair whose geometry was left out
  /// (neededModels()). Cost: as withAlike() if that can do it, otherwise as build().
  std::shared_ptr<const CollisionScene> with(const SceneChanges& changes,
                                             SceneCache* cache = nullptr) const;
  /// The same without a build, or null if it needs one. It needs none if the rules treat each
  /// static object that changes like one that stays, no name in the description refers to an
  /// attached object that changes, and all other members need the same geometry as before. Cost:
  /// meshes that are not in `cache`; about 5 µs per change, 10 µs if one is or was attached, and
  /// 0.05 µs per static element of the scene. A build takes 3 to 29 times as long.
  std::shared_ptr<const CollisionScene> withAlike(const SceneChanges& changes,
                                                  SceneCache* cache = nullptr) const;

  /// What it was built from, without objects() and SceneSettings::progress.
  const SceneDescription& description() const { return *description_; }
  /// All objects of the description, clouds excepted, sorted by name.
  const std::vector<std::shared_ptr<const RigidObject>>& objects() const { return objects_; }
  /// The robot; several robots are merged into one model.
  const RobotModel& robot() const { return *robot_; }
  const std::vector<CollisionModel>& models() const { return models_; }
  const std::vector<SceneElement>& elements() const { return elements_; }
  const std::vector<SceneBody>& bodies() const { return bodies_; }
  /// Index in RobotModel::bodies() of the body that a model is on; -1: static.
  int robotBody(const CollisionModel& model) const {
    return model.body < 0 ? -1 : bodies_[static_cast<std::size_t>(model.body)].body;
  }
  /// Those that are in at least one allowed pair, sorted by name.
  const std::vector<SceneCloud>& clouds() const { return clouds_; }
  /// Index in clouds() of the cloud with this element, or -1.
  int cloudOf(std::uint32_t element) const {
    const std::size_t first = elements_.size() - clouds_.size();
    return element < first ? -1 : static_cast<int>(element - first);
  }
  const PairFilter& filter() const { return filter_; }
  /// Reason why no check of this scene is conclusive: there is no pair to check, or a robot or the
  /// environment has no collision geometry. Empty if checks are.
  const std::string& unchecked() const { return unchecked_; }
  /// Links in a pair of which a <collision> is not checked, with the reasons: Link::missing, none
  /// if it has no element at all in spite of has_geometry. No check of the scene is FREE.
  const std::map<std::string, std::vector<std::string>>& missing() const { return missing_; }
  /// A warning for each mesh with open sheets of which more than 1 % of the surface is missing,
  /// with the models that have it: open sheets enclose nothing, so a body wholly inside is not
  /// found. Only meshes whose triangles the scene's fidelities need.
  std::vector<std::string> openMeshes() const;
  /// Whether a check can end FREE: no geometry is missing(), and something is checked, or
  /// settings.allow_empty_scene.
  bool mayBeFree() const { return mayBeFree(unchecked_); }
  /// The same for one check, whose CollisionReport::unchecked it is.
  bool mayBeFree(const std::string& unchecked) const {
    return missing_.empty() && (unchecked.empty() || description_->settings.allow_empty_scene);
  }
  /// The library that answers its pairs of shapes.
  NarrowPhaseMethod narrowPhase() const { return narrow_phase_; }
  /// Metres that the two elements keep apart: the sum of their paddings, or that of the pair.
  double padding(std::uint32_t element_a, std::uint32_t element_b) const {
    const SceneElement &a = elements_[element_a], &b = elements_[element_b];
    return pair_padding_.empty() ? a.padding + b.padding : paddingOfPair(a, b);
  }
  const StaticBoxes& staticBoxes() const { return static_boxes_; }
  std::uint32_t nbStaticElements() const {
    return static_cast<std::uint32_t>(static_boxes_.size());
  }
  /// Pose in W of a voxel of the cloud with this element: the centre of the cell, not rotated.
  Eigen::Isometry3d poseOfVoxel(std::uint32_t element, const Eigen::Vector3i& cell) const;
  /// Number of elements without those of clouds, which come last.
  std::uint32_t endOfMovingElements() const {
    return static_cast<std::uint32_t>(elements_.size() - clouds_.size());
  }
  /// Converts the poses in W of all bodies of robot(), as its forwardKinematics() returns them,
  /// into poses of bodies(), all known. W: the root link's frame, or that of SceneRobot::X_WR.
  void gatherPoses(const std::vector<Eigen::Isometry3d>& X_RB, BodyPoses& poses) const;

  /// Index of the element within its model.
  std::uint32_t indexInModel(std::uint32_t element) const {
    return element - models_[elements_[element].model].first_element;
  }

  /// Id of the model, or -1.
  int findModel(const std::string& name) const;
  /// The carrier of a link that joints with positions move: the first body that they move, from the
  /// root or from a floating or planar joint on, by index in RobotModel::bodies(). -1 for objects
  /// (attached ones, too), for links that no such joint moves (a table in the URDF), and for links
  /// on a body in `placed` (by body: its pose comes from a transform) or above which there is one.
  /// Joint positions alone place two links with the same carrier relative to each other, which is
  /// more accurate than anything else that is known of a pair. Two arms on one base have different
  /// carriers: where they stand was measured.
  int carrierOf(std::uint32_t model,
                const std::vector<std::optional<Eigen::Isometry3d>>& placed = {}) const;

 private:
  friend class SceneBuilder;
  friend class SceneEditor;
  CollisionScene() = default;

  /// The description without objects, which are sorted by name. `before`: null, or a scene of the
  /// same robots.
  static std::shared_ptr<const CollisionScene> buildOf(
      const std::shared_ptr<const SceneDescription>& description,
      std::vector<std::shared_ptr<const RigidObject>> objects, SceneCache* cache,
      const CollisionScene* before);

  double paddingOfPair(const SceneElement& a, const SceneElement& b) const;

  std::shared_ptr<const SceneDescription> description_;
  std::vector<std::shared_ptr<const RigidObject>> objects_;
  std::shared_ptr<const SceneClasses> classes_;
  std::shared_ptr<const RobotModel> robot_;
  std::vector<CollisionModel> models_;
  std::vector<SceneElement> elements_;
  std::vector<SceneBody> bodies_;
  std::vector<SceneCloud> clouds_;
  PairFilter filter_;
  std::string unchecked_;
  std::map<std::string, std::vector<std::string>> missing_;
  NarrowPhaseMethod narrow_phase_ = NarrowPhaseMethod::NATIVE;
  /// By classes of the filter, the smaller first: paddings that are not the sum of the two.
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> pair_padding_;
  StaticBoxes static_boxes_;
};

/// Message text for a model that is not checked because its box is not finite.
std::string whyNoBox(const std::string& name);

}  // namespace collision_pairs
