// Which pairs of collision models are looked at at all.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace collision_pairs {

/// A symmetric yes/no table over collision models, by id. Each model belongs to a class, and the
/// table is a bit matrix over classes: the links of a robot have a class each, while all objects
/// of a large world can share one, so that the table stays small. A model is never paired with
/// itself.
///
/// It knows nothing of names, of SRDF or of which models are static: whoever builds the scene
/// writes the outcome of all those rules here, once, and every path asks here.
///
/// Cost: allowed() is two loads and a bit test; memory is models * 4 bytes + classes^2 / 8.
class PairFilter {
 public:
  PairFilter() = default;

  /// `classes[model]` is the class of the model; every pair of classes starts as allowed.
  explicit PairFilter(std::vector<std::uint32_t> classes);

  /// Every model in a class of its own, everything allowed.
  static PairFilter allowAll(std::size_t nb_models);

  std::size_t nbModels() const { return classes_.size(); }
  std::size_t nbClasses() const { return nb_classes_; }
  std::uint32_t classOf(std::uint32_t model) const { return classes_[model]; }

  void setClassPair(std::uint32_t class_a, std::uint32_t class_b, bool allowed);
  bool classPairAllowed(std::uint32_t class_a, std::uint32_t class_b) const {
    return (row(class_a)[class_b >> 6] >> (class_b & 63)) & 1u;
  }

  bool allowed(std::uint32_t model_a, std::uint32_t model_b) const {
    return model_a != model_b && classPairAllowed(classes_[model_a], classes_[model_b]);
  }

  /// The bits of one class against all others: bit b of word b / 64.
  const std::uint64_t* row(std::uint32_t class_a) const { return &bits_[class_a * words_]; }
  /// Whoever writes a row keeps the table symmetric.
  std::uint64_t* row(std::uint32_t class_a) { return &bits_[class_a * words_]; }

  /// The same table for other models, of the same classes.
  void setModels(std::vector<std::uint32_t> classes) { classes_ = std::move(classes); }

 private:
  std::vector<std::uint32_t> classes_;
  std::size_t nb_classes_ = 0;
  std::size_t words_ = 0;  // 64-bit words in a row
  std::vector<std::uint64_t> bits_;
};

}  // namespace collision_pairs
