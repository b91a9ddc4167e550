// Two nodes with one name.
#pragma once

namespace collision_pairs {

/// True, with an error in the log, if the master knows a node of this name that is alive. A new one
/// would make the master end it, and where a launch file starts it again, it would end the new one,
/// and so on. Takes at most some seconds. Call it after ros::init() and before the first
/// NodeHandle, which registers the node.
bool isSecondNode();

}  // namespace collision_pairs
