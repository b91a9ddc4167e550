#include "broad_phase_peers.h"

#include <functional>
#include <map>
#include <stdexcept>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <CGAL/box_intersection_d.h>
#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include "collision_pairs/sweep_and_prune.h"
#include "column_sweep.h"
#include "packed_brute_force.h"
#include "plain_direct_sap.h"

namespace collision_pairs {
namespace {

using Boxes = std::vector<Aabb>;

class SweepAndPrunePeer : public BroadPhasePeer {
 public:
  explicit SweepAndPrunePeer(const MovingScene& scene) : fixed_(makeStatic(scene)) {}
  std::size_t cycle(const Boxes& boxes) override {
    sweep_.begin(0.0, &fixed_);
    for (std::size_t i = fixed_.size(); i < boxes.size(); ++i) {
      sweep_.add(boxes[i], static_cast<std::uint32_t>(i));
    }
    return sweep_.end().size();
  }

 private:
  static StaticBoxes makeStatic(const MovingScene& scene) {
    std::vector<std::uint32_t> models;
    for (std::uint32_t i = 0; i < scene.nb_static; ++i) models.push_back(i);
    const auto first = scene.frames[0].begin();
    return {Boxes(first, first + static_cast<std::ptrdiff_t>(scene.nb_static)), models};
  }
  SweepAndPrune sweep_;
  StaticBoxes fixed_;
};

// Knows no static boxes: it finds their pairs too, as the original does.
class PlainDirectSapPeer : public BroadPhasePeer {
 public:
  explicit PlainDirectSapPeer(const MovingScene& scene) : nb_static_(scene.nb_static) {}
  std::size_t cycle(const Boxes& boxes) override {
    sap_.begin(0.0);
    for (const Aabb& box : boxes) sap_.add(box);
    std::size_t count = 0;
    for (const BoxPair& pair : sap_.end()) count += pair.second >= nb_static_;
    return count;
  }

 private:
  std::size_t nb_static_;
  PlainDirectSap sap_;
};

class BruteForcePeer : public BroadPhasePeer {
 public:
  explicit BruteForcePeer(const MovingScene& scene) : nb_static_(scene.nb_static) {}
  std::size_t cycle(const Boxes& boxes) override {
    return brute_force_.pairs(boxes, nb_static_).size();
  }

 private:
  std::size_t nb_static_;
  PackedBruteForce brute_force_;
};

// One manager for what moves and one for what does not: FCL's own way to leave out static pairs.
template <class Manager>
class FclPeer : public BroadPhasePeer {
 public:
  explicit FclPeer(const MovingScene& scene) : nb_static_(scene.nb_static) {
    const Boxes& boxes = scene.frames[0];
    std::vector<fcl::CollisionObjectd*> fixed, moving;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Eigen::Vector3d size = boxes[i].max - boxes[i].min;
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(
          std::make_shared<fcl::Boxd>(size), Eigen::Matrix3d::Identity(), boxes[i].center()));
      objects_.back()->setUserData(reinterpret_cast<void*>(i));
      (i < nb_static_ ? fixed : moving).push_back(objects_.back().get());
    }
    fixed_.registerObjects(fixed);
    moving_.registerObjects(moving);
    fixed_.setup();
    moving_.setup();
  }
  std::size_t cycle(const Boxes& boxes) override {
    for (std::size_t i = nb_static_; i < boxes.size(); ++i) {
      objects_[i]->setTranslation(boxes[i].center());
      objects_[i]->computeAABB();
    }
    moving_.update();
    pairs_.clear();
    moving_.collide(&pairs_, &FclPeer::keep);
    if (nb_static_ > 0) moving_.collide(&fixed_, &pairs_, &FclPeer::keep);
    return pairs_.size();
  }

 private:
  static bool keep(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* pairs) {
    // Not every manager looks at all three axes before it calls.
    if (!a->getAABB().overlap(b->getAABB())) return false;
    const auto i = static_cast<std::uint32_t>(reinterpret_cast<std::size_t>(a->getUserData()));
    const auto j = static_cast<std::uint32_t>(reinterpret_cast<std::size_t>(b->getUserData()));
    static_cast<std::vector<BoxPair>*>(pairs)->push_back({i, j});
    return false;
  }
  std::size_t nb_static_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  Manager fixed_, moving_;
  std::vector<BoxPair> pairs_;
};

class CgalPeer : public BroadPhasePeer {
 public:
  explicit CgalPeer(const MovingScene& scene) : nb_static_(scene.nb_static) {
    for (std::size_t i = 0; i < nb_static_; ++i) fixed_.push_back(make(scene.frames[0], i));
  }
  std::size_t cycle(const Boxes& boxes) override {
    moving_.clear();
    for (std::size_t i = nb_static_; i < boxes.size(); ++i) moving_.push_back(make(boxes, i));
    pairs_.clear();
    const auto keep = [&](const Box& a, const Box& b) {
      pairs_.push_back({static_cast<std::uint32_t>(a.id()), static_cast<std::uint32_t>(b.id())});
    };
    CGAL::box_self_intersection_d(moving_.begin(), moving_.end(), keep);
    if (nb_static_ > 0) {
      CGAL::box_intersection_d(moving_.begin(), moving_.end(), fixed_.begin(), fixed_.end(), keep);
    }
    return pairs_.size();
  }

 private:
  struct Box {
    typedef double NT;
    typedef std::size_t ID;
    double lo[3], hi[3];
    std::size_t index;
    static int dimension() { return 3; }
    std::size_t id() const { return index; }
    double min_coord(int k) const { return lo[k]; }
    double max_coord(int k) const { return hi[k]; }
  };
  static Box make(const Boxes& boxes, std::size_t i) {
    const Aabb& b = boxes[i];
    return {{b.min[0], b.min[1], b.min[2]}, {b.max[0], b.max[1], b.max[2]}, i};
  }
  std::size_t nb_static_;
  std::vector<Box> fixed_, moving_;
  std::vector<BoxPair> pairs_;
};

class BulletPeer : public BroadPhasePeer {
 public:
  explicit BulletPeer(const MovingScene& scene) : nb_static_(scene.nb_static) {
    const Boxes& boxes = scene.frames[0];
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const int group = i < nb_static_ ? 1 : 2;
      const int mask = i < nb_static_ ? 2 : 3;
      proxies_.push_back(dbvt_.createProxy(vector(boxes[i].min), vector(boxes[i].max), 0, nullptr,
                                           group, mask, nullptr));
    }
  }
  ~BulletPeer() override {
    for (btBroadphaseProxy* proxy : proxies_) dbvt_.destroyProxy(proxy, nullptr);
  }
  std::size_t cycle(const Boxes& boxes) override {
    for (std::size_t i = nb_static_; i < boxes.size(); ++i) {
      dbvt_.setAabb(proxies_[i], vector(boxes[i].min), vector(boxes[i].max), nullptr);
    }
    dbvt_.calculateOverlappingPairs(nullptr);
    return static_cast<std::size_t>(dbvt_.getOverlappingPairCache()->getNumOverlappingPairs());
  }

 private:
  static btVector3 vector(const Eigen::Vector3d& v) {
    return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
  }
  std::size_t nb_static_;
  btDbvtBroadphase dbvt_;
  std::vector<btBroadphaseProxy*> proxies_;
};

struct PeerEntry {
  std::size_t largest;
  std::function<std::unique_ptr<BroadPhasePeer>(const MovingScene&)> make;
};

template <class Peer>
std::unique_ptr<BroadPhasePeer> makeOf(const MovingScene& scene) {
  return std::make_unique<Peer>(scene);
}

const std::map<std::string, PeerEntry>& peers() {
  using Tree = fcl::DynamicAABBTreeCollisionManagerd;
  using SaP = fcl::SaPCollisionManagerd;
  static const std::map<std::string, PeerEntry> PEERS = {
      {"SweepAndPrune", {1000000, makeOf<SweepAndPrunePeer>}},
      {"PlainDirectSap", {100000, makeOf<PlainDirectSapPeer>}},
      {"FclDynamicAabbTree", {1000000, makeOf<FclPeer<Tree>>}},
      {"FclSaP", {10000, makeOf<FclPeer<SaP>>}},
      {"Cgal", {1000000, makeOf<CgalPeer>}},
      {"BulletDbvt", {1000000, makeOf<BulletPeer>}},
      {"BruteForce", {10000, makeOf<BruteForcePeer>}},
  };
  return PEERS;
}

}  // namespace

const std::vector<std::string>& peerNames() {
  static const std::vector<std::string> NAMES = [] {
    std::vector<std::string> names;
    for (const auto& entry : peers()) names.push_back(entry.first);
    return names;
  }();
  return NAMES;
}

std::size_t largestScene(const std::string& peer, const std::string& scene) {
  // Where the method degenerates to looking at every pair, a cycle takes minutes beyond this.
  const bool along_rods =
      peer == "PlainDirectSap" || peer == "FclDynamicAabbTree" || peer == "BulletDbvt";
  if (scene == "rods" && along_rods) return 10000;
  if (scene == "line" && peer == "Cgal") return 100000;
  return peers().at(peer).largest;
}

std::unique_ptr<BroadPhasePeer> makePeer(const std::string& name, const MovingScene& scene) {
  return peers().at(name).make(scene);
}

}  // namespace collision_pairs
