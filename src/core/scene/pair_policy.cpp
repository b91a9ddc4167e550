#include "pair_policy.h"

#include <algorithm>
#include <string_view>
#include <unordered_map>

namespace collision_pairs {
namespace {

/// A set of classes, stored like a row of the filter.
class ClassSet {
 public:
  explicit ClassSet(std::size_t nb_classes) : words_((nb_classes + 63) / 64, 0) {}
  void insert(std::size_t c) { words_[c >> 6] |= std::uint64_t{1} << (c & 63); }
  bool has(std::size_t c) const { return (words_[c >> 6] >> (c & 63)) & 1u; }
  bool meets(const std::uint64_t* row) const {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      if ((row[w] & words_[w]) != 0) return true;
    }
    return false;
  }

  void addTo(std::uint64_t* row) const {
    for (std::size_t w = 0; w < words_.size(); ++w) row[w] |= words_[w];
  }
  void removeFrom(std::uint64_t* row) const {
    for (std::size_t w = 0; w < words_.size(); ++w) row[w] &= ~words_[w];
  }
  void keepOnlyIn(std::uint64_t* row) const {
    for (std::size_t w = 0; w < words_.size(); ++w) row[w] &= words_[w];
  }

 private:
  std::vector<std::uint64_t> words_;
};

void switchOff(std::size_t c, std::uint64_t* row) {
  row[c >> 6] &= ~(std::uint64_t{1} << (c & 63));
}

/// Writes the table 64 pairs at a time.
class PolicyMaker {
 public:
  PolicyMaker(const SceneDescription& description, SceneClasses& classes)
      : description_(description),
        classes_(classes),
        all_(classes.all),
        restricted_(classes.rules->signature.restricted()) {}

  PairPolicy make() {
    PairPolicy policy{filter(), {}};
    noteNeeds(policy.filter);
    policy.paddings = paddings(policy.filter);
    for (auto& its_class : all_) its_class.half_padding = 0.0;
    for (const auto& [pair, metres] : policy.paddings) {
      for (const std::uint32_t c : {pair.first, pair.second}) {
        all_[c].half_padding = std::max(all_[c].half_padding, 0.5 * metres);
      }
    }
    return policy;
  }

 private:
  using Member = SceneMember;

  /// The classes whose example satisfies a condition.
  template <class Holds>
  ClassSet where(const Holds& holds) const {
    ClassSet classes(all_.size());
    for (std::size_t c = 0; c < all_.size(); ++c) {
      if (holds(all_[c].example)) classes.insert(c);
    }
    return classes;
  }

  ClassSet named(const NamePattern& pattern) const {
    return where([&](const Member& m) { return matches(pattern, m.name); });
  }

  bool isRestricted(const Member& m) const {
    return restricted_->have(m.name, m.object ? m.object->attached_link : "");
  }

  std::vector<int> classesOfLinks() const {
    std::vector<int> classes(classes_.rules->switched_off->size(), -1);
    for (std::size_t c = 0; c < all_.size(); ++c) {
      const int link = all_[c].example.link;
      if (link >= 0) classes[static_cast<std::size_t>(link)] = static_cast<int>(c);
    }
    return classes;
  }

  PairFilter filter() const {
    const ClassSet statics = where([](const Member& m) { return m.isStatic(); });
    const ClassSet links = where([](const Member& m) { return m.robot >= 0; });
    const ClassSet restricted =
        where([&](const Member& m) { return restricted_ != nullptr && isRestricted(m); });
    const std::vector<int> class_of_link = classesOfLinks();
    std::vector<std::pair<ClassSet, ClassSet>> rules;
    for (const PairRule& rule : description_.settings.pair_rules) {
      rules.emplace_back(named(rule.first), named(rule.second));
    }
    std::map<int, ClassSet> objects_on;  // by body
    for (std::size_t c = 0; c < all_.size(); ++c) {
      const Member& member = all_[c].example;
      if (!member.object || member.isStatic()) continue;
      objects_on.try_emplace(member.body, all_.size()).first->second.insert(c);
    }

    PairFilter filter = PairFilter::allowAll(all_.size());
    for (std::uint32_t c = 0; c < all_.size(); ++c) {
      const Member& member = all_[c].example;
      std::uint64_t* row = filter.row(c);
      if (member.link >= 0) {
        if (!description_.check_self) links.removeFrom(row);
        for (const std::uint32_t other :
             (*classes_.rules->switched_off)[static_cast<std::size_t>(member.link)]) {
          if (class_of_link[other] >= 0) {
            switchOff(static_cast<std::size_t>(class_of_link[other]), row);
          }
        }
      }
      for (std::size_t i = 0; i < rules.size(); ++i) {
        const bool allow = description_.settings.pair_rules[i].verdict == PairRule::Verdict::ALLOW;
        const auto apply = [&](const ClassSet& to) { allow ? to.addTo(row) : to.removeFrom(row); };
        if (rules[i].first.has(c)) apply(rules[i].second);
        if (rules[i].second.has(c)) apply(rules[i].first);
      }
      if (restricted_ && !restricted.has(c)) restricted.keepOnlyIn(row);
      if (member.isStatic()) statics.removeFrom(row);
      if (member.object && !member.isStatic()) objects_on.at(member.body).removeFrom(row);
      switchOff(c, row);
    }
    switchOffTouching(filter);
    return filter;
  }

  void switchOffTouching(PairFilter& filter) const {
    std::unordered_map<std::string_view, std::uint32_t> class_of_name;
    for (std::uint32_t c = 0; c < all_.size(); ++c) class_of_name.emplace(all_[c].example.name, c);
    for (std::uint32_t c = 0; c < all_.size(); ++c) {
      const ObjectPtr& object = all_[c].example.object;
      if (!object) continue;
      const auto mayTouch = [&](const std::string& name) {
        const auto found = class_of_name.find(name);
        if (found != class_of_name.end()) filter.setClassPair(c, found->second, false);
      };
      std::for_each(object->touch_links.begin(), object->touch_links.end(), mayTouch);
      mayTouch(object->attached_link);
    }
  }

  // A pair is checked at the coarser geometry of its two members.
  void noteNeeds(const PairFilter& filter) {
    for (auto& its_class : all_) {
      its_class.is_needed = false;
      its_class.needed_fidelity = Fidelity::AABB;
    }
    for (const Fidelity fidelity :
         {Fidelity::AABB, Fidelity::SPHERES, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
      const ClassSet as_fine = where([&](const Member& m) { return m.finest >= fidelity; });
      for (std::uint32_t c = 0; c < all_.size(); ++c) {
        if (!as_fine.has(c) || !as_fine.meets(filter.row(c))) continue;
        all_[c].is_needed = true;
        all_[c].needed_fidelity = fidelity;
      }
    }
  }

  ClassPaddings paddings(const PairFilter& filter) const {
    ClassPaddings paddings;
    for (const PairPadding& pair : description_.settings.pair_padding) {
      const ClassSet first = named(pair.first), second = named(pair.second);
      for (std::uint32_t a = 0; a < all_.size(); ++a) {
        for (std::uint32_t b = 0; first.has(a) && b < all_.size(); ++b) {
          if (!second.has(b) || !filter.classPairAllowed(a, b)) continue;
          paddings[std::minmax(a, b)] = pair.metres;  // the last
        }
      }
    }
    return paddings;
  }

  const SceneDescription& description_;
  SceneClasses& classes_;
  std::vector<SceneClasses::Class>& all_;
  const RestrictedNames* restricted_;
};

}  // namespace

PairPolicy PairPolicy::of(const SceneDescription& description, SceneClasses& classes) {
  return PolicyMaker(description, classes).make();
}

}  // namespace collision_pairs
