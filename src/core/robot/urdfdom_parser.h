// The one door to urdfdom, which parses URDFs. It gets what decides a check and nothing else, and
// its complaints become errors that name a line.
#pragma once

#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_world/types.h>

namespace collision_pairs {

/// The model of a URDF whose names are known (see checkNames). A capsule is in it as a cylinder of
/// its radius and length, since urdfdom knows no capsules before URDF 1.2.
///
/// urdfdom does not see what no check uses (visuals, inertias, effort, ...), so that cannot make it
/// fail. What it complains of is an InputError with the line, and so is a second element where it
/// would read the first alone; every link, <collision> and joint of the file is in the model.
urdf::ModelInterfaceSharedPtr parseWithUrdfdom(const tinyxml2::XMLElement& robot);

}  // namespace collision_pairs
