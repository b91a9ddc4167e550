# Benchmarks and the peers they compare with; the default build needs none of these.
# Debian: libbenchmark-dev libcgal-dev libbullet-dev.
find_package(benchmark REQUIRED)
find_package(CGAL REQUIRED)
find_package(Bullet REQUIRED)

# A library of its own: CGAL asks for -frounding-math, which must not slow the others.
add_library(broad_phase_references STATIC test/plain_direct_sap.cpp
                                          test/benchmark/packed_brute_force.cpp)
target_include_directories(broad_phase_references PUBLIC test ${CORE_MODULES})
target_link_libraries(broad_phase_references PUBLIC collision_pairs)
collision_pairs_warnings(broad_phase_references)

add_executable(broad_phase_benchmark
  test/benchmark/broad_phase_benchmark.cpp
  test/benchmark/broad_phase_peers.cpp
  test/benchmark/broad_phase_scenes.cpp
)
target_include_directories(broad_phase_benchmark SYSTEM PRIVATE ${BULLET_INCLUDE_DIRS})
target_link_libraries(broad_phase_benchmark PRIVATE broad_phase_references benchmark::benchmark
                                                    CGAL::CGAL fcl BulletCollision LinearMath)
collision_pairs_warnings(broad_phase_benchmark)

# As few boxes as a robot has; scripts/benchmark_broad_phase --few makes a table.
add_executable(few_boxes test/benchmark/benchmark_robots.cpp test/benchmark/broad_phase_scenes.cpp
  test/benchmark/few_boxes.cpp test/benchmark/rank_sort.cpp)
target_link_libraries(few_boxes PRIVATE collision_pairs_io)
target_include_directories(few_boxes PRIVATE ${CORE_MODULES})
collision_pairs_warnings(few_boxes)

# Programs that measure the narrow phase. Their short versions are held by the tests.
foreach(program accuracy_cylinders accuracy_table accuracy_scale accuracy_solids yes_or_no)
  add_executable(${program} test/benchmark/${program}.cpp)
  target_link_libraries(${program} PRIVATE collision_pairs)
  target_include_directories(${program} PRIVATE test)
  collision_pairs_warnings(${program})
endforeach()
target_link_libraries(yes_or_no PRIVATE fcl)

# The narrow phases of this package and of FCL; scripts/measure_native_and_fcl writes the page.
add_executable(native_and_fcl test/benchmark/native_and_fcl.cpp test/benchmark/plain_fcl.cpp)
target_link_libraries(native_and_fcl PRIVATE collision_pairs fcl)
target_include_directories(native_and_fcl PRIVATE ${CORE_MODULES} test)
collision_pairs_warnings(native_and_fcl)

# The whole check, beside a loop like MoveIt's.
add_executable(detector_benchmark test/benchmark/benchmark_robots.cpp
  test/benchmark/detector_benchmark.cpp test/benchmark/moveit_loop.cpp)
target_link_libraries(detector_benchmark PRIVATE collision_pairs_io fcl benchmark::benchmark)
target_include_directories(detector_benchmark PRIVATE ${CORE_MODULES})
collision_pairs_warnings(detector_benchmark)

# The node's services, beside an empty one; started by scripts/measure_service.
add_executable(service_benchmark test/benchmark/service_benchmark.cpp)
target_link_libraries(service_benchmark PRIVATE collision_pairs_ros)
collision_pairs_warnings(service_benchmark)

# What a cheaper geometry and a time budget cost and save; scripts/measure_trade_off draws it.
add_executable(trade_off test/benchmark/benchmark_robots.cpp test/benchmark/demo_motion.cpp
  test/benchmark/trade_off.cpp)
target_link_libraries(trade_off PRIVATE collision_pairs_io)
target_include_directories(trade_off PRIVATE ${CORE_MODULES})
target_compile_definitions(trade_off PRIVATE PROJECT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
collision_pairs_warnings(trade_off)

# What a scene costs that models more or less; scripts/measure_scene_cost writes docs/scenes.md.
add_executable(scene_cost test/benchmark/benchmark_robots.cpp test/benchmark/scene_cases.cpp
  test/benchmark/scene_cost.cpp)
target_link_libraries(scene_cost PRIVATE collision_pairs_io)
target_include_directories(scene_cost PRIVATE ${CORE_MODULES})
collision_pairs_warnings(scene_cost)
add_executable(update_benchmark test/benchmark/update_benchmark.cpp)
target_link_libraries(update_benchmark PRIVATE collision_pairs_ros)
collision_pairs_warnings(update_benchmark)

# Certified motions beside loops over checks; scripts/measure_motions writes docs/motions.md.
add_executable(motion_benchmark test/benchmark/benchmark_robots.cpp test/benchmark/demo_motion.cpp
  test/benchmark/motion_benchmark.cpp test/benchmark/motion_scenes.cpp)
target_link_libraries(motion_benchmark PRIVATE collision_pairs_io)
target_include_directories(motion_benchmark PRIVATE ${CORE_MODULES} test)
target_compile_definitions(motion_benchmark PRIVATE PROJECT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
collision_pairs_warnings(motion_benchmark)

# What scripts/benchmark_python compares the Python module with.
add_executable(batch_benchmark test/benchmark/batch_benchmark.cpp)
target_link_libraries(batch_benchmark PRIVATE collision_pairs_io)
collision_pairs_warnings(batch_benchmark)

# The batch stage beside the exact check; scripts/measure_verdicts writes docs/batch.md.
add_executable(verdict_benchmark test/benchmark/benchmark_robots.cpp test/benchmark/demo_motion.cpp
  test/benchmark/verdict_benchmark.cpp)
target_link_libraries(verdict_benchmark PRIVATE collision_pairs_io)
target_include_directories(verdict_benchmark PRIVATE ${CORE_MODULES})
target_compile_definitions(verdict_benchmark PRIVATE PROJECT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
collision_pairs_warnings(verdict_benchmark)

# Clouds of points, beside FCL's OcTree; scripts/measure_clouds writes docs/clouds.md.
# Debian: liboctomap-dev.
find_package(octomap REQUIRED)
add_executable(cloud_benchmark test/benchmark/benchmark_robots.cpp test/benchmark/cloud_benchmark.cpp
  test/benchmark/cloud_scenes.cpp test/benchmark/moveit_loop.cpp)
target_link_libraries(cloud_benchmark PRIVATE collision_pairs_io fcl ${OCTOMAP_LIBRARIES})
target_include_directories(cloud_benchmark PRIVATE ${CORE_MODULES})
collision_pairs_warnings(cloud_benchmark)
