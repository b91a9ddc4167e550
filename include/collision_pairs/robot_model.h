// The parts of a URDF that a collision check needs: links with their collision elements, the joints
// between them, and forward kinematics.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// Loads the mesh with the URI of a URDF. `scale` is applied to the vertices, per axis, and may
/// mirror. Throws InputError.
using MeshLoader = std::function<std::shared_ptr<const TriangleMesh>(const std::string& uri,
                                                                     const Eigen::Vector3d& scale)>;

/// The name of a link, joint or frame of one of several robots, as with tf_prefix: "left" and
/// "elbow" give "left/elbow". Without a prefix the name is unchanged.
std::string withPrefix(const std::string& prefix, const std::string& name);

/// One <collision> of a link.
struct Element {
  Shape shape;
  Eigen::Isometry3d X_LE;  ///< pose of the shape's frame E in the link frame L
};

struct Link {
  std::string name;
  int parent_joint = -1;  ///< -1 for the root
  std::vector<Element> elements;
  bool has_geometry = false;  ///< has a <collision>, even if it could not be used
  /// Why a <collision> is not among the elements, for each; see CollisionScene::missing().
  std::vector<std::string> missing;
  int body = -1;           ///< the rigid body it belongs to
  Eigen::Isometry3d X_BL;  ///< pose of the link in that body's frame
};

enum class JointType { FIXED, REVOLUTE, CONTINUOUS, PRISMATIC, FLOATING, PLANAR };

struct Joint {
  struct Mimic {
    int joint;
    double multiplier;
    double offset;
  };
  std::string name;
  JointType type = JointType::FIXED;
  int parent_link = -1;
  int child_link = -1;
  Eigen::Isometry3d X_PJ = Eigen::Isometry3d::Identity();  ///< joint frame in the parent link
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();         ///< unit, in the joint frame
  double lower = 0.0;                                      ///< rad or m; both 0: no limits
  double upper = 0.0;
  std::optional<Mimic> mimic;
  /// It mimics a joint that does not exist or has no position: see RobotModel::unnamedPositions().
  bool leader_missing = false;

  /// True if it moves with one number, as in a joint state.
  bool hasPosition() const {
    return type == JointType::REVOLUTE || type == JointType::CONTINUOUS ||
           type == JointType::PRISMATIC;
  }
  bool hasAxis() const { return hasPosition() || type == JointType::PLANAR; }
  bool hasLimits() const { return type == JointType::REVOLUTE || type == JointType::PRISMATIC; }

  /// Pose of the child link in the joint frame at `position` (rad or m). Identity for joints
  /// without a position.
  Eigen::Isometry3d motion(double position) const;
};

/// A <collision> of the URDF that could not be used.
struct BrokenElement {
  std::string link;
  std::string reason;
};

/// A rigid body: links connected by fixed joints. Its frame is that of its first link, the one
/// whose parent joint moves (or the root).
struct Body {
  int link = -1;
  int joint = -1;   ///< the moving joint above it, -1 for the root's body
  int parent = -1;  ///< the body above that joint, -1 for the root's body
  /// Pose of that joint's frame in the parent body's frame; for a root's body, in W.
  Eigen::Isometry3d X_PJ = Eigen::Isometry3d::Identity();
};

/// Immutable. Links, joints and bodies are numbered from the root outwards: a parent always comes
/// before its children.
class RobotModel {
 public:
  /// Reads a URDF. Only links, joints and <collision> are used. What is misspelt is refused, see
  /// docs/conventions.md; other content cannot make it fail.
  /// Throws InputError with the line of the XML.
  ///
  /// A <collision> whose mesh cannot be loaded throws as well, unless `broken` is given: then the
  /// element is left out, its link and the reason are added to `broken`, and the reason to
  /// Link::missing. No check in which the link is in a pair is FREE.
  static std::shared_ptr<const RobotModel> fromUrdf(const std::string& xml,
                                                    const MeshLoader& load_mesh,
                                                    std::vector<BrokenElement>* broken = nullptr);

  /// Makes a model of links and joints, in any order; joints refer to both by their indices in
  /// these vectors. They are renumbered: the joints below a link keep their order. Axes may have
  /// any length. Of a link, name, elements, has_geometry and missing are read; the rest is found
  /// out here. A link on a floating or planar joint, and what is fixed to it, is a body of its own,
  /// whose pose is an input of the detector. Throws InputError that names the link or joint that is
  /// wrong: also several roots, which are several robots of a scene.
  static std::shared_ptr<const RobotModel> fromParts(std::string name, std::vector<Link> links,
                                                     std::vector<Joint> joints,
                                                     std::vector<std::string> warnings = {});

  /// A copy in which each link has the elements that `elements` returns, and what `missing` returns
  /// after that (by default what it had); each is called once per link.
  std::shared_ptr<const RobotModel> withElements(
      const std::function<std::vector<Element>(const Link&)>& elements,
      const std::function<std::vector<std::string>(const Link&)>& missing = nullptr) const;

  /// One of several robots.
  struct Placed {
    std::shared_ptr<const RobotModel> model;
    std::string prefix;  ///< of the names of its links and joints, see withPrefix()
    /// Pose of its root in W, which forwardKinematics() applies.
    Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
  };
  /// Merges several robots into one model with several roots, for functions that take one robot.
  /// Throws InputError if two links or joints then have the same name, or an X_WR is not a pose.
  static std::shared_ptr<const RobotModel> merge(const std::vector<Placed>& robots);

  const std::string& name() const { return name_; }
  /// Content of the URDF that has no effect and was ignored; one sentence each, for its author.
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<Link>& links() const { return links_; }
  const std::vector<Joint>& joints() const { return joints_; }
  const std::vector<Body>& bodies() const { return bodies_; }

  /// Index of the link or joint of this name, or -1.
  int findLink(const std::string& name) const;
  int findJoint(const std::string& name) const;

  /// Pairs (first < second) of links with geometry of which one is attached to the other, directly
  /// or only through links without geometry.
  std::vector<std::pair<int, int>> adjacentLinks() const;

  /// Calls visit(body, is_above_first) for the bodies from either of the two up to the last that
  /// carries both, which it returns; -1, W, carries all.
  template <class Visit>
  int visitBetween(int first, int second, const Visit& visit) const {
    while (first != second) {  // a parent comes before its children
      int& later = first > second ? first : second;
      visit(later, &later == &first);
      later = bodies_[later].parent;
    }
    return first;
  }

  /// Every joint at zero, or at the limit nearest to zero if zero is out of bounds; mimic joints
  /// follow. One entry per joint, rad or m (joints without a position: 0).
  std::vector<double> zeroPositions() const;
  /// What joints that a state does not name are taken for: zeroPositions(), but not a number where
  /// the leader of a mimic joint is missing. What such a joint moves is unknown and never FREE.
  std::vector<double> unnamedPositions() const;

  /// Throws InputError unless there is one entry per joint, fixed joints included; so do all
  /// functions that take positions.
  void requireOneEntryPerJoint(const std::vector<double>& positions) const {
    if (positions.size() != joints_.size()) refuse(positions.size());
  }

  /// Overwrites the positions of all mimic joints by those that their leaders imply.
  void applyMimics(std::vector<double>& positions) const;

  /// Pose of each body in the frame of the root link (of several robots: in W), for `positions`
  /// (one entry per joint, rad or m, mimics applied). Floating and planar joints are at identity.
  /// O(bodies): a sine, a cosine and 45 products each. No allocation once X_RB has its size.
  void forwardKinematics(const std::vector<double>& positions,
                         std::vector<Eigen::Isometry3d>& X_RB) const;

  /// The same where some bodies are `placed` (by body; empty: none), whatever their joints say: a
  /// root in W, others in their parent bodies.
  void forwardKinematics(const std::vector<double>& positions,
                         const std::vector<std::optional<Eigen::Isometry3d>>& placed,
                         std::vector<Eigen::Isometry3d>& X_WB) const;

  /// The same for one body: from the pose of its parent body and its joint's position.
  void placeBody(int body, const Eigen::Isometry3d& X_RP, double position,
                 Eigen::Isometry3d& X_RB) const;

 private:
  RobotModel() = default;
  [[noreturn]] void refuse(std::size_t nb_positions) const;
  void append(const Placed& robot);
  void indexNames();
  void groupIntoBodies();
  void foldJoints();

  /// A body's pose in its parent's frame as a function of its joint's position q, with all
  /// constants multiplied out: R_PB(q) = R + cos(q) R_cos + sin(q) R_sin (Rodrigues' formula after
  /// the fixed rotation of the joint's frame), p_PB(q) = p + q p_slope.
  struct BodyMotion {
    bool turns = false;  ///< otherwise the rotation is R
    Eigen::Matrix3d R, R_cos, R_sin;
    Eigen::Vector3d p, p_slope;
  };

  std::string name_;
  std::vector<std::string> warnings_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::vector<Body> bodies_;
  std::vector<BodyMotion> motions_;  // one per body
  std::unordered_map<std::string, int> link_ids_;
  std::unordered_map<std::string, int> joint_ids_;
};

}  // namespace collision_pairs
