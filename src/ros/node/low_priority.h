// Low priority for threads that must not delay the cycle.
#pragma once

#include <sys/resource.h>

namespace collision_pairs {

/// Lowers the priority of the calling thread and of every thread that it starts (Linux: nice 10 for
/// this thread alone; the weight of a cycle against it is about 9 to 1). One that is lower stays
/// so.
inline void lowerThreadPriority() {
  constexpr int LOW = 10;
  // On Linux 0 means this thread, not the process.
  if (getpriority(PRIO_PROCESS, 0) < LOW) setpriority(PRIO_PROCESS, 0, LOW);
}

}  // namespace collision_pairs
