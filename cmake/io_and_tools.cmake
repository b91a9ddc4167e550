# What both the node and the tools read, and the tools: a page each.
add_library(collision_pairs_io SHARED
  src/io/joint_states_csv.cpp
  src/io/mesh_loader.cpp
  src/io/text_files.cpp
)
target_include_directories(collision_pairs_io PUBLIC ${PROJECT_SOURCE_DIR}/src/io
                                              PRIVATE ${PROJECT_SOURCE_DIR}/src/core)
target_include_directories(collision_pairs_io SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(collision_pairs_io PUBLIC collision_pairs PRIVATE ${catkin_LIBRARIES})
collision_pairs_warnings(collision_pairs_io)

function(collision_pairs_tool name)
  add_executable(${name} src/tools/${name}.cpp src/tools/tool_errors.cpp)
  target_link_libraries(${name} PRIVATE collision_pairs_io CLI11::CLI11)
  collision_pairs_warnings(${name})
endfunction()

collision_pairs_tool(check_states)
