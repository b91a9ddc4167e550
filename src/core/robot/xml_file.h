// An XML text with the checks that every reader of one needs, and errors that name the line.
#pragma once

#include <string>

#include <tinyxml2.h>

namespace collision_pairs {

/// Parses `xml` into `document` and returns its only root element, which must be `root`. Nesting
/// is bounded by tinyxml2 and entities are not expanded, so hostile input costs nothing. Throws
/// InputError; `what` ("URDF") begins the message.
tinyxml2::XMLElement* parseXml(tinyxml2::XMLDocument& document, const std::string& xml,
                               const std::string& root, const std::string& what);

/// "URDF line 12: " in front of a message.
std::string placed(const tinyxml2::XMLElement& element, const std::string& what,
                   const std::string& message);
/// Throws InputError with the placed message.
[[noreturn]] void failAt(const tinyxml2::XMLElement& element, const std::string& what,
                         const std::string& message);

/// The attribute, which must be there and not be empty. `owner` ("link 'arm': ") begins the
/// message.
std::string requiredAttribute(const tinyxml2::XMLElement& element, const char* attribute,
                              const std::string& what, const std::string& owner = "");

}  // namespace collision_pairs
