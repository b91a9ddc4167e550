// Scenes for MoveIt's questions, with detectors for all threads; what MoveIt calls bodies, and
// which pairs of them may touch. Without types of MoveIt.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/collision_scene.h"
#include "moveit_octree.h"

namespace collision_pairs {

/// A body of a robot; objects of the world, which do not move, are known by their names.
struct MoveitBody {
  std::string name;  ///< MoveIt's
  /// Index of the link itself or, of an attached body, of the one that it is attached to.
  int link = -1;
  bool is_attached = false;
  std::set<std::string> touch_links;  ///< names of links that an attached body may touch
};

/// As in an entry of MoveIt's allowed collision matrix; NEVER also if it has none.
enum class AllowedContact { NEVER, ALWAYS, CONDITIONAL };

/// Whether `one` is an attached body that may touch the other whatever the matrix says: a touch
/// link, or another body attached to the same link. The link that carries it is no touch link
/// unless it is named. Null: an object.
inline bool mayAlwaysTouch(const MoveitBody* one, const MoveitBody* other) {
  if (!one || !other || !one->is_attached) return false;
  return other->is_attached ? one->link == other->link : one->touch_links.count(other->name) > 0;
}

/// MoveIt's rule for a pair. `entry()` returns that of the matrix; it is called once, and only if
/// the bodies alone do not decide.
template <class Entry>
AllowedContact allowedContact(const MoveitBody* a, const MoveitBody* b, const Entry& entry) {
  return mayAlwaysTouch(a, b) || mayAlwaysTouch(b, a) ? AllowedContact::ALWAYS : entry();
}

/// Where the straight motion of a continuous joint from `from` to `to` ends, as MoveIt's
/// RevoluteJointModel::interpolate() has it; rad. Beyond half a turn one turn is taken off: the
/// shorter way, but where the two are more than one and a half turns apart.
inline double endOfTurn(double from, double to) {
  constexpr double PI = 3.14159265358979323846;
  if (std::abs(to - from) <= PI) return to;
  return to > from ? to - 2.0 * PI : to + 2.0 * PI;
}

/// Where the straight motion of a joint that mimics another ends: MoveIt interpolates the other,
/// which ends at `leader` (as endOfTurn() has it), and then sets this one; rad or metres. Nothing
/// if that is not the position `to`, or for a joint that turns one that differs by whole turns: it
/// is elsewhere in that state, or jumps where MoveIt's interpolation passes pi.
inline std::optional<double> endOfMimic(double leader, double factor, double offset, double to,
                                        bool turns) {
  constexpr double TURN = 2.0 * 3.14159265358979323846;
  constexpr double SAME = 1e-9;
  const double end = factor * leader + offset;
  const double apart = turns ? std::remainder(end - to, TURN) : end - to;
  if (std::abs(apart) <= SAME) return end;  // false for NaN
  return std::nullopt;
}

/// A body of a robot whose pose is an input: each link of MoveIt by itself, because it may place
/// also those apart that fixed joints connect, and each attached body.
struct MovingBody {
  MoveitBody body;
  std::vector<Element> elements;  ///< with X_LE the pose in the frame of the link or attached body
  double padding = 0.0;           ///< metres, >= 0: a distance kept in every direction
};

/// A scene, and what MoveIt calls its models. Immutable but for the store of detectors, each of
/// which serves one thread at a time. W is MoveIt's world frame.
///
/// Each octree of a world has a scene of its own beside the other objects: the moving bodies, and a
/// cloud for each level of leaves, in the octree's frame O. Its leaves are not in it; each check
/// reads those that it needs, so that no change of them goes unnoticed or takes time.
class MoveitScene {
 public:
  using Ptr = std::shared_ptr<const MoveitScene>;

  /// The moving bodies against each other.
  static Ptr ofSelf(const std::vector<MovingBody>& moving, SceneCache& cache);
  /// The moving bodies against objects, which are static, and octrees. Cost: a build, and one for
  /// each octree.
  static Ptr ofWorld(const std::vector<MovingBody>& moving, std::vector<RigidObject> objects,
                     const std::vector<MoveitOctree>& octrees, SceneCache& cache);
  /// Only for a scene of a world. `octrees`: all. Throws InputError; cost: as
  /// CollisionScene::with(), and a build for an octree unless another has its resolution.
  Ptr with(const SceneChanges& changes, const std::vector<MoveitOctree>& octrees,
           SceneCache& cache) const;

  /// This scene of links, with attached bodies: `moving` has its links, then those. Null: they are
  /// too many, or there are no links; it takes a build. Throws InputError; cost: as
  /// CollisionScene::with().
  Ptr withAttached(const std::vector<MovingBody>& moving, SceneCache& cache) const;

  const CollisionScene& scene() const { return *scene_; }
  /// Those of a world's octrees.
  const std::vector<Ptr>& octrees() const { return octrees_; }
  /// False if the resolution of an octree has changed: it takes another scene.
  bool areResolutionsKept() const;
  /// False if nothing can collide: there are no objects (octrees aside), or there is no moving
  /// body.
  bool hasPairs() const;
  /// Of the world.
  bool hasObject(const std::string& name) const;
  static bool isOfWorld(const RigidObject& object);
  /// By index in scene().bodies().
  const MoveitBody& moving(std::size_t body) const { return (*moving_)[body]; }
  /// Null for a static object, whose model has its name.
  const MoveitBody* movingOf(const CollisionModel& model) const {
    return model.body < 0 ? nullptr : &(*moving_)[static_cast<std::size_t>(model.body)];
  }
  /// MoveIt's name of the model.
  const std::string& nameOf(const CollisionModel& model) const {
    const MoveitBody* moving = movingOf(model);
    return moving ? moving->name : octree_ ? octree_->object : model.name;
  }
  /// False for pairs that no check may mention: with the placeholder, and of two bodies of the
  /// robot in the scene of a world.
  bool isAsked(const CollisionModel& a, const CollisionModel& b) const;
  /// A static object that keeps the class of static objects alive, so
  /// that the first one comes, and the last one goes, without a build.
  static bool isPlaceholder(const std::string& object);
  /// Selects at least all pairs with a body of an active link (indexed by MoveIt's links), and
  /// more if names of links look like patterns; null: all. Made once for each set of links.
  std::shared_ptr<const PairSelection> selectionOf(const std::vector<char>& is_active) const;

  /// Null unless this is the scene of an octree. Poses and reports of its checks are in O.
  const MoveitOctree* octree() const { return octree_ ? &*octree_ : nullptr; }
  /// Whether checks have to give it the voxels of leavesWithin().
  bool readsLeaves() const { return octree_ && !is_of_boxes_; }
  /// The same with these leaves as boxes, each of which has contacts of its own. Cost: about 2 µs a
  /// leaf.
  Ptr ofBoxes(const std::vector<OctreeLeaf>& leaves) const;
  /// From W to O, without voxels.
  void toOctree(BodyPoses& poses_W) const;
  void toWorld(Contact& contact_O) const;
  double resolution() const { return resolution_; }  ///< as octomap has it, metres

  struct Worker {
    explicit Worker(std::shared_ptr<const CollisionScene> scene) : detector(std::move(scene)) {}
    CollisionDetector detector;
    BodyPoses poses;
    std::uint64_t revision = 1;  ///< of the pairs that the last checks left out
  };
  /// Serves one thread for as long as it lives; the scene must outlive it.
  using Lease = std::unique_ptr<Worker, std::function<void(Worker*)>>;
  Lease lease() const;
  /// The leaves that are now no further than `reach` metres from a body that the selection (null:
  /// all) uses, and few others. Overwrites the voxels of `worker`.
  std::vector<OctreeLeaf> leavesWithin(double reach, std::shared_ptr<const PairSelection> selection,
                                       Worker& worker) const;

 private:
  MoveitScene(std::shared_ptr<const CollisionScene> scene, std::size_t nb_objects, bool is_world)
      : scene_(std::move(scene)), nb_objects_(nb_objects), is_world_(is_world) {}
  /// Those of `wanted`; what is alike among `before` is shared.
  void setOctrees(const std::vector<MoveitOctree>& wanted, const std::vector<Ptr>& before,
                  SceneCache& cache);
  std::shared_ptr<const CollisionScene> sceneOfLeaves(double resolution, SceneCache& cache) const;
  const RigidObject* findObject(const std::string& name) const;
  void refuseTakenName(const std::string& name) const;
  void setMoving(const std::vector<MovingBody>& moving);

  std::shared_ptr<const CollisionScene> scene_;
  std::shared_ptr<const std::vector<MoveitBody>> moving_;
  const std::size_t nb_objects_;
  const bool is_world_;
  std::vector<Ptr> octrees_;
  std::optional<MoveitOctree> octree_;
  bool is_of_boxes_ = false;
  double resolution_ = 0.0;
  Eigen::Isometry3d X_WO_ = Eigen::Isometry3d::Identity();  // octree_'s, its rotation repaired

  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Worker>> idle_;
  mutable std::vector<std::pair<std::vector<char>, std::shared_ptr<const PairSelection>>>
      selections_;
};

}  // namespace collision_pairs
