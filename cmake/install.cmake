install(TARGETS collision_pairs collision_pairs_io
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(TARGETS collision_pairs_node check_bag check_motion check_states generate_srdf merge_bag_checks
                read_mesh_file simulate_depth_camera
  RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY include/collision_pairs/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
install(DIRECTORY launch config DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
catkin_install_python(PROGRAMS scripts/move_demo_robot scripts/plot_bag_report
                      scripts/print_bag_robot scripts/print_collision_pairs
                      scripts/replay_transforms
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
