# libFuzzer targets, with the address and undefined-behaviour sanitizers. Needs clang:
#   CXX=clang++ cmake -DCOLLISION_PAIRS_FUZZ=ON … && make fuzz_sweep_and_prune
#   ./fuzz_sweep_and_prune -max_total_time=600 NEW_FINDS test/fuzz/corpus_sweep_and_prune
if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "COLLISION_PAIRS_FUZZ needs clang: set CXX=clang++")
endif()

# All of the broad phase, compiled once more so that it is instrumented.
get_target_property(sweep_sources collision_pairs SOURCES)
list(FILTER sweep_sources INCLUDE REGEX "/(base/(in_parallel|pair_filter)|broad_phase/.*|geometry/aabb)[.]cpp")
add_executable(fuzz_sweep_and_prune test/fuzz/fuzz_sweep_and_prune.cpp ${sweep_sources})
target_include_directories(fuzz_sweep_and_prune PRIVATE include ${CORE_MODULES} test)
target_compile_definitions(fuzz_sweep_and_prune PRIVATE $<TARGET_PROPERTY:collision_pairs,COMPILE_DEFINITIONS>)
target_compile_options(fuzz_sweep_and_prune PRIVATE -O2 -g -fsanitize=fuzzer,address,undefined
                                                    -fno-sanitize-recover=all)
target_link_libraries(fuzz_sweep_and_prune PRIVATE Eigen3::Eigen Threads::Threads
                                                   -fsanitize=fuzzer,address,undefined)
collision_pairs_warnings(fuzz_sweep_and_prune)
