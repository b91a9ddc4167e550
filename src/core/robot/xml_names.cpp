#include "xml_names.h"

#include <cstring>
#include <utility>

#include "user_text.h"
#include "xml_file.h"

namespace collision_pairs {
namespace {

using tinyxml2::XMLElement;
using Words = std::vector<std::string>;

constexpr std::size_t MISSPELT = 2;  // letters; further off it may be another word
constexpr std::size_t MOST_WARNINGS = 20;

/// Whether it was to be expanded: "${x}", "$(find x)".
bool isLeftover(const std::string& text) {
  for (const auto& [begin, end] : {std::pair("${", '}'), std::pair("$(", ')')}) {
    const std::size_t at = text.find(begin);
    if (at != std::string::npos && text.find(end, at) != std::string::npos) return true;
  }
  return false;
}

/// What others read: their words may be ours, and say something else.
bool isOfOthers(const std::string& name) {
  return hasNamespace(name) || name == "gazebo" || name == "transmission" ||
         name == "self_filter" || name == "self_collision_checking";
}

class NameCheck {
 public:
  NameCheck(const XmlGrammar& grammar, const std::string& what) : grammar_(grammar), what_(what) {
    for (const auto& [element, names] : grammar) {
      for (const std::string& read : names.read) {
        if (!contains(anywhere_, read)) anywhere_.push_back(read);
      }
    }
  }

  std::vector<std::string> check(const XMLElement& root) {
    refuseLeftovers(root);
    checkElement(root);
    if (nb_unknown_ > warnings_.size()) {
      warnings_.push_back(what_ + ": and " + std::to_string(nb_unknown_ - warnings_.size()) +
                          " more unknown names");
    }
    return std::move(warnings_);
  }

 private:
  void refuse(const XMLElement& element, const std::string& why) const {
    failAt(element, what_, why + " is not expanded: run xacro on the file, and give its output");
  }

  /// Everywhere but in what others read: there, "$(" may be meant.
  void refuseLeftovers(const XMLElement& element) const {
    for (const auto* a = element.FirstAttribute(); a; a = a->Next()) {
      const bool declares = std::strncmp(a->Name(), "xmlns", 5) == 0;
      if (!declares && isLeftover(a->Value())) {
        refuse(element, std::string(a->Name()) + "='" + a->Value() + "'");
      }
    }
    for (const auto* child = element.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      if (name.rfind("xacro:", 0) == 0) refuse(*child, "<" + name + ">");
      const auto known = grammar_.find(element.Name());
      const bool is_others =
          isOfOthers(name) || (known != grammar_.end() && contains(known->second.unread, name) &&
                               grammar_.count(name) == 0);
      if (!is_others) refuseLeftovers(*child);
    }
  }

  void checkElement(const XMLElement& element) {
    const auto found = grammar_.find(element.Name());
    if (found == grammar_.end()) return;
    const XmlNames& names = found->second;
    for (const auto* a = element.FirstAttribute(); a; a = a->Next()) {
      const std::string name = a->Name();
      if (name == "xmlns" || hasNamespace(name) || contains(names.read_attributes, name) ||
          contains(names.unread_attributes, name)) {
        continue;
      }
      const std::string subject = "attribute '" + name + "' of <" + element.Name() + ">";
      unknown(element, subject, name, names.read_attributes, names.unread_attributes, "'", "'");
      // One that is not read leaves another pose, shape or relation.
      const bool says_all =
          names.read.empty() && names.unread.empty() && names.unread_attributes.empty();
      if (says_all) {
        failAt(element, what_,
               subject + " is unknown; it has " + listOf(names.read_attributes) + " only");
      }
    }
    for (const auto* child = element.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      if (hasNamespace(name)) continue;
      if (contains(names.read, name)) {
        checkElement(*child);
        continue;
      }
      if (contains(names.unread, name)) {
        refuseHidden(*child, element);
        if (!contains(anywhere_, name)) checkElement(*child);
        continue;
      }
      if (contains(anywhere_, name) && grammar_.count(name) > 0) refuseThere(*child);
      unknown(*child, "<" + name + "> in <" + element.Name() + ">", name, names.read, names.unread,
              "<", ">");
      refuseHidden(*child, element);
    }
  }

  /// In what is not read may not stand what would be read elsewhere: what the elements around it
  /// read, and what holds such a part as it holds where it is read. A name alone may mean another
  /// thing.
  void refuseHidden(const XMLElement& unread, const XMLElement& around) const {
    if (isOfOthers(unread.Name())) return;
    const auto own = grammar_.find(unread.Name());
    for (const auto* child = unread.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      const bool is_known = own != grammar_.end() && contains(own->second.unread, name);
      if (!is_known && contains(anywhere_, name) && isHidden(*child, around)) refuseThere(*child);
      refuseHidden(*child, around);
    }
  }

  bool reads(const char* element, const char* name) const {
    const auto found = grammar_.find(element);
    return found != grammar_.end() && contains(found->second.read, name);
  }

  bool isHidden(const XMLElement& element, const XMLElement& around) const {
    for (const auto* child = element.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      if (reads(element.Name(), child->Name())) return true;
    }
    const auto found = grammar_.find(element.Name());
    const bool has_parts = found != grammar_.end() && !found->second.read.empty();
    if (has_parts || !element.FirstAttribute()) return false;
    for (const auto* above = &around; above; above = above->Parent()->ToElement()) {
      if (reads(above->Name(), element.Name())) return true;
    }
    return false;
  }

  void refuseThere(const XMLElement& element) const {
    const std::string name = element.Name();
    failAt(element, what_,
           "<" + name + "> in <" + element.Parent()->Value() + "> is not read; it belongs in <" +
               parentOf(name) + ">");
  }

  static std::string listOf(const Words& words) {
    std::string list;
    for (const std::string& word : words) list += (list.empty() ? "'" : ", '") + word + "'";
    return list;
  }

  std::string parentOf(const std::string& name) const {
    for (const auto& [element, names] : grammar_) {
      if (contains(names.read, name)) return element;
    }
    return "";
  }

  void unknown(const XMLElement& element, const std::string& subject, const std::string& name,
               const Words& read, const Words& unread, const char* left, const char* right) {
    Words known = read;  // first: of names equally near the one that is read counts
    known.insert(known.end(), unread.begin(), unread.end());
    const std::string nearest = nearestName(name, known, MISSPELT);
    const std::string near_read = nearestName(name, read, MISSPELT);
    const std::string nearest_read = near_read.empty() ? nearestName(name, read) : near_read;
    // Nearer to a name that is not used, it is taken for that.
    if (!near_read.empty() && !contains(unread, nearest)) {
      failAt(element, what_,
             subject + " is unknown; did you mean " + left + near_read + right + "?");
    }
    const std::string& hint = nearest.empty() ? nearest_read : nearest;
    if (++nb_unknown_ > MOST_WARNINGS) return;
    warnings_.push_back(
        placed(element, what_,
               subject + " is unknown and not used" +
                   (hint.empty() ? "" : "; the nearest known name is " + (left + hint) + right)));
  }

  const XmlGrammar& grammar_;
  const std::string what_;
  Words anywhere_;  ///< elements that are read somewhere
  std::vector<std::string> warnings_;
  std::size_t nb_unknown_ = 0;
};

}  // namespace

bool hasNamespace(const std::string& name) { return name.find(':') != std::string::npos; }

std::vector<std::string> checkNames(const XMLElement& root, const XmlGrammar& grammar,
                                    const std::string& what) {
  return NameCheck(grammar, what).check(root);
}

/// From the URDF specification, the parser of urdfdom, and what Gazebo, MuJoCo, Drake, Bullet and
/// the exporters of CAD programs add.
const XmlGrammar& urdfGrammar() {
  static const XmlGrammar GRAMMAR = {
      {"robot",
       {{"link", "joint"},
        {"material", "gazebo", "transmission", "sensor", "model_state", "ros2_control", "mujoco",
         "drake", "plugin", "group", "controller", "version", "static", "compiler"},
        {"name"},
        {"version", "type"}}},
      {"link",
       {{"collision"},
        {"visual", "inertial", "contact", "sensor", "gazebo", "material", "verbose",
         "self_collision_checking", "self_filter", "velocity_decay", "audio_source", "audio_sink"},
        {"name"},
        {"type", "id"}}},
      {"visual",
       {{},
        {"origin", "geometry", "material", "verbose", "meterial", "cast_shadows", "transparency"},
        {},
        {"name", "group", "type"}}},
      {"collision",
       {{"origin", "geometry"},
        {"material", "contact_coefficients", "verbose", "max_contacts", "surface", "contact",
         "margin", "laser_retro"},
        {},
        {"name", "group", "type", "concave"}}},
      {"geometry", {{"box", "sphere", "cylinder", "capsule", "mesh"}, {}, {}, {}}},
      {"box", {{}, {}, {"size"}, {}}},
      {"sphere", {{}, {}, {"radius"}, {}}},
      {"cylinder", {{}, {}, {"radius", "length"}, {}}},
      {"capsule", {{}, {}, {"radius", "length"}, {}}},
      {"mesh", {{}, {}, {"filename", "scale"}, {}}},
      {"origin", {{}, {}, {"xyz", "rpy"}, {}}},
      {"joint",
       {{"origin", "parent", "child", "axis", "limit", "mimic"},
        {"dynamics", "calibration", "safety_controller", "gazebo", "joint_properties", "disabled",
         "verbose", "damping", "friction", "hardwareInterface", "sensor"},
        {"name", "type"},
        {"id"}}},
      {"parent", {{}, {}, {"link"}, {"name"}}},
      {"child", {{}, {}, {"link"}, {"name"}}},
      {"axis", {{}, {}, {"xyz"}, {"rpy"}}},
      {"limit",
       {{},
        {},
        {"lower", "upper"},
        {"effort", "velocity", "acceleration", "jerk", "deceleration", "drive", "damping",
         "friction"}}},
      {"mimic", {{}, {}, {"joint", "multiplier", "offset"}, {}}}};
  return GRAMMAR;
}

/// From the SRDF's specification and the parser of srdfdom.
const XmlGrammar& srdfGrammar() {
  static const XmlGrammar GRAMMAR = {
      {"robot",
       {{"group", "disable_collisions", "enable_collisions", "disable_default_collisions",
         "virtual_joint", "passive_joint"},
        {"group_state", "end_effector", "joint_property", "link_sphere_approximation",
         "end_effectors", "property", "gripper", "grasp"},
        {"name"},
        {"version"}}},
      {"group",
       {{"link", "joint", "chain", "group"}, {"property", "passive_joint"}, {"name"}, {"type"}}},
      {"link", {{}, {}, {"name"}, {}}},
      {"joint", {{}, {}, {"name"}, {}}},
      {"chain", {{}, {}, {"base_link", "tip_link"}, {}}},
      {"disable_collisions", {{}, {}, {"link1", "link2"}, {"reason"}}},
      {"enable_collisions", {{}, {}, {"link1", "link2"}, {"reason"}}},
      {"disable_default_collisions", {{}, {}, {"link"}, {"reason"}}},
      {"virtual_joint", {{}, {}, {"name", "child_link"}, {"type", "parent_frame"}}},
      {"passive_joint", {{}, {}, {"name"}, {}}}};
  return GRAMMAR;
}

}  // namespace collision_pairs
