// Work that must not hold up the cycle.
#pragma once

namespace collision_pairs {

/// From now on the calling thread, and every thread that it starts, gives way to threads of normal
/// priority (Linux: nice 10 for this thread alone; the weight of a cycle against it is about 9 to
/// 1). Calling it again changes nothing.
void lowerThreadPriority();

}  // namespace collision_pairs
