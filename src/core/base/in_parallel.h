// A loop on several threads: the one way in which this library starts any.
#pragma once

#include <cstddef>
#include <functional>

namespace collision_pairs {

/// `wanted`, or for 0 as many as the machine has; but no more than there are pieces of work.
std::size_t nbThreads(unsigned wanted, std::size_t count);

/// Calls work(thread, i) for each i below `count`, each once, in any order, on up to `threads`
/// threads, of which the caller's is one. `thread` is below `threads`, and no two calls
/// with the same one overlap: an index into what each thread needs of its own. A thread that cannot
/// be started is done without. The first exception of `work` ends the loop and is thrown again
/// here. Allocates nothing where there is one thread. Cost: tens of microseconds a thread.
void inParallel(std::size_t threads, std::size_t count,
                const std::function<void(std::size_t thread, std::size_t i)>& work);

}  // namespace collision_pairs
