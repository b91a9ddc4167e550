# What both the node and the tools read, and the tools: a page each.
add_library(collision_pairs_io SHARED
  src/io/bags/bag_index.cpp
  src/io/bags/bag_records.cpp
  src/io/bags/bag_table.cpp
  src/io/bags/bag_table_merge.cpp
  src/io/bags/joint_transforms.cpp
  src/io/bags/message_layout.cpp
  src/io/bags/robot_frames.cpp
  src/io/clouds/cloud_processor.cpp
  src/io/clouds/cloud_view.cpp
  src/io/config/cloud_config.cpp
  src/io/config/joint_limits.cpp
  src/io/config/scene_config.cpp
  src/io/config/scene_sources.cpp
  src/io/config/yaml_values.cpp
  src/io/meshes/collada_names.cpp
  src/io/meshes/collada_numbers.cpp
  src/io/meshes/mesh_loader.cpp
  src/io/meshes/mesh_process.cpp
  src/io/meshes/obj_file.cpp
  src/io/meshes/ply_file.cpp
  src/io/meshes/polygon.cpp
  src/io/meshes/stl_file.cpp
  src/io/text/csv.cpp
  src/io/text/joint_states_csv.cpp
  src/io/text/pcd_file.cpp
  src/io/text/text_files.cpp
  src/transforms/frame_ways.cpp
  src/transforms/joint_state_positions.cpp
  src/transforms/robot_poses.cpp
  src/transforms/stamps.cpp
  src/transforms/standing_joints.cpp
  src/transforms/transform_buffer.cpp
  src/transforms/transform_gate.cpp
  src/transforms/transform_samples.cpp
)
foreach(module io/bags io/clouds io/config io/meshes io/text transforms)
  target_include_directories(collision_pairs_io PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src/${module}>)
endforeach()
target_include_directories(collision_pairs_io PRIVATE ${CORE_MODULES})
target_include_directories(collision_pairs_io SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(collision_pairs_io PUBLIC collision_pairs $<BUILD_INTERFACE:yaml-cpp>
                      PRIVATE ${catkin_LIBRARIES} BZip2::BZip2 ${ROSLZ4_LIBRARY} ${TINYXML2_LIBRARIES} ${CMAKE_DL_LIBS})
file(RELATIVE_PATH programs_from_libraries /${CATKIN_PACKAGE_LIB_DESTINATION} /${CATKIN_PACKAGE_BIN_DESTINATION})
target_compile_definitions(collision_pairs_io PRIVATE PROGRAMS_FROM_LIBRARIES="${programs_from_libraries}")
collision_pairs_together(collision_pairs_io)
collision_pairs_warnings(collision_pairs_io)
collision_pairs_checked_indices(collision_pairs_io)

# Meshes that are neither STL, OBJ nor PLY: src/io/meshes/mesh_process.h.
add_executable(read_mesh_file src/io/meshes/gltf_triangles.cpp src/io/meshes/read_mesh_file.cpp)
target_include_directories(read_mesh_file PRIVATE include)
target_include_directories(read_mesh_file SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(read_mesh_file PRIVATE ${catkin_LIBRARIES} assimp ${CONSOLE_BRIDGE_LIBRARY} Eigen3::Eigen)
if(sanitizers)  # they reserve more memory than it may have
  target_compile_options(read_mesh_file PRIVATE -fno-sanitize=all)
  target_link_options(read_mesh_file PRIVATE -fno-sanitize=all)
endif()
collision_pairs_warnings(read_mesh_file)
collision_pairs_checked_indices(read_mesh_file)
add_dependencies(collision_pairs_io read_mesh_file)

set(modules common check_bag generate_srdf measure_stopping)
list(TRANSFORM modules PREPEND ${PROJECT_SOURCE_DIR}/src/tools/ OUTPUT_VARIABLE TOOL_MODULES)

# What several tools share.
add_library(tool_parts STATIC
  src/tools/check_bag/bag_outputs.cpp
  src/tools/common/command_line.cpp
  src/tools/common/plot_script.cpp
  src/tools/common/progress_bar.cpp
  src/tools/common/scene_files.cpp
)
target_include_directories(tool_parts PUBLIC ${TOOL_MODULES} src/core/base)
target_link_libraries(tool_parts PUBLIC collision_pairs_io Boost::program_options)
collision_pairs_together(tool_parts)
collision_pairs_warnings(tool_parts)
collision_pairs_checked_indices(tool_parts)

# Source files follow its name, without src/tools and .cpp.
function(collision_pairs_tool name)
  list(TRANSFORM ARGN REPLACE "(.+)" "src/tools/\\1.cpp" OUTPUT_VARIABLE sources)
  add_executable(${name} ${sources})
  target_link_libraries(${name} PRIVATE tool_parts)
  collision_pairs_together(${name})
  collision_pairs_warnings(${name})
  collision_pairs_checked_indices(${name})
endfunction()

collision_pairs_tool(check_states check_states)
collision_pairs_tool(check_motion check_motion)
collision_pairs_tool(check_bag check_bag/check_bag check_bag/bag_checker check_bag/bag_recorder check_bag/bag_replay
                     check_bag/recorded_scenes)
target_link_libraries(check_bag PRIVATE collision_pairs_monitor)
collision_pairs_tool(merge_bag_checks check_bag/merge_bag_checks)
collision_pairs_tool(generate_srdf generate_srdf/generate_srdf generate_srdf/pair_verdicts)
target_include_directories(generate_srdf PRIVATE ${CORE_MODULES})
collision_pairs_tool(measure_stopping measure_stopping/measure_stopping measure_stopping/stopping_analysis
                     measure_stopping/stopping_steps)
target_link_libraries(measure_stopping PRIVATE collision_pairs_messages)
