# Benchmarks and the peers they compare with; the default build needs none of these.
# Debian: libbenchmark-dev libcgal-dev libbullet-dev.
find_package(benchmark REQUIRED)
find_package(CGAL REQUIRED)
find_package(Bullet REQUIRED)

# A library of its own: CGAL asks for -frounding-math, which must not slow the others.
add_library(broad_phase_references STATIC test/plain_direct_sap.cpp
                                          test/benchmark/packed_brute_force.cpp)
target_include_directories(broad_phase_references PUBLIC test)
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
