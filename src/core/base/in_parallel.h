// A loop on several threads, the only place where this library starts threads.
#pragma once

#include <cstddef>
#include <functional>

namespace collision_pairs {

/// `wanted`, or for 0 one per core; but at most the number of pieces of work.
std::size_t nbThreads(unsigned wanted, std::size_t count);

/// Calls work(thread, i) for each i below `count`, each once, in any order, on up to `threads`
/// threads, of which the caller's is one. `thread` is below `threads`, and no two calls
/// with the same one overlap: use it as an index into per-thread data. If a thread cannot be
/// started, the others do its work. The first exception of `work` ends the loop and is rethrown
/// here. Allocates nothing with one thread. Cost: tens of microseconds per thread.
void inParallel(std::size_t threads, std::size_t count,
                const std::function<void(std::size_t thread, std::size_t i)>& work);

}  // namespace collision_pairs
