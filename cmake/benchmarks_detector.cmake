# The whole check. Debian: libbenchmark-dev.
find_package(benchmark REQUIRED)

add_executable(detector_benchmark test/benchmark/benchmark_robots.cpp
  test/benchmark/detector_benchmark.cpp test/benchmark/moveit_loop.cpp)
target_link_libraries(detector_benchmark PRIVATE collision_pairs_io fcl benchmark::benchmark)
target_include_directories(detector_benchmark PRIVATE src/core)
collision_pairs_warnings(detector_benchmark)
