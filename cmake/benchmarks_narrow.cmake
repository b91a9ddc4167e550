# Programs that measure the narrow phase. Their short versions are held by the tests.
if(COLLISION_PAIRS_BENCHMARKS)
  foreach(program accuracy_table accuracy_scale)
    add_executable(${program} test/benchmark/${program}.cpp)
    target_link_libraries(${program} PRIVATE collision_pairs)
    target_include_directories(${program} PRIVATE test)
    collision_pairs_warnings(${program})
  endforeach()
endif()
