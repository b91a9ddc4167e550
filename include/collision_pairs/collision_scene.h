// Everything that a check needs and that does not change from cycle to cycle.
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
};

struct MeshBounds;
class FineBalls;

/// The element as one rung of the ladder sees it.
struct Rung {
  std::shared_ptr<const PreparedShape> shape;
  Eigen::Isometry3d X_ER;  ///< pose of that shape in the element's frame; identity but for OBB
  /// Metres by which the shape must be grown to enclose the next rung in exact arithmetic.
  double margin = 0.0;
  /// The shape sticks out of the next by design, so that a coarser rung may be the better bound.
  bool loose = false;
};

struct SceneElement {
  std::uint32_t model;
  int body;                ///< as in CollisionModel
  Eigen::Isometry3d X_BE;  ///< pose in its body's frame; in W if it never moves
  /// The finest geometry that its link may be checked with.
  Fidelity finest = Fidelity::MESH;
  /// By Fidelity; AABB and SPHERES have none of their own. Shared where rungs are the same shape;
  /// without one where no allowed pair asks for it.
  std::array<Rung, 5> rungs;
  const Rung& rung(Fidelity fidelity) const { return rungs[static_cast<int>(fidelity)]; }
  /// Metres that it keeps to everything; and the same, or half of the most that one of its pairs
  /// wants instead, by which its box grows.
  double padding = 0.0, box_padding = 0.0;
  /// Its box in W, where it stands at X_WE, grown by box_padding. Of a mesh: tight to 1e-4 of the
  /// mesh's size, on the outside, because a few outermost vertices grown by that cost a fifth of
  /// all of them.
  Aabb boxAt(const Eigen::Isometry3d& X_WE) const;
  std::shared_ptr<const MeshBounds> mesh_bounds;  ///< null for a primitive
  /// What it is at SPHERES; made when it is first asked for. Null for a primitive.
  std::shared_ptr<const FineBalls> balls;
  /// A box along the axes of E that encloses the element, rounding included: its centre and half
  /// its size, in E. Infinite for a half-space.
  Eigen::Vector3d box_center, box_half;
  Shape shape;  ///< the element as it is
};

/// A cloud of points: a model whose one element, a cube, is at every voxel that a check is given.
struct SceneCloud {
  std::uint32_t model;
  std::uint32_t element;
  double voxel_size;  ///< metres
};

/// A rigid body of a robot whose pose the detector wants.
struct SceneBody {
  int body;  ///< in RobotModel::bodies()
  std::string link;
};

class ElementMaker;
class SelfFilter;

/// What was prepared for one scene, so that the next one, which differs in a few objects, need not
/// prepare it again; what the last sixteen did not ask for is forgotten. For one thread at a time.
class SceneCache {
 public:
  SceneCache();
  ~SceneCache();

 private:
  friend class SceneBuilder;
  friend class SelfFilter;
  std::unique_ptr<ElementMaker> maker_;
};

/// An immutable snapshot, shared by all threads: it is replaced as a whole when something changes.
/// Models are numbered by name, so pairs ordered by id are ordered by name. Elements of models
/// that never move come first, those of clouds (clouds()) last.
class CollisionScene {
 public:
  /// Robots are checked against themselves, each other, the world and the objects; pairs that stand
  /// still are not. Throws InputError if two have the same name, or if anything in the description
  /// names a link that is nowhere (the error says which one is meant, perhaps).
  /// Cost: meshes that `cache` does not have are prepared, which takes most of it; then about
  /// 2 µs an element.
  static std::shared_ptr<const CollisionScene> build(const SceneDescription& description,
                                                     SceneCache* cache = nullptr);

  /// The names of the models that such a scene has. Looks at no mesh, so that a caller can learn
  /// which links' meshes are worth loading: elements of the others need not be there.
  static std::set<std::string> neededModels(const SceneDescription& description);

  /// One robot, checked against itself and against `world` (may be null), whose root stands at the
  /// robot's root link.
  static std::shared_ptr<const CollisionScene> build(std::shared_ptr<const RobotModel> robot,
                                                     const std::optional<Srdf>& srdf,
                                                     std::shared_ptr<const RobotModel> world,
                                                     const SceneSettings& settings = {});

  /// The robot, or several in one.
  const RobotModel& robot() const { return *robot_; }
  const std::vector<CollisionModel>& models() const { return models_; }
  const std::vector<SceneElement>& elements() const { return elements_; }
  const std::vector<SceneBody>& bodies() const { return bodies_; }
  /// Those that are in some allowed pair, by name.
  const std::vector<SceneCloud>& clouds() const { return clouds_; }
  /// Index of the cloud that has this element, or -1.
  int cloudOf(std::uint32_t element) const {
    const std::size_t first = elements_.size() - clouds_.size();
    return element < first ? -1 : static_cast<int>(element - first);
  }
  const PairFilter& filter() const { return filter_; }
  /// Who answers its pairs of shapes.
  NarrowPhaseMethod narrowPhase() const { return narrow_phase_; }
  /// Metres that two elements keep apart.
  double padding(std::uint32_t element_a, std::uint32_t element_b) const {
    const SceneElement &a = elements_[element_a], &b = elements_[element_b];
    return pair_padding_.empty() ? a.padding + b.padding : paddingOfPair(a, b);
  }
  const StaticBoxes& staticBoxes() const { return static_boxes_; }
  std::uint32_t nbStaticElements() const {
    return static_cast<std::uint32_t>(static_boxes_.size());
  }
  /// Where the voxel of the cloud with this element is; the centre of the cell, in W.
  Eigen::Isometry3d poseOfVoxel(std::uint32_t element, const Eigen::Vector3i& cell) const;
  /// Where the elements that move end, and those of clouds begin.
  std::uint32_t endOfMovingElements() const {
    return static_cast<std::uint32_t>(elements_.size() - clouds_.size());
  }
  /// From the poses of all bodies in the root link's frame, as forwardKinematics() gives them, to
  /// those of bodies(), all known. W is the root link's frame.
  void gatherPoses(const std::vector<Eigen::Isometry3d>& X_RB, BodyPoses& poses) const;

  /// Which of its model's elements it is.
  std::uint32_t indexInModel(std::uint32_t element) const {
    return element - models_[elements_[element].model].first_element;
  }

  /// Id of the model, or -1.
  int findModel(const std::string& name) const;

 private:
  friend class SceneBuilder;
  CollisionScene() = default;

  double paddingOfPair(const SceneElement& a, const SceneElement& b) const;

  std::shared_ptr<const RobotModel> robot_;
  std::vector<CollisionModel> models_;
  std::vector<SceneElement> elements_;
  std::vector<SceneBody> bodies_;
  std::vector<SceneCloud> clouds_;
  PairFilter filter_;
  NarrowPhaseMethod narrow_phase_ = NarrowPhaseMethod::NATIVE;
  /// By classes of the filter, the smaller first: where it is not the sum of the two.
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> pair_padding_;
  StaticBoxes static_boxes_;
};

/// Why a model is not checked where it stands, for messages: its name, and that its box is not
/// finite.
std::string whyNoBox(const std::string& name);

}  // namespace collision_pairs
