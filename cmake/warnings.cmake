# Warnings are errors on our own targets, and only there.
function(collision_pairs_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                           -Wold-style-cast -Werror)
endfunction()
