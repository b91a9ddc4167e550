# Benchmarks and the peers they compare with; the default build needs none of these.
# Debian: libbenchmark-dev libcgal-dev libbullet-dev.
find_package(benchmark REQUIRED)
find_package(CGAL REQUIRED)
find_package(Bullet REQUIRED)

# A program of benchmark/: of the file of its name and SOURCES, with LIBRARIES.
function(collision_pairs_benchmark name)
  cmake_parse_arguments(PARSE_ARGV 1 its "" "" "SOURCES;LIBRARIES")
  list(TRANSFORM its_SOURCES REPLACE "(.+)" "benchmark/\\1.cpp")
  add_executable(${name} benchmark/${name}.cpp ${its_SOURCES})
  target_link_libraries(${name} PRIVATE ${its_LIBRARIES})
  target_include_directories(${name} PRIVATE ${CORE_MODULES} . test)
  target_compile_definitions(${name} PRIVATE PROJECT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  collision_pairs_warnings(${name})
endfunction()

# A library of its own: CGAL asks for -frounding-math, which must not slow the others.
add_library(broad_phase_references STATIC benchmark/plain_direct_sap.cpp
                                          benchmark/packed_brute_force.cpp)
target_include_directories(broad_phase_references PUBLIC . test ${CORE_MODULES})
target_link_libraries(broad_phase_references PUBLIC collision_pairs)
collision_pairs_warnings(broad_phase_references)

collision_pairs_benchmark(broad_phase_benchmark SOURCES broad_phase_peers broad_phase_scenes
  LIBRARIES broad_phase_references benchmark::benchmark CGAL::CGAL fcl BulletCollision LinearMath)
target_include_directories(broad_phase_benchmark SYSTEM PRIVATE ${BULLET_INCLUDE_DIRS})

# As few boxes as a robot has; scripts/benchmark_broad_phase --few makes a table.
collision_pairs_benchmark(few_boxes SOURCES benchmark_robots broad_phase_scenes rank_sort
  LIBRARIES collision_pairs_io)

# Programs that measure the narrow phase. Their short versions are held by the tests.
foreach(program accuracy_cylinders accuracy_ratio accuracy_table accuracy_solids)
  collision_pairs_benchmark(${program} LIBRARIES collision_pairs)
endforeach()
collision_pairs_benchmark(yes_or_no LIBRARIES collision_pairs fcl)

# The narrow phases of this package and of FCL; scripts/measure_native_and_fcl writes docs/trade_off.md.
collision_pairs_benchmark(native_and_fcl SOURCES plain_fcl LIBRARIES collision_pairs fcl)

# The whole check, beside a loop like MoveIt's.
collision_pairs_benchmark(detector_benchmark SOURCES benchmark_robots moveit_loop
  LIBRARIES collision_pairs_io fcl benchmark::benchmark)

# The node's services, beside an empty one; started by scripts/measure_service.
collision_pairs_benchmark(service_benchmark LIBRARIES collision_pairs_ros)

# What a cheaper geometry and a time budget cost and save; scripts/measure_trade_off draws it.
collision_pairs_benchmark(trade_off SOURCES benchmark_robots demo_motion
  LIBRARIES collision_pairs_io)

# What a scene costs that models more or less; scripts/measure_scene_cost writes docs/scenes.md.
collision_pairs_benchmark(scene_cost SOURCES benchmark_robots scene_cases
  LIBRARIES collision_pairs_io)
collision_pairs_benchmark(update_benchmark LIBRARIES collision_pairs_ros)

# Certified motions beside loops over checks; scripts/measure_motions writes docs/motions.md.
collision_pairs_benchmark(motion_benchmark SOURCES benchmark_robots demo_motion motion_scenes
  LIBRARIES collision_pairs_io)

# The velocity limiter beside MoveIt Servo's formula; scripts/measure_limiter writes docs/limiter.md.
set(limiter_simulation benchmark_robots demo_motion limiter_commands limiter_drives limiter_judge limiter_simulation
  motion_scenes simulated_joints simulated_limiters)
list(TRANSFORM limiter_simulation REPLACE "(.+)" "benchmark/\\1.cpp")
collision_pairs_benchmark(limiter_benchmark LIBRARIES collision_pairs_io)
target_sources(limiter_benchmark PRIVATE ${limiter_simulation})

# What scripts/benchmark_python compares the Python module with.
collision_pairs_benchmark(batch_benchmark LIBRARIES collision_pairs_io)

# The batch stage beside the exact check; scripts/measure_verdicts writes docs/many_states.md.
collision_pairs_benchmark(verdict_benchmark SOURCES benchmark_robots demo_motion
  LIBRARIES collision_pairs_io)

# Clouds of points, beside FCL's OcTree; scripts/measure_clouds writes docs/clouds.md.
# Debian: liboctomap-dev.
find_package(octomap REQUIRED)
collision_pairs_benchmark(cloud_benchmark SOURCES benchmark_robots cloud_scenes demo_motion moveit_loop
  LIBRARIES collision_pairs_io fcl ${OCTOMAP_LIBRARIES})

# The node in a camera's process or beside it, for cloud_latency.py.
collision_pairs_benchmark(cloud_driver LIBRARIES ${catkin_LIBRARIES})
target_include_directories(cloud_driver SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})

# OMPL's planners with certified edges, sampled edges and a loop like MoveIt's; scripts/measure_planning
# writes docs/planners.md.
if(ompl_FOUND)
  collision_pairs_benchmark(planning_benchmark SOURCES benchmark_robots moveit_loop planning_problems
    LIBRARIES collision_pairs_io fcl ${OMPL_LIBRARIES})
  target_include_directories(planning_benchmark SYSTEM PRIVATE ${OMPL_INCLUDE_DIRS})
endif()
