# What both the node and the tools read, and the tools: a page each.
add_library(collision_pairs_io SHARED
  src/io/bag_index.cpp
  src/io/bag_records.cpp
  src/io/bag_table.cpp
  src/io/bag_table_merge.cpp
  src/io/cloud_config.cpp
  src/io/cloud_gatherer.cpp
  src/io/cloud_view.cpp
  src/io/csv.cpp
  src/io/joint_limits.cpp
  src/io/joint_states_csv.cpp
  src/io/joint_transforms.cpp
  src/io/message_layout.cpp
  src/io/meshes/mesh_loader.cpp
  src/io/meshes/mesh_process.cpp
  src/io/meshes/obj_file.cpp
  src/io/meshes/stl_file.cpp
  src/io/pcd_file.cpp
  src/io/robot_frames.cpp
  src/io/scene_config.cpp
  src/io/scene_sources.cpp
  src/io/text_files.cpp
  src/io/yaml_values.cpp
  src/transforms/robot_poses.cpp
  src/transforms/stamps.cpp
  src/transforms/transform_buffer.cpp
  src/transforms/transform_gate.cpp
  src/transforms/transform_samples.cpp
)
target_include_directories(collision_pairs_io
  PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src/io>
         $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src/io/meshes>
         $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src/transforms>
  PRIVATE ${CORE_MODULES})
target_include_directories(collision_pairs_io SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(collision_pairs_io PUBLIC collision_pairs $<BUILD_INTERFACE:yaml-cpp>
                      PRIVATE ${catkin_LIBRARIES} BZip2::BZip2 ${ROSLZ4_LIBRARY} ${TINYXML2_LIBRARIES} ${CMAKE_DL_LIBS})
file(RELATIVE_PATH programs_from_libraries /${CATKIN_PACKAGE_LIB_DESTINATION} /${CATKIN_PACKAGE_BIN_DESTINATION})
target_compile_definitions(collision_pairs_io PRIVATE PROGRAMS_FROM_LIBRARIES="${programs_from_libraries}")
collision_pairs_together(collision_pairs_io)
collision_pairs_warnings(collision_pairs_io)
collision_pairs_checked_indices(collision_pairs_io)

# Meshes that are neither STL nor OBJ: src/io/meshes/mesh_process.h.
add_executable(read_mesh_file src/io/meshes/read_mesh_file.cpp)
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

# Further source files of the tool may follow its name.
function(collision_pairs_tool name)
  add_executable(${name} src/tools/${name}.cpp src/tools/command_line.cpp src/tools/progress_bar.cpp ${ARGN})
  target_include_directories(${name} PRIVATE src/core/base)
  target_link_libraries(${name} PRIVATE collision_pairs_io Boost::program_options)
  collision_pairs_together(${name})
  collision_pairs_warnings(${name})
  collision_pairs_checked_indices(${name})
endfunction()

collision_pairs_tool(check_states src/tools/scene_files.cpp)
collision_pairs_tool(check_bag src/tools/bag_checker.cpp src/tools/bag_recorder.cpp src/tools/bag_replay.cpp src/tools/recorded_scenes.cpp src/tools/scene_files.cpp src/tools/bag_outputs.cpp src/tools/plot_script.cpp)
target_link_libraries(check_bag PRIVATE collision_pairs_monitor)
collision_pairs_tool(check_motion src/tools/scene_files.cpp)
collision_pairs_tool(generate_srdf src/tools/pair_verdicts.cpp src/tools/scene_files.cpp)
target_include_directories(generate_srdf PRIVATE ${CORE_MODULES})
collision_pairs_tool(measure_stopping src/tools/plot_script.cpp src/tools/stopping_analysis.cpp src/tools/stopping_steps.cpp)
target_link_libraries(measure_stopping PRIVATE collision_pairs_messages)
collision_pairs_tool(merge_bag_checks src/tools/bag_outputs.cpp src/tools/plot_script.cpp)
