# The collision detector "CollisionPairs" of MoveIt 1, where MoveIt is installed. pluginlib finds it by package.xml, and
# Debian's pluginlib 5 by the ament index.
install(FILES moveit_plugin.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
find_package(moveit_core QUIET)
if(NOT moveit_core_FOUND)
  return()
endif()
add_library(collision_pairs_moveit SHARED
  src/planners/moveit/moveit_check.cpp
  src/planners/moveit/moveit_collision_env.cpp
  src/planners/moveit/moveit_motion.cpp
  src/planners/moveit/moveit_plugin.cpp
  src/planners/moveit/moveit_scene.cpp
  src/planners/moveit/moveit_shapes.cpp
)
target_include_directories(collision_pairs_moveit PRIVATE src/planners/moveit src/messages)
target_include_directories(collision_pairs_moveit SYSTEM PRIVATE ${catkin_INCLUDE_DIRS} ${moveit_core_INCLUDE_DIRS})
target_link_libraries(collision_pairs_moveit PRIVATE collision_pairs ${catkin_LIBRARIES} ${moveit_core_LIBRARIES})
set_target_properties(collision_pairs_moveit PROPERTIES INSTALL_RPATH $ORIGIN INSTALL_RPATH_USE_LINK_PATH ON)
collision_pairs_warnings(collision_pairs_moveit)
install(TARGETS collision_pairs_moveit LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})

set(index ${PROJECT_BINARY_DIR}/ament_index)
file(WRITE ${index}/package "")
file(WRITE ${index}/plugin "${CATKIN_PACKAGE_SHARE_DESTINATION}/moveit_plugin.xml\n")
set(installed_index ${CATKIN_GLOBAL_SHARE_DESTINATION}/ament_index/resource_index)
install(FILES ${index}/package DESTINATION ${installed_index}/packages RENAME ${PROJECT_NAME})
install(FILES ${index}/plugin DESTINATION ${installed_index}/moveit_core__pluginlib__plugin RENAME ${PROJECT_NAME})
