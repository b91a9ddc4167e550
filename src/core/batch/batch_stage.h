// Settles many joint states at once, before the exact check.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "batch_model.h"
#include "pair_table.h"
#include "solid_pairs.h"
#include "static_field.h"

namespace collision_pairs {

/// Spheres in place of links: if all pairs of outer spheres are apart, the state is free; if two
/// inner ones overlap, it is in contact; anything else is left open. Both answers are certain to be
/// those of the exact check at Fidelity::MESH, float kinematics included (docs/many_states.md). At
/// Fidelity::SPHERES, whose spheres are those of this stage divided further, no lookup tables are
/// used, since they would settle states that these spheres do not; a static element's box still
/// may. Immutable except for cells that the static field fills in; shared by all threads.
class BatchStage {
 public:
  /// Null if BatchModel::whyNot() has a reason, or there are too many static elements or sets of
  /// them. The scene must outlive it.
  static std::unique_ptr<const BatchStage> make(const CollisionScene& scene,
                                                Fidelity fidelity = Fidelity::MESH,
                                                const BatchKernel& kernel = batchKernels().front());

  /// The data of one thread.
  class Group;
  /// The same for straight motions: edge_group.h.
  class EdgeGroup;

  const BatchModel& model() const { return model_; }
  Fidelity fidelity() const { return fidelity_; }
  const SolidPairs& solids() const { return solids_; }
  std::size_t memory() const;  ///< bytes

 private:
  struct BesideStatic {
    int tree;
    int field;
    double outer_padding, inner_padding;  ///< largest and smallest of its pairs
  };
  BatchStage(const CollisionScene& scene, Fidelity fidelity, const BatchKernel& kernel);
  bool addFields();
  Aabb reachOfRobot() const;

  const CollisionScene& scene_;
  const Fidelity fidelity_;
  BatchModel model_;
  SolidPairs solids_;
  const BatchKernel kernel_;
  std::vector<BesideStatic> beside_static_;
  std::vector<std::unique_ptr<StaticField>> fields_;  // one per set of static elements
};

/// Several states, one per lane. Keep it for the next batch: lookup tables (PairTable) are filled
/// in as states arrive.
class BatchStage::Group {
 public:
  explicit Group(const BatchStage& stage);
  virtual ~Group() = default;
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;
  int lanes() const { return stage_.kernel_.lanes; }

  /// Begins a group of states.
  void clear();
  /// One entry per joint of the robot, mimic joints applied. False: this stage cannot process the
  /// state, which is left open.
  bool set(int lane, const std::vector<double>& positions);
  /// Settles the states that were set.
  void settle();

  enum class Outcome { OPEN, FREE, CONTACT };
  Outcome outcome(int lane) const { return outcomes_[lane]; }
  bool isSet(int lane) const { return set_ >> lane & 1u; }
  /// For CONTACT: the elements in contact.
  BoxPair contact(int lane) const { return contacts_[lane]; }
  /// For OPEN, for a state that was set: the open pairs of moving elements, and the moving elements
  /// that may be in contact with static ones. Everything else is apart.
  void openPairs(int lane, std::vector<BoxPair>& pairs) const;
  void openBesideStatic(int lane, std::vector<std::uint32_t>& elements) const;

 protected:
  struct OpenTree {
    int tree;
    unsigned lanes;
  };
  /// BatchLanes::look_up.
  virtual unsigned lookUp(int pair, unsigned lanes, unsigned* certain);

  BoxPair elementsOf(int pair) const;

  const BatchStage& stage_;
  /// A contact in one lane ends settle(): the outcomes of the others are then unknown.
  bool one_contact_will_do_ = false;
  BatchTables tables_;
  std::vector<BatchPair> pairs_;             // the model's, with this group's outer paddings
  std::vector<BesideStatic> beside_static_;  // the stage's, likewise
  std::vector<double> positions_;
  unsigned set_ = 0;
  std::vector<std::unique_ptr<PairTable>> pair_tables_;  // by pair; null: no table
  std::vector<std::array<int, 2>> table_columns_;        // of the joints of the table
  NarrowPhase narrow_phase_;
  std::vector<OpenBatchPair> open_;
  std::vector<OpenTree> open_static_;
  int nb_open_ = 0;
  Outcome outcomes_[MOST_BATCH_LANES];
  BoxPair contacts_[MOST_BATCH_LANES];

 private:
  BatchLanes arrays();
  const float* centersOf(int sphere);
  void addTable(const BatchPair& pair);
  // Return those of `lanes` that are certainly in contact; open pairs are recorded.
  unsigned settlePairs(unsigned lanes);
  unsigned settleStatic(unsigned lanes);
  unsigned openBesideStatic(const BesideStatic& beside, unsigned lanes);
  unsigned contactWithStatic(const BesideStatic& beside, unsigned lanes);

  std::vector<float> floats_;  // poses, then centres; aligned
  std::vector<unsigned> placed_;
  unsigned group_ = 0;
};

}  // namespace collision_pairs
