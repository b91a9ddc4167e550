// A loop on all cores.
#pragma once

#include <cstddef>
#include <functional>

namespace collision_pairs {

/// Calls work(i) for each i below `count`, each once, in any order, several at a time. The first
/// exception ends the loop and is thrown again here.
void inParallel(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace collision_pairs
