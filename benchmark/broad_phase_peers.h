// The broad phases that are compared, behind one interface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "broad_phase_scenes.h"

namespace collision_pairs {

/// One broad phase over one scene. A cycle takes the boxes of a frame, does all that its method
/// has to do to know all pairs, and has them written down somewhere. Setting up for a scene
/// (objects made and registered, static boxes prepared) is the constructor's and is not timed.
class BroadPhasePeer {
 public:
  virtual ~BroadPhasePeer() = default;
  /// Returns the number of pairs, without those of two static boxes.
  virtual std::size_t cycle(const std::vector<Aabb>& boxes) = 0;
};

/// SweepAndPrune, PlainDirectSap, FclDynamicAabbTree, FclSaP, Cgal, BulletDbvt, BruteForce.
const std::vector<std::string>& peerNames();

/// The largest scene that a peer can be asked to do in reasonable time.
std::size_t largestScene(const std::string& peer, const std::string& scene);

std::unique_ptr<BroadPhasePeer> makePeer(const std::string& name, const MovingScene& scene);

}  // namespace collision_pairs
