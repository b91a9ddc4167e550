// What is said where input is refused.
#pragma once

#include <string>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

/// The words of the InputError that `work` throws; "accepted" if it throws none.
template <class Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace collision_pairs
