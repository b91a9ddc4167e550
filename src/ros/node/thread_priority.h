// Low priority for threads that must not delay the cycle, real-time scheduling for those that stop
// a robot.
#pragma once

#include <cstring>
#include <string>

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace collision_pairs {

/// Lowers the priority of the calling thread and of every thread that it starts (Linux: nice 10 for
/// this thread alone; the weight of a cycle against it is about 9 to 1). One that is lower stays
/// so.
inline void lowerThreadPriority() {
  constexpr int LOW = 10;
  // On Linux 0 means this thread, not the process.
  if (getpriority(PRIO_PROCESS, 0) < LOW) setpriority(PRIO_PROCESS, 0, LOW);
}

/// Asks for SCHED_FIFO for the calling thread, and so for every thread that it starts from then on.
/// Priorities: 1 to 99; those of a kernel's interrupt threads are at 50. Returns why it is not
/// permitted, with the line of limits.conf that permits it; empty: it is.
inline std::string askForRealTime(int priority) {
  sched_param wanted{};
  wanted.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
  if (error == 0) return "";
  return std::string("no real-time scheduling: ") + std::strerror(error) +
         "; this line in /etc/security/limits.conf permits it to user " + std::to_string(getuid()) +
         " from the next login on: '#" + std::to_string(getuid()) + " - rtprio " +
         std::to_string(priority) + "'";
}

}  // namespace collision_pairs
