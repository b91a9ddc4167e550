// Loads meshes by the URIs of URDFs. In the library collision_pairs_io (collision_pairs::io).
#pragma once

#include <functional>
#include <string>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

using Warn = std::function<void(const std::string& warning)>;

/// A loader for package:// and file:// URIs. STL, OBJ and PLY are read by this package; COLLADA and
/// glTF by assimp and geometric_shapes in a separate process; other endings are refused. Vertices
/// are in metres in the frame that rviz uses: coordinates as stored in the file, times the scale;
/// COLLADA's <unit> counts, its up_axis is ignored; meshes of a glTF's root node are placed by
/// that. What does not exist as written is looked for with %20 and the like decoded. A loader reads
/// each file once for each scale: to see that a file has changed takes a new one. Other schemes are
/// refused, so that a robot description cannot trigger network access. Throws InputError that names
/// the URI and the problem. Not thread safe.
///
/// `warn`, if it is given, is told of the first mesh whose unit is not the metre.
MeshLoader makeMeshLoader(const Warn& warn = nullptr);

/// A loader for the URDF of a file in this folder: paths without a scheme are relative to the
/// folder, all else is left to `load`. An empty folder: `load`, which refuses such paths.
MeshLoader relativeTo(const std::string& folder, const MeshLoader& load);

}  // namespace collision_pairs
