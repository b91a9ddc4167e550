# One executable a module: test/test_<module>.cpp.
enable_testing()
find_package(GTest REQUIRED)

function(collision_pairs_test name)
  add_executable(test_${name} test/test_${name}.cpp)
  target_link_libraries(test_${name} PRIVATE collision_pairs ${ARGN} GTest::gtest GTest::gmock
                                             GTest::gtest_main)
  target_include_directories(test_${name} PRIVATE src/core test)
  collision_pairs_warnings(test_${name})
  add_test(NAME ${name} COMMAND test_${name})
endfunction()

collision_pairs_test(aabb)
collision_pairs_test(sweep_allocations)
collision_pairs_test(sweep_and_prune)
collision_pairs_test(sweep_exactness)
collision_pairs_test(sweep_kernel)
