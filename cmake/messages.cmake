add_message_files(FILES CollisionPair.msg CollisionPairs.msg ContactPoint.msg RobotDescription.msg
                  Scene.msg SceneChange.msg SceneObject.msg SpeedLimit.msg)
add_service_files(FILES CheckCollisions.srv CheckTrajectory.srv UpdateScene.srv)
# The package has an __init__.py of its own (python.cmake): none is generated for installation.
set(${PROJECT_NAME}_CATKIN_PYTHON_SETUP_HAS_PACKAGE_INIT TRUE)
generate_messages(DEPENDENCIES geometry_msgs sensor_msgs shape_msgs std_msgs trajectory_msgs)
generate_dynamic_reconfigure_options(cfg/CollisionPairs.cfg)

catkin_package(
  INCLUDE_DIRS include
  LIBRARIES collision_pairs collision_pairs_io
  CATKIN_DEPENDS dynamic_reconfigure geometry_msgs message_runtime roscpp sensor_msgs shape_msgs
                 std_msgs std_srvs trajectory_msgs visualization_msgs
  DEPENDS EIGEN3
  CFG_EXTRAS collision_pairs-extras.cmake)
