# Warnings are errors on our own targets, and only there.
function(collision_pairs_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                           -Wold-style-cast -Werror)
endfunction()

# An index beyond the end ends the program, rather than that a stale value passes as a pose or a verdict: on targets that
# handle input. The core has loops that it would slow down.
function(collision_pairs_checked_indices target)
  target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
endfunction()
