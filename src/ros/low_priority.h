// Low priority for threads that must not delay the cycle.
#pragma once

#include <cerrno>

#include <sys/resource.h>

namespace collision_pairs {

/// Lowers the priority of the calling thread and of every thread that it starts (Linux: nice 10 for
/// this thread alone; the weight of a cycle against it is about 9 to 1). Calling it again changes
/// nothing.
inline void lowerThreadPriority() {
  constexpr int LOW = 10;
  thread_local bool done = false;
  if (done) return;
  done = true;
  errno = 0;
  const int now = getpriority(PRIO_PROCESS, 0);  // on Linux 0 means this thread, not the process
  if (errno == 0 && now < LOW) setpriority(PRIO_PROCESS, 0, LOW);
}

}  // namespace collision_pairs
