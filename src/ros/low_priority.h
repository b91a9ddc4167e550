// Low priority for threads that must not delay the cycle.
#pragma once

namespace collision_pairs {

/// Lowers the priority of the calling thread and of every thread that it starts (Linux: nice 10 for
/// this thread alone; the weight of a cycle against it is about 9 to 1). Calling it again changes
/// nothing.
void lowerThreadPriority();

}  // namespace collision_pairs
