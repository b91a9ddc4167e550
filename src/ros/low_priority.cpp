#include "low_priority.h"

#include <cerrno>

#include <sys/resource.h>

namespace collision_pairs {

void lowerThreadPriority() {
  constexpr int LOW = 10;
  thread_local bool done = false;
  if (done) return;
  done = true;
  errno = 0;
  const int now = getpriority(PRIO_PROCESS, 0);  // on Linux 0 means this thread, not the process
  if (errno == 0 && now < LOW) setpriority(PRIO_PROCESS, 0, LOW);
}

}  // namespace collision_pairs
