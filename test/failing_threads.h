// Lets no more than a number of threads be started, in the one test program that includes this.
#pragma once

#include <atomic>
#include <cerrno>

#include <dlfcn.h>
#include <pthread.h>

namespace collision_pairs {

/// Threads that may still be started; below 0: any number.
inline std::atomic<int> threads_left{-1};

}  // namespace collision_pairs

/// Stands before that of the C library, also for std::thread.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*work)(void*), void* argument) noexcept {
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  if (collision_pairs::threads_left == 0) return EAGAIN;
  if (collision_pairs::threads_left > 0) --collision_pairs::threads_left;
  return create(thread, attributes, work, argument);
}
