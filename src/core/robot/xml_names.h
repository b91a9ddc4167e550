// Which elements and attributes of a URDF or SRDF are read, and which may stand there unread:
// what is neither is named, since a name that is skipped may be geometry that is not checked.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <tinyxml2.h>

namespace collision_pairs {

/// What may stand in an element.
struct XmlNames {
  std::vector<std::string> read;    ///< elements whose names decide what is checked
  std::vector<std::string> unread;  ///< elements that are known, and rightly not used
  std::vector<std::string> read_attributes, unread_attributes;
};

/// By element. In those without an entry only what would be read elsewhere is looked for.
using XmlGrammar = std::map<std::string, XmlNames>;

const XmlGrammar& urdfGrammar();
const XmlGrammar& srdfGrammar();

/// "drake:declare_convex"
bool hasNamespace(const std::string& name);

/// Throws InputError with the line where something is left of xacro (an element xacro:..., ${...},
/// $(...)), where a name is within two letters of one that is read there, and where an element that
/// decides what is checked stands in another one that does not read it. Returns a warning for each
/// other unknown name. Names with another namespace are quiet. `what`: "URDF".
std::vector<std::string> checkNames(const tinyxml2::XMLElement& root, const XmlGrammar& grammar,
                                    const std::string& what);

}  // namespace collision_pairs
