// Everything that a check needs and that does not change from cycle to cycle.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/pair_filter.h"
#include "collision_pairs/robot_model.h"
#include "collision_pairs/scene_settings.h"
#include "collision_pairs/srdf.h"
#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

/// A link with geometry that is in at least one allowed pair.
struct CollisionModel {
  std::string name;
  int body;  ///< index of its pose in the detector's input, -1 if it never moves
  std::uint32_t first_element;
  std::uint32_t nb_elements;
};

struct MeshBounds;

/// The element as one rung of the ladder sees it.
struct Rung {
  std::shared_ptr<const PreparedShape> shape;
  Eigen::Isometry3d X_ER;  ///< pose of that shape in the element's frame; identity but for OBB
  /// Metres by which the shape must be grown to enclose the next rung in exact arithmetic.
  double margin = 0.0;
  /// The shape sticks out of the next by design, so that a cheaper rung may be the better bound.
  bool loose = false;
};

struct SceneElement {
  std::uint32_t model;
  int body;                ///< as in CollisionModel
  Eigen::Isometry3d X_BE;  ///< pose in its body's frame; in W if it never moves
  /// The dearest geometry that its link may be checked with.
  Fidelity dearest = Fidelity::MESH;
  /// By Fidelity; AABB has none of its own. Shared where rungs are the same shape; without one
  /// where no allowed pair asks for it.
  std::array<Rung, 4> rungs;
  const Rung& rung(Fidelity fidelity) const { return rungs[static_cast<int>(fidelity)]; }
  /// Its box in W, where it stands at X_WE. Of a mesh: tight to 1e-4 of the mesh's size, on the
  /// outside, because a few outermost vertices grown by that cost a fifth of all of them.
  Aabb boxAt(const Eigen::Isometry3d& X_WE) const;
  std::shared_ptr<const MeshBounds> mesh_bounds;  ///< null for a primitive
  /// A box along the axes of E that encloses the element, rounding included: its centre and half
  /// its size, in E. Infinite for a half-space.
  Eigen::Vector3d box_center, box_half;
  Shape shape;  ///< the element as it is
};

/// A rigid body of the robot whose pose the detector wants.
struct SceneBody {
  int body;  ///< in RobotModel::bodies()
  std::string link;
};

/// An immutable snapshot, shared by all threads: it is replaced as a whole when something changes.
/// Models are numbered by name, so pairs ordered by id are ordered by name. Elements of models
/// that never move come first.
class CollisionScene {
 public:
  /// `robot` is checked against itself and against `world` (may be null), whose root stands at the
  /// robot's root link, with its joints at zero. Pairs within the world are not checked. With an
  /// SRDF every pair of links of the robot is checked that it does not switch off; without one,
  /// links that hang together are not (RobotModel::adjacentLinks). Throws InputError if a link of
  /// the world has the name of one of the robot, or if the settings name a link that is in neither
  /// (the error says which one is meant, perhaps).
  static std::shared_ptr<const CollisionScene> build(std::shared_ptr<const RobotModel> robot,
                                                     const std::optional<Srdf>& srdf,
                                                     std::shared_ptr<const RobotModel> world,
                                                     const SceneSettings& settings = {});

  /// The robot against the world only, not against itself.
  static std::shared_ptr<const CollisionScene> buildAgainstWorldOnly(
      std::shared_ptr<const RobotModel> robot, std::shared_ptr<const RobotModel> world,
      const SceneSettings& settings = {});

  const RobotModel& robot() const { return *robot_; }
  const std::vector<CollisionModel>& models() const { return models_; }
  const std::vector<SceneElement>& elements() const { return elements_; }
  const std::vector<SceneBody>& bodies() const { return bodies_; }
  const PairFilter& filter() const { return filter_; }
  const StaticBoxes& staticBoxes() const { return static_boxes_; }
  std::uint32_t nbStaticElements() const {
    return static_cast<std::uint32_t>(static_boxes_.size());
  }
  /// From the poses of all bodies in the root link's frame, as forwardKinematics() gives them, to
  /// those of bodies(), all known. W is the root link's frame.
  void gatherPoses(const std::vector<Eigen::Isometry3d>& X_RB, BodyPoses& poses) const;

  /// Id of the model, or -1.
  int findModel(const std::string& name) const;

 private:
  friend class SceneBuilder;
  CollisionScene() = default;

  std::shared_ptr<const RobotModel> robot_;
  std::vector<CollisionModel> models_;
  std::vector<SceneElement> elements_;
  std::vector<SceneBody> bodies_;
  PairFilter filter_;
  StaticBoxes static_boxes_;
};

}  // namespace collision_pairs
