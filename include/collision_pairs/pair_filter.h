// The pairs of collision models to be checked.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace collision_pairs {

/// A symmetric yes/no table over collision models, by id. Each model belongs to a class, and the
/// table is a bit matrix over classes: each link of a robot has a class of its own, while all
/// objects of a large world can share one, which keeps the table small. A model is never paired
/// with itself.
///
/// The filter does not know names, SRDF, or which models are static: the scene builder evaluates
/// all of these rules once and stores the result here, and all checks use it.
///
/// Cost: allowed() is two loads and a bit test; memory is models * 4 bytes + classes^2 / 8.
class PairFilter {
 public:
  PairFilter() = default;

  /// `classes[model]` is the class of the model; initially all pairs of classes are allowed.
  explicit PairFilter(std::vector<std::uint32_t> classes);

  /// Each model in a separate class, everything allowed.
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
  /// The caller must keep the table symmetric.
  std::uint64_t* row(std::uint32_t class_a) { return &bits_[class_a * words_]; }

  /// Keeps the table, for other models with the same classes.
  void setModels(std::vector<std::uint32_t> classes) { classes_ = std::move(classes); }

 private:
  std::vector<std::uint32_t> classes_;
  std::size_t nb_classes_ = 0;
  std::size_t words_ = 0;  // 64-bit words in a row
  std::vector<std::uint64_t> bits_;
};

}  // namespace collision_pairs
