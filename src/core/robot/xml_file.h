// Parsing of XML with the checks that all readers need, and errors that name the line.
#pragma once

#include <string>
#include <vector>

#include <tinyxml2.h>

namespace collision_pairs {

inline const std::string URDF = "URDF", SRDF = "SRDF";  // begin messages

/// Parses `xml` into `document` and returns its only root element, which must be `root`. Nesting
/// is bounded by tinyxml2 and entities are not expanded, so hostile input costs nothing. Throws
/// InputError; `what` ("URDF") begins the message.
tinyxml2::XMLElement* parseXml(tinyxml2::XMLDocument& document, const std::string& xml,
                               const std::string& root, const std::string& what);

/// The children with this tag, in their order.
std::vector<const tinyxml2::XMLElement*> childrenOf(const tinyxml2::XMLElement& parent,
                                                    const char* tag);

/// Prefixes a message with "URDF line 12: ".
std::string placed(const tinyxml2::XMLElement& element, const std::string& what,
                   const std::string& message);
/// Throws InputError with the prefixed message.
[[noreturn]] void failAt(const tinyxml2::XMLElement& element, const std::string& what,
                         const std::string& message);

/// The attribute, which must exist and not be empty. `owner` ("link 'arm': ") begins the message.
std::string requiredAttribute(const tinyxml2::XMLElement& element, const char* attribute,
                              const std::string& what, const std::string& owner = "");

}  // namespace collision_pairs
