// The numbers of COLLADA's surfaces and of the nodes that place them.
#pragma once

#include <string>

#include <tinyxml2.h>

namespace collision_pairs {

inline const std::string COLLADA = "COLLADA";  // begins messages

/// Throws InputError, with the line, for what assimp reads in another way than it is written, or in
/// part: names in a <mesh> that the schema does not have; counts that are not those of the numbers;
/// words that are no decimals; indices that name no position; coordinates that are not X, Y and Z;
/// ids that are not those of one source.
void requireColladaNumbers(const tinyxml2::XMLElement& root);

}  // namespace collision_pairs
