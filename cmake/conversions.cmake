# A report as ROS messages: pure functions that node and tools share.
add_library(collision_pairs_messages STATIC
  src/messages/conversions.cpp
  src/messages/geometry_conversions.cpp
  src/messages/markers.cpp
  src/messages/object_conversions.cpp
  src/messages/point_cloud.cpp
  src/messages/scene_markers.cpp
  src/messages/trajectory_command.cpp
)
target_include_directories(collision_pairs_messages PUBLIC ${PROJECT_SOURCE_DIR}/src/messages
                                                    PRIVATE ${CORE_MODULES})
target_include_directories(collision_pairs_messages SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(collision_pairs_messages PUBLIC collision_pairs ${catkin_LIBRARIES})
set_target_properties(collision_pairs_messages PROPERTIES POSITION_INDEPENDENT_CODE ON)  # for the nodelet
collision_pairs_together(collision_pairs_messages)
collision_pairs_warnings(collision_pairs_messages)
collision_pairs_checked_indices(collision_pairs_messages)
add_dependencies(collision_pairs_messages ${PROJECT_NAME}_generate_messages_cpp
                 ${catkin_EXPORTED_TARGETS})
