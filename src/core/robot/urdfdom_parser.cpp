#include "urdfdom_parser.h"

#include <cstring>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include "collision_pairs/input_error.h"
#include "user_text.h"
#include "xml_file.h"
#include "xml_names.h"

namespace collision_pairs {
namespace {

using tinyxml2::XMLElement;

/// The link or joint that the element is, or is in: "link 'arm': ".
std::string ownerOf(const XMLElement& element) {
  for (const tinyxml2::XMLNode* node = &element; node; node = node->Parent()) {
    const XMLElement* owner = node->ToElement();
    if (owner == nullptr || !owner->Attribute("name")) continue;
    const std::string tag = owner->Name();
    if (tag == "link" || tag == "joint") return tag + " '" + owner->Attribute("name") + "': ";
  }
  return "";
}

[[noreturn]] void fail(const XMLElement& element, const std::string& message) {
  failAt(element, URDF, ownerOf(element) + message);
}

bool isIn(const XMLElement& element, const char* parent) {
  const char* const above = element.Parent()->Value();  // null: the document
  return above && std::strcmp(above, parent) == 0;
}

const XmlNames& namesIn(const XMLElement& element) {
  static const XmlNames NONE;
  const auto found = urdfGrammar().find(element.Name());
  return found == urdfGrammar().end() ? NONE : found->second;
}

/// What is read, in the order of the file, parents first. In <geometry> that is all but what has
/// another namespace: what is no shape stands there in place of one.
void gather(const XMLElement& element, std::vector<const XMLElement*>& read) {
  read.push_back(&element);
  const bool is_geometry = std::strcmp(element.Name(), "geometry") == 0;
  for (auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const bool is_read =
        is_geometry ? !hasNamespace(child->Name()) : contains(namesIn(element).read, child->Name());
    if (is_read) gather(*child, read);
  }
}

/// urdfdom takes the first <origin>, <axis>, <geometry> or shape, and skips the others.
void refuseSecond(const std::vector<const XMLElement*>& read) {
  std::set<std::pair<const tinyxml2::XMLNode*, std::string>> seen;
  for (const XMLElement* element : read) {
    const std::string tag = element->Name();
    if (tag == "robot" || tag == "link" || tag == "joint" || tag == "collision") continue;
    const bool is_shape = isIn(*element, "geometry");
    if (seen.emplace(element->Parent(), is_shape ? "shape" : tag).second) continue;
    if (is_shape) fail(*element, "<geometry> holds one shape, and <" + tag + "> is one too many");
    fail(*element, "a second <" + tag + "> in one <" + element->Parent()->Value() + ">" +
                       (tag == "geometry" ? "; give it a <collision> of its own" : ""));
  }
}

/// What urdfdom would take, a part without a name, and what it would refuse without a reason.
void requireParts(const std::vector<const XMLElement*>& read) {
  for (const XMLElement* element : read) {
    const std::string tag = element->Name();
    if (tag == "robot" || tag == "link" || tag == "joint") {
      requiredAttribute(*element, "name", URDF);
    }
    if (tag == "collision" && !element->FirstChildElement("geometry")) {
      fail(*element, "<collision> without <geometry>");
    }
  }
}

/// urdfdom separates numbers by blanks alone, and gives what it quotes to printf() as a format.
std::string numbers(const XMLElement& element, const tinyxml2::XMLAttribute& attribute) {
  std::istringstream words(attribute.Value());
  std::string word, text;
  while (words >> word) text += (text.empty() ? "" : " ") + word;
  if (text.find('%') == std::string::npos) return text;
  fail(element, "<" + std::string(element.Name()) + ">: " + attribute.Name() + " '" + text +
                    "' holds more than numbers");
}

/// The first `count` of the elements as the text of a URDF.
std::string textOf(const std::vector<const XMLElement*>& read, std::size_t count) {
  static const std::vector<std::string> TEXTS = {"name", "type", "link", "joint", "filename"};
  tinyxml2::XMLPrinter printer(nullptr, true);
  std::vector<const tinyxml2::XMLNode*> open;
  for (std::size_t i = 0; i < count; ++i) {
    const XMLElement& element = *read[i];
    while (!open.empty() && open.back() != element.Parent()) {
      printer.CloseElement(true);
      open.pop_back();
    }
    open.push_back(&element);
    const std::string tag = element.Name();
    printer.OpenElement(tag == "capsule" ? "cylinder" : element.Name(), true);  // keeps pointers
    for (const auto* a = element.FirstAttribute(); a; a = a->Next()) {
      if (!contains(namesIn(element).read_attributes, a->Name())) continue;
      const bool is_text = contains(TEXTS, a->Name());
      printer.PushAttribute(a->Name(), is_text ? a->Value() : numbers(element, *a).c_str());
    }
    if (tag == "limit") {  // without these urdfdom refuses it
      printer.PushAttribute("effort", 0);
      printer.PushAttribute("velocity", 0);
    }
  }
  for (; !open.empty(); open.pop_back()) printer.CloseElement(true);
  return printer.CStr();
}

/// Keeps the errors of this thread; those of others go where they went.
class Complaints : public console_bridge::OutputHandler {
 public:
  Complaints() : lock_(mutex()), others_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~Complaints() override { console_bridge::restorePreviousOutputHandler(); }

  void log(const std::string& text, console_bridge::LogLevel level, const char* file,
           int line) override {
    if (std::this_thread::get_id() != thread_) {
      if (others_) others_->log(text, level, file, line);
    } else if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) {
      said.push_back(text);
    }
  }

  std::vector<std::string> said;

 private:
  static std::mutex& mutex() {
    static std::mutex one_at_a_time;
    return one_at_a_time;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* others_;
  std::thread::id thread_ = std::this_thread::get_id();
};

/// What urdfdom makes of the text, and in `said` what it complains of.
urdf::ModelInterfaceSharedPtr parse(const std::string& text, std::vector<std::string>& said) {
  Complaints complaints;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(text);
  } catch (const std::exception& error) {
    complaints.said.push_back(error.what());
  }
  said = complaints.said;
  if (!model && said.empty()) said.push_back("urdfdom does not read it");
  return model;
}

/// The last link or joint that the complaint names in brackets; null: none.
const XMLElement* named(const std::vector<const XMLElement*>& read, const std::string& complaint) {
  const XMLElement* last = nullptr;
  for (const XMLElement* element : read) {
    if (!isIn(*element, "robot")) continue;
    const std::string quoted = "[" + std::string(element->Attribute("name")) + "]";
    if (complaint.find(quoted) != std::string::npos) last = element;
  }
  return last;
}

/// urdfdom names no line: the element is to blame with which the complaint begins; if it is of the
/// tree ("Failed to build tree: ..."), the whole joint or link that it names.
const XMLElement& blamed(const std::vector<const XMLElement*>& read, const std::string& complaint) {
  const bool is_of_tree = complaint.rfind("Failed to ", 0) == 0;
  const XMLElement* const whole = is_of_tree ? named(read, complaint) : nullptr;
  if (whole) return *whole;
  std::size_t without = 0, with = read.size();
  while (with - without > 1) {
    const std::size_t middle = (without + with) / 2;
    std::vector<std::string> said;
    parse(textOf(read, middle), said);
    (contains(said, complaint) ? with : without) = middle;
  }
  return *read[with - 1];
}

/// urdfdom skips some of what it does not understand, and goes on.
void requireAll(const XMLElement& robot, const urdf::ModelInterface& model) {
  for (const XMLElement* link : childrenOf(robot, "link")) {
    const auto found = model.links_.find(link->Attribute("name"));
    const bool has_all = found != model.links_.end() && found->second->collision_array.size() ==
                                                            childrenOf(*link, "collision").size();
    if (!has_all) fail(*link, "urdfdom does not read all of it");
  }
  for (const XMLElement* joint : childrenOf(robot, "joint")) {
    if (model.joints_.count(joint->Attribute("name")) == 0)
      fail(*joint, "urdfdom does not read it");
  }
}

}  // namespace

urdf::ModelInterfaceSharedPtr parseWithUrdfdom(const XMLElement& robot) {
  std::vector<const XMLElement*> read;
  gather(robot, read);
  refuseSecond(read);
  requireParts(read);
  std::vector<std::string> said;
  const auto model = parse(textOf(read, read.size()), said);
  if (!said.empty()) {
    const XMLElement& culprit = blamed(read, said.front());
    fail(culprit, "<" + std::string(culprit.Name()) + ">: " + said.front());
  }
  requireAll(robot, *model);
  return model;
}

}  // namespace collision_pairs
