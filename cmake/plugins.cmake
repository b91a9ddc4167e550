# Libraries that processes of other packages load by pluginlib. It finds them by package.xml, and Debian's pluginlib 5 by
# the ament index, once any package has put a plugin of the same kind there.
set(index ${PROJECT_BINARY_DIR}/ament_index)
set(installed_index ${CATKIN_GLOBAL_SHARE_DESTINATION}/ament_index/resource_index)
file(WRITE ${index}/package "")
install(FILES moveit_plugin.xml nodelet_plugin.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(FILES ${index}/package DESTINATION ${installed_index}/packages RENAME ${PROJECT_NAME})

# NAME_plugin.xml describes what the library collision_pairs_NAME has for the package.
function(collision_pairs_plugin name package)
  set(library collision_pairs_${name})
  set_target_properties(${library} PROPERTIES INSTALL_RPATH $ORIGIN INSTALL_RPATH_USE_LINK_PATH ON)
  collision_pairs_together(${library})
  collision_pairs_warnings(${library})
  collision_pairs_checked_indices(${library})
  install(TARGETS ${library} LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
  file(WRITE ${index}/${name} "${CATKIN_PACKAGE_SHARE_DESTINATION}/${name}_plugin.xml\n")
  install(FILES ${index}/${name} DESTINATION ${installed_index}/${package}__pluginlib__plugin RENAME ${PROJECT_NAME})
endfunction()

# The node as a nodelet.
add_library(collision_pairs_nodelet SHARED src/ros/node/collision_pairs_nodelet.cpp)
target_link_libraries(collision_pairs_nodelet PRIVATE collision_pairs_ros)
collision_pairs_plugin(nodelet nodelet)

# The collision detector "CollisionPairs" of MoveIt 1, where MoveIt is installed.
find_package(moveit_core QUIET)
if(moveit_core_FOUND)
  add_library(collision_pairs_moveit SHARED
    src/planners/moveit/moveit_check.cpp
    src/planners/moveit/moveit_collision_env.cpp
    src/planners/moveit/moveit_limits.cpp
    src/planners/moveit/moveit_motion.cpp
    src/planners/moveit/moveit_octree.cpp
    src/planners/moveit/moveit_plugin.cpp
    src/planners/moveit/moveit_scene.cpp
    src/planners/moveit/moveit_shapes.cpp
  )
  target_include_directories(collision_pairs_moveit PRIVATE src/planners/moveit src/messages)
  target_include_directories(collision_pairs_moveit SYSTEM PRIVATE ${catkin_INCLUDE_DIRS} ${moveit_core_INCLUDE_DIRS})
  target_link_libraries(collision_pairs_moveit PRIVATE collision_pairs ${catkin_LIBRARIES} ${moveit_core_LIBRARIES})
  collision_pairs_plugin(moveit moveit_core)
endif()
