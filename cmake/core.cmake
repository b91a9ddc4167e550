# The core: URDF and poses in, pairs out. Links no ROS library (test_architecture holds it so).
# Its modules; the dependency rules stand in test_architecture.
set(core_modules base geometry broad_phase convex_pairs mesh_solid mesh_surface narrow_phase spheres robot scene clouds
  pair_query check batch_model batch motion derivatives limiter pair_statistics)
list(TRANSFORM core_modules PREPEND ${PROJECT_SOURCE_DIR}/src/core/ OUTPUT_VARIABLE CORE_MODULES)

add_library(collision_pairs SHARED
  src/core/base/in_parallel.cpp
  src/core/base/input_error.cpp
  src/core/base/pair_filter.cpp
  src/core/base/user_text.cpp
  src/core/batch/batch_check.cpp
  src/core/batch_model/batch_kernel.cpp
  src/core/batch_model/batch_model.cpp
  src/core/batch/batch_stage.cpp
  src/core/batch/edge_group.cpp
  src/core/batch/open_pairs.cpp
  src/core/batch_model/pair_table.cpp
  src/core/batch_model/solid_field.cpp
  src/core/batch_model/solid_pairs.cpp
  src/core/batch_model/static_field.cpp
  src/core/broad_phase/box_pairs.cpp
  src/core/broad_phase/column_sweep.cpp
  src/core/broad_phase/packed_records.cpp
  src/core/broad_phase/static_tree.cpp
  src/core/broad_phase/sweep_and_prune.cpp
  src/core/broad_phase/sweep_grid.cpp
  src/core/broad_phase/sweep_kernel.cpp
  src/core/check/check_input.cpp
  src/core/check/cloud_pairs.cpp
  src/core/check/collision_detector.cpp
  src/core/check/element_boxes.cpp
  src/core/check/found_pairs.cpp
  src/core/check/ignored_pairs.cpp
  src/core/check/minimum_search.cpp
  src/core/clouds/cells_about_link.cpp
  src/core/clouds/depth_map.cpp
  src/core/clouds/near_parts.cpp
  src/core/clouds/occluded_obstacles.cpp
  src/core/clouds/occupied_voxels.cpp
  src/core/clouds/self_filter.cpp
  src/core/clouds/voxel_grid.cpp
  src/core/convex_pairs/closed_forms.cpp
  src/core/convex_pairs/convex_distance.cpp
  src/core/derivatives/closing_motion.cpp
  src/core/derivatives/distance_gradient.cpp
  src/core/geometry/aabb.cpp
  src/core/geometry/box_gap.cpp
  src/core/geometry/convex_hull.cpp
  src/core/geometry/geometry_kernel.cpp
  src/core/geometry/packed_points.cpp
  src/core/geometry/shape.cpp
  src/core/limiter/certified_surroundings.cpp
  src/core/limiter/command_outlet.cpp
  src/core/limiter/limiter_clock.cpp
  src/core/limiter/limiter_law.cpp
  src/core/limiter/prepared_surroundings.cpp
  src/core/limiter/response_watch.cpp
  src/core/limiter/stopping_tube.cpp
  src/core/mesh_solid/mesh_edges.cpp
  src/core/mesh_solid/mesh_solid.cpp
  src/core/mesh_solid/outer_faces.cpp
  src/core/mesh_solid/solid_angle.cpp
  src/core/mesh_solid/winding_number.cpp
  src/core/mesh_surface/mesh_query.cpp
  src/core/mesh_surface/patch_hulls.cpp
  src/core/mesh_surface/prepared_mesh.cpp
  src/core/mesh_surface/surface_contact.cpp
  src/core/mesh_surface/triangle_distance.cpp
  src/core/mesh_surface/triangle_tree.cpp
  src/core/motion/check_segments.cpp
  src/core/motion/edge_stage.cpp
  src/core/motion/exact_configuration.cpp
  src/core/motion/motion_check.cpp
  src/core/motion/motion_pairs.cpp
  src/core/motion/motion_state.cpp
  src/core/motion/pair_certifier.cpp
  src/core/motion/pair_clearances.cpp
  src/core/motion/uncertified_pairs.cpp
  src/core/narrow_phase/fcl_answer.cpp
  src/core/narrow_phase/fcl_backend.cpp
  src/core/narrow_phase/narrow_phase.cpp
  src/core/narrow_phase/plain_pairs.cpp
  src/core/narrow_phase/prepared_shape.cpp
  src/core/narrow_phase/solids.cpp
  src/core/narrow_phase/surface_query.cpp
  src/core/pair_query/anytime_query.cpp
  src/core/pair_query/pair_ladder.cpp
  src/core/pair_query/voxel_bounds.cpp
  src/core/pair_query/voxel_search.cpp
  src/core/pair_statistics/contact_search.cpp
  src/core/pair_statistics/generated_srdf.cpp
  src/core/pair_statistics/joint_sampler.cpp
  src/core/pair_statistics/pair_class.cpp
  src/core/pair_statistics/pair_probe.cpp
  src/core/pair_statistics/pair_statistics.cpp
  src/core/robot/joint_columns.cpp
  src/core/robot/link_group.cpp
  src/core/robot/robot_model.cpp
  src/core/robot/robot_parts.cpp
  src/core/robot/srdf.cpp
  src/core/robot/urdf_reader.cpp
  src/core/robot/urdfdom_parser.cpp
  src/core/robot/xml_file.cpp
  src/core/robot/xml_names.cpp
  src/core/scene/collision_scene.cpp
  src/core/scene/element_maker.cpp
  src/core/scene/mesh_bounds.cpp
  src/core/scene/pair_policy.cpp
  src/core/scene/pair_selection.cpp
  src/core/scene/scene_changes.cpp
  src/core/scene/scene_classes.cpp
  src/core/scene/scene_description.cpp
  src/core/scene/scene_element.cpp
  src/core/scene/scene_members.cpp
  src/core/scene/scene_settings.cpp
  src/core/spheres/covered_solid.cpp
  src/core/spheres/outer_spheres.cpp
  src/core/spheres/sphere_cover.cpp
  src/core/spheres/sphere_distance.cpp
)
collision_pairs_together(collision_pairs)
include(cmake/kernels.cmake)
target_include_directories(collision_pairs PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>
  PRIVATE ${CORE_MODULES})
target_include_directories(collision_pairs SYSTEM PRIVATE ${URDFDOM_INCLUDE_DIRS})  # GCC 14 warns of urdfdom 4
target_link_libraries(collision_pairs PUBLIC Eigen3::Eigen PRIVATE
  Boost::headers fcl ${TINYXML2_LIBRARIES} ${URDFDOM_MODEL_LIBRARY} ${CONSOLE_BRIDGE_LIBRARY} qhull_r Threads::Threads)
# After libqhull_r, for other users of that in the same process: libqhullcpp has a qh_fprintf(), too (convex_hull.cpp).
find_library(QHULLCPP_LIBRARY NAMES libqhullcpp.so)
if(QHULLCPP_LIBRARY)
  target_compile_definitions(collision_pairs PRIVATE COLLISION_PAIRS_QHULLCPP)
  target_link_libraries(collision_pairs PRIVATE ${QHULLCPP_LIBRARY})
endif()
collision_pairs_warnings(collision_pairs)
