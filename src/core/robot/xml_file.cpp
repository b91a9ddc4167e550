#include "xml_file.h"

#include "collision_pairs/input_error.h"

namespace collision_pairs {

tinyxml2::XMLElement* parseXml(tinyxml2::XMLDocument& document, const std::string& xml,
                               const std::string& root, const std::string& what) {
  if (xml.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError(what + ": it is empty; a <" + root + "> element is needed");
  }
  if (xml.find('\0') != std::string::npos) throw InputError(what + ": it contains a NUL byte");
  if (document.Parse(xml.c_str(), xml.size()) != tinyxml2::XML_SUCCESS) {
    const bool too_deep = document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    throw InputError(what + " line " + std::to_string(document.ErrorLineNum()) +
                     (too_deep
                          ? ": elements are nested too deeply"
                          : ": not well-formed XML (" + std::string(document.ErrorName()) + ")"));
  }
  tinyxml2::XMLElement* element = document.FirstChildElement();
  if (element == nullptr) throw InputError(what + ": no <" + root + "> element");
  if (root != element->Name()) {
    failAt(*element, what,
           "the root element is <" + std::string(element->Name()) + ">, but must be <" + root +
               ">" + (std::string(element->Name()) == "sdf" ? "; an SDF is not read" : ""));
  }
  if (const auto* second = element->NextSiblingElement()) {
    failAt(*second, what, "a second root element <" + std::string(second->Name()) + ">");
  }
  return element;
}

std::vector<const tinyxml2::XMLElement*> childrenOf(const tinyxml2::XMLElement& parent,
                                                    const char* tag) {
  std::vector<const tinyxml2::XMLElement*> children;
  for (auto* child = parent.FirstChildElement(tag); child; child = child->NextSiblingElement(tag)) {
    children.push_back(child);
  }
  return children;
}

std::string placed(const tinyxml2::XMLElement& element, const std::string& what,
                   const std::string& message) {
  return what + " line " + std::to_string(element.GetLineNum()) + ": " + message;
}

void failAt(const tinyxml2::XMLElement& element, const std::string& what,
            const std::string& message) {
  throw InputError(placed(element, what, message));
}

std::string requiredAttribute(const tinyxml2::XMLElement& element, const char* attribute,
                              const std::string& what, const std::string& owner) {
  const char* value = element.Attribute(attribute);
  if (value == nullptr || *value == '\0') {
    failAt(element, what, owner + "<" + std::string(element.Name()) + "> has no " + attribute);
  }
  return value;
}

}  // namespace collision_pairs
