// Real-time scheduling for threads that stop a robot.
#pragma once

#include <cstring>
#include <string>

#include <pthread.h>
#include <sched.h>
#include <unistd.h>

namespace collision_pairs {

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
