// Settles straight motions in joint space, several parts of one at a time.
#pragma once

#include <vector>

#include "batch_stage.h"

namespace collision_pairs {

/// The lanes are the middles of equal parts of the motion. Outer spheres that are further apart
/// there than the pair can move within half a part are so in the whole part: a joint that turns by
/// an angle moves a point by at most its product with the largest distance of the point from the
/// joint's axis, for all positions of the joints between (Schwarzer, Saha, Latombe 2005, with a
/// bound that is coarser but the same for all motions). What is close to others by its nature,
/// neighbours but one in a chain, tables settle along the whole motion at once. FREE: nothing is
/// nearer than PairTable::APART, but for two elements of one body, which never touch; CONTACT: that
/// of the exact check, of one configuration. Mesh fidelity only. For one thread; the stage must
/// outlive it.
class BatchStage::EdgeGroup : private BatchStage::Group {
 public:
  explicit EdgeGroup(const BatchStage& stage);

  using Group::Outcome;
  /// One entry per joint of the robot, mimic joints applied. OPEN: what parts() do not name is
  /// free.
  Outcome settle(const std::vector<double>& from, const std::vector<double>& to);

  /// For CONTACT: the elements, and the fraction of the motion.
  BoxPair contact() const { return contact_; }
  double contactAt() const { return contact_at_; }
  /// For OPEN: what may be nearer than APART between two fractions.
  struct Part {
    BoxPair pair;  ///< moving elements; with is_static the first, and all static ones
    bool is_static;
    double begin, end;
  };
  const std::vector<Part>& parts() const { return parts_; }
  int nbConfigurations() const { return nb_parts_; }

 private:
  /// Metres by which a joint moves something for each rad or metre.
  struct Reach {
    int column;
    double metres;
  };
  struct Line {
    bool is_known;
    PairTable::Along along;
  };
  struct OpenPart {
    int index;  ///< of the pair, or nb_pairs + that of what is beside static elements
    int part;
    bool operator<(const OpenPart& other) const {
      return index != other.index ? index < other.index : part < other.part;
    }
  };
  void addReaches(std::uint32_t element, int up_to, std::vector<Reach>& reaches) const;
  bool begin(const std::vector<double>& from, const std::vector<double>& to);
  double widthOf(const std::vector<Reach>& reaches) const;
  bool meets();
  /// Of the part in a lane.
  double fractionAt(int lane, double within) const {
    return (first_part_ + lane * nb_groups_ + within) / nb_parts_;
  }
  Outcome gatherParts();
  unsigned lookUp(int pair, unsigned lanes, unsigned* certain) override;

  std::vector<std::vector<Reach>> reaches_;         // by pair
  std::vector<std::vector<Reach>> static_reaches_;  // by beside_static_
  std::vector<double> from_, to_;                   // by column
  int nb_groups_ = 1, nb_parts_ = 1, first_part_ = 0;
  std::vector<Line> lines_;  // by pair
  std::vector<OpenPart> noted_;
  std::vector<Part> parts_;
  BoxPair contact_{};
  double contact_at_ = 0.0;
  int line_in_contact_ = -1;
};

}  // namespace collision_pairs
