# What is known at any time: without threads, clocks or roscpp.
add_library(collision_pairs_monitor STATIC
  src/monitor/cloud_source.cpp
  src/monitor/joint_query.cpp
  src/monitor/monitor.cpp
  src/monitor/scene_message.cpp
  src/monitor/scene_store.cpp
  src/monitor/scene_updates.cpp
  src/monitor/tf_poses.cpp
  src/monitor/transform_input.cpp
)
target_include_directories(collision_pairs_monitor PUBLIC ${PROJECT_SOURCE_DIR}/src/monitor
                                                   PRIVATE ${CORE_MODULES})
target_link_libraries(collision_pairs_monitor PUBLIC collision_pairs_io collision_pairs_messages)
set_target_properties(collision_pairs_monitor PROPERTIES POSITION_INDEPENDENT_CODE ON)  # for the nodelet
collision_pairs_together(collision_pairs_monitor)
collision_pairs_warnings(collision_pairs_monitor)
collision_pairs_checked_indices(collision_pairs_monitor)

# The node. Its parts are a library, so that tests can call the pure ones without a master.
add_library(collision_pairs_ros STATIC
  src/ros/input/cloud_threads.cpp
  src/ros/input/live_monitor.cpp
  src/ros/limiter/limited_command.cpp
  src/ros/limiter/limiter_inputs.cpp
  src/ros/limiter/limiter_parameters.cpp
  src/ros/limiter/velocity_limiter.cpp
  src/ros/node/collision_pairs_node.cpp
  src/ros/node/node_health.cpp
  src/ros/node/parameters.cpp
  src/ros/node/report_publisher.cpp
  src/ros/node/ros_master.cpp
  src/ros/queries/query_services.cpp
  src/ros/queries/snapshot_check.cpp
  src/ros/scene/scene_builder.cpp
  src/ros/scene/scene_loader.cpp
  src/ros/scene/scene_service.cpp
)
set(modules ros/node ros/input ros/scene ros/queries ros/limiter core/limiter)
list(TRANSFORM modules PREPEND ${PROJECT_SOURCE_DIR}/src/ OUTPUT_VARIABLE ROS_MODULES)
target_include_directories(collision_pairs_ros PUBLIC ${ROS_MODULES} PRIVATE ${CORE_MODULES})
target_include_directories(collision_pairs_ros SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(collision_pairs_ros PUBLIC collision_pairs_monitor ${catkin_LIBRARIES})
set_target_properties(collision_pairs_ros PROPERTIES POSITION_INDEPENDENT_CODE ON)  # for the nodelet
collision_pairs_together(collision_pairs_ros)
collision_pairs_warnings(collision_pairs_ros)
collision_pairs_checked_indices(collision_pairs_ros)
add_dependencies(collision_pairs_ros ${PROJECT_NAME}_gencfg ${PROJECT_NAME}_generate_messages_cpp
                 ${catkin_EXPORTED_TARGETS})

add_executable(collision_pairs_node src/ros/node/main.cpp)
target_link_libraries(collision_pairs_node PRIVATE collision_pairs_ros)
collision_pairs_warnings(collision_pairs_node)
collision_pairs_checked_indices(collision_pairs_node)

# Stops the robot beside the controller when the limiter does not.
add_executable(limited_command_guard src/ros/limiter/limited_command_guard.cpp)
target_link_libraries(limited_command_guard PRIVATE collision_pairs_ros)
collision_pairs_warnings(limited_command_guard)
collision_pairs_checked_indices(limited_command_guard)

# The camera of the demo, of tests and of measurements.
add_executable(simulate_depth_camera src/demo/depth_image.cpp src/demo/simulate_depth_camera.cpp)
target_link_libraries(simulate_depth_camera PRIVATE collision_pairs_ros)
collision_pairs_warnings(simulate_depth_camera)
collision_pairs_checked_indices(simulate_depth_camera)
