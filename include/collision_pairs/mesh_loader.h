// Meshes by the URIs that URDFs use. In the library collision_pairs_io.
#pragma once

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// A loader for package:// and file://: STL and OBJ, read here, and by geometric_shapes in a
/// process of its own COLLADA and what else assimp reads. The mesh lies where rviz shows it:
/// coordinates as they are in the file, COLLADA's up_axis ignored. One file is read once for each
/// scale. Other schemes are refused: a robot description makes nobody fetch from the network.
/// Throws InputError that names the URI and what is wrong with it. Not thread safe.
MeshLoader makeMeshLoader();

}  // namespace collision_pairs
