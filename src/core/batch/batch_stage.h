// Settles many joint states at once, before the exact check sees them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "batch_model.h"
#include "pair_table.h"
#include "static_field.h"

namespace collision_pairs {

/// Spheres instead of links: where all pairs of outer spheres are apart, the state is free; where
/// two inner ones overlap, it is in contact; anything else is left open. Both answers are those of
/// the exact check at Fidelity::MESH for certain, float kinematics included (docs/batch.md). For
/// Fidelity::SPHERES, whose spheres are those of this stage divided further, no tables of pairs are
/// used, which know more than these.
/// Immutable but for what the static field fills in; all threads share it.
class BatchStage {
 public:
  /// Null where BatchModel::whyNot() has a reason, or too much is static. The scene must outlive
  /// it.
  static std::unique_ptr<const BatchStage> make(const CollisionScene& scene,
                                                Fidelity fidelity = Fidelity::MESH,
                                                const BatchKernel& kernel = batchKernels().front());

  /// What a thread needs of its own.
  class Group;

  const BatchModel& model() const { return model_; }
  Fidelity fidelity() const { return fidelity_; }
  std::size_t memory() const;  ///< bytes

 private:
  struct BesideStatic {
    int tree;
    int field;
    double outer_padding, inner_padding;  ///< the most and the least of its pairs
  };
  BatchStage(const CollisionScene& scene, Fidelity fidelity, const BatchKernel& kernel);
  bool addFields();
  Aabb reachOfRobot() const;

  const CollisionScene& scene_;
  const Fidelity fidelity_;
  BatchModel model_;
  const BatchKernel kernel_;
  std::vector<BesideStatic> beside_static_;
  std::vector<std::unique_ptr<StaticField>> fields_;  // one for each set of static elements
};

/// Several states, one a lane. Learns: tables of pairs (PairTable) are filled in by what is asked,
/// so keep it for the next batch.
class BatchStage::Group {
 public:
  explicit Group(const BatchStage& stage);
  int lanes() const { return stage_.kernel_.lanes; }

  /// Begins a group of states.
  void clear();
  /// One entry a joint of the robot, mimics applied. False: the state is not for this stage, and is
  /// left open.
  bool set(int lane, const std::vector<double>& positions);
  /// Answers those that were set.
  void settle();

  enum class Outcome { OPEN, FREE, CONTACT };
  Outcome outcome(int lane) const { return outcomes_[lane]; }
  bool isSet(int lane) const { return set_ >> lane & 1u; }
  /// CONTACT: of these elements.
  BoxPair contact(int lane) const { return contacts_[lane]; }
  /// OPEN after settle(), for a state that was set: the pairs of elements that move that are open,
  /// and the elements that may be in contact with something static. Nothing else is.
  void openPairs(int lane, std::vector<BoxPair>& pairs) const;
  void openBesideStatic(int lane, std::vector<std::uint32_t>& elements) const;

 private:
  struct OpenTree {
    int tree;
    unsigned lanes;
  };
  BatchLanes arrays();
  static unsigned lookUp(void* group, int pair, unsigned lanes, unsigned* certain);
  const float* centersOf(int sphere);
  BoxPair elementsOf(int pair) const;
  void addTable(const BatchPair& pair);
  // Of these lanes, those in contact for certain; what is open is noted.
  unsigned settlePairs(unsigned lanes);
  unsigned settleStatic(unsigned lanes);
  unsigned openBesideStatic(const BesideStatic& beside, unsigned lanes);
  unsigned contactWithStatic(const BesideStatic& beside, unsigned lanes);

  const BatchStage& stage_;
  BatchTables tables_;
  std::vector<double> positions_;
  std::vector<float> floats_;  // poses, then centres; aligned
  std::vector<unsigned> placed_;
  unsigned group_ = 0, set_ = 0;
  std::vector<std::unique_ptr<PairTable>> pair_tables_;  // by pair; null: it has none
  std::vector<std::array<int, 2>> table_columns_;        // of the joints of the table
  NarrowPhase narrow_phase_;
  std::vector<OpenBatchPair> open_;
  std::vector<OpenTree> open_static_;
  int nb_open_ = 0;
  Outcome outcomes_[MOST_BATCH_LANES];
  BoxPair contacts_[MOST_BATCH_LANES];
};

}  // namespace collision_pairs
