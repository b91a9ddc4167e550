# The core: URDF and poses in, pairs out. Links no ROS library (test_architecture holds it so).
add_library(collision_pairs SHARED
  src/core/aabb.cpp
  src/core/batch_check.cpp
  src/core/box_gap.cpp
  src/core/closed_forms.cpp
  src/core/closest_on_mesh.cpp
  src/core/collision_detector.cpp
  src/core/collision_report.cpp
  src/core/collision_scene.cpp
  src/core/column_sweep.cpp
  src/core/contact_probability.cpp
  src/core/contact_search.cpp
  src/core/convex_distance.cpp
  src/core/convex_hull.cpp
  src/core/enclosure.cpp
  src/core/fcl_backend.cpp
  src/core/found_pairs.cpp
  src/core/furthest_point.cpp
  src/core/generated_srdf.cpp
  src/core/hull_bounds.cpp
  src/core/in_parallel.cpp
  src/core/joint_sampler.cpp
  src/core/link_group.cpp
  src/core/mesh_bounds.cpp
  src/core/mesh_insides.cpp
  src/core/mesh_query.cpp
  src/core/mesh_solid.cpp
  src/core/narrow_phase.cpp
  src/core/nearest_name.cpp
  src/core/number_text.cpp
  src/core/pair_class.cpp
  src/core/pair_filter.cpp
  src/core/pair_ladder.cpp
  src/core/pair_policy.cpp
  src/core/pair_probe.cpp
  src/core/pair_rules.cpp
  src/core/pair_sort.cpp
  src/core/pair_statistics.cpp
  src/core/patch_hulls.cpp
  src/core/prepared_shape.cpp
  src/core/replay.cpp
  src/core/robot_model.cpp
  src/core/scene_description.cpp
  src/core/scene_element.cpp
  src/core/scene_members.cpp
  src/core/settings_check.cpp
  src/core/shape.cpp
  src/core/slab_bounds.cpp
  src/core/solid_angle.cpp
  src/core/srdf.cpp
  src/core/static_boxes.cpp
  src/core/static_tree.cpp
  src/core/surface_contact.cpp
  src/core/sweep_and_prune.cpp
  src/core/sweep_axis.cpp
  src/core/sweep_grid.cpp
  src/core/sweep_kernel.cpp
  src/core/sweep_record.cpp
  src/core/timed_climb.cpp
  src/core/triangle_distance.cpp
  src/core/triangle_tree.cpp
  src/core/urdf_checks.cpp
  src/core/urdf_reader.cpp
  src/core/vertex_extent.cpp
  src/core/winding_number.cpp
  src/core/xml_file.cpp
)
include(cmake/kernels.cmake)
target_include_directories(collision_pairs PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>
  PRIVATE ${PROJECT_SOURCE_DIR}/src/core)
target_link_libraries(collision_pairs PUBLIC Eigen3::Eigen PRIVATE
  Boost::headers fcl ${URDFDOM_LIBRARIES} tinyxml2::tinyxml2 qhull_r Threads::Threads)
collision_pairs_warnings(collision_pairs)
