# The core: URDF and poses in, pairs out. Links no ROS library (test_core_links_no_ros holds it so).
add_library(collision_pairs SHARED
  src/core/aabb.cpp
  src/core/column_sweep.cpp
  src/core/narrow_phase.cpp
  src/core/pair_filter.cpp
  src/core/pair_sort.cpp
  src/core/shape.cpp
  src/core/static_boxes.cpp
  src/core/static_tree.cpp
  src/core/sweep_and_prune.cpp
  src/core/sweep_axis.cpp
  src/core/sweep_grid.cpp
  src/core/sweep_kernel.cpp
  src/core/sweep_record.cpp
)
include(cmake/sweep_kernels.cmake)
target_include_directories(collision_pairs PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>
  PRIVATE ${PROJECT_SOURCE_DIR}/src/core)
target_link_libraries(collision_pairs PUBLIC Eigen3::Eigen PRIVATE fcl Threads::Threads)
collision_pairs_warnings(collision_pairs)
