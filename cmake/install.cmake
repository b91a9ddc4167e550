# Everything finds its libraries beside itself, without LD_LIBRARY_PATH.
file(RELATIVE_PATH libraries /${CATKIN_PACKAGE_BIN_DESTINATION} /${CATKIN_PACKAGE_LIB_DESTINATION})
set_target_properties(collision_pairs collision_pairs_io PROPERTIES
  INSTALL_RPATH $ORIGIN INSTALL_RPATH_USE_LINK_PATH ON)
set_target_properties(${programs} PROPERTIES
  INSTALL_RPATH $ORIGIN/${libraries} INSTALL_RPATH_USE_LINK_PATH ON)

set_target_properties(collision_pairs PROPERTIES EXPORT_NAME core)
set_target_properties(collision_pairs_io PROPERTIES EXPORT_NAME io)
install(TARGETS collision_pairs collision_pairs_io EXPORT collision_pairsTargets
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(EXPORT collision_pairsTargets NAMESPACE collision_pairs::
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/cmake)
export(EXPORT collision_pairsTargets NAMESPACE collision_pairs::
  FILE ${PROJECT_BINARY_DIR}/collision_pairsTargets.cmake)  # for the devel space
install(TARGETS ${programs}
  RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY include/collision_pairs/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
install(DIRECTORY launch config DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}
  PATTERN "make_*" EXCLUDE)  # programs that made the files beside them
catkin_install_python(PROGRAMS scripts/drive_demo_robot scripts/drive_steps scripts/move_demo_robot
                      scripts/plot_bag_report scripts/plot_stopping scripts/print_bag_robot
                      scripts/print_collision_pairs scripts/replay_bag
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
