# Programs that measure the narrow phase. Their short versions are held by the tests.
if(COLLISION_PAIRS_BENCHMARKS)
  add_executable(accuracy_table test/benchmark/accuracy_table.cpp)
  target_link_libraries(accuracy_table PRIVATE collision_pairs)
  target_include_directories(accuracy_table PRIVATE test)
  collision_pairs_warnings(accuracy_table)
endif()
