# A Debian package of what is installed into /usr; scripts/package makes it.
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  return()
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME collision-pairs)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "collision_pairs maintainers <maintainers@collision-pairs.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "collision monitor for ROS 1: which links touch or nearly touch")
# CPack puts the summary before it, and a space before each line.
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"Takes collision geometry from the URDF and poses from TF, and publishes
contact pairs, near pairs and rviz markers of a robot, its surroundings and
point clouds. Contains the node, its nodelet, tools, the library of C++ and the
module of Python.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# Libraries are found by dpkg-shlibdeps; the rest is what launch files start and Python imports.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_LIB_DESTINATION})
set(needed python3-numpy python3-dynamic-reconfigure python3-geometry-msgs python3-rosbag python3-roslaunch
  python3-roslib python3-rospy python3-sensor-msgs python3-shape-msgs python3-std-msgs python3-tf2-msgs
  python3-trajectory-msgs ros-robot-state-publisher rosbash)
list(JOIN needed ", " CPACK_DEBIAN_PACKAGE_DEPENDS)
# The compiled module is of one version of Python.
math(EXPR next "${Python_VERSION_MINOR} + 1")
string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next})")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "rviz, python3-matplotlib, python3-rosservice, python3-rostopic")
# For find_package(collision_pairs), beside a compiler and CMake.
set(to_build_with catkin libdynamic-reconfigure-config-init-mutex-dev libeigen3-dev libgeometry-msgs-dev
  libroscpp-dev libsensor-msgs-dev libshape-msgs-dev libstd-msgs-dev libstd-srvs-dev
  libtrajectory-msgs-dev libvisualization-msgs-dev libyaml-cpp-dev libompl-dev ros-message-runtime)
list(JOIN to_build_with ", " CPACK_DEBIAN_PACKAGE_SUGGESTS)

# Licence and changelog where Debian has them.
set(documents ${PROJECT_BINARY_DIR}/package)
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${documents}/changelog "collision-pairs (${PROJECT_VERSION}) unstable; urgency=medium

  * See CHANGELOG.rst of the sources.

 -- ${CPACK_PACKAGE_CONTACT}  ${now}
")
execute_process(COMMAND gzip -9nf ${documents}/changelog)
install(FILES ${documents}/changelog.gz DESTINATION share/doc/collision-pairs)
install(FILES LICENSE DESTINATION share/doc/collision-pairs RENAME copyright)

# No compiled Python, which generated messages bring: the system makes its own.
install(CODE "file(GLOB_RECURSE folders LIST_DIRECTORIES true \"\$ENV{DESTDIR}/usr/lib/python3/dist-packages/collision_pairs/*\")
list(FILTER folders INCLUDE REGEX __pycache__$)
file(REMOVE_RECURSE \${folders})")

# The libraries are in the system's folder: the linker is told so.
file(WRITE ${documents}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${documents}/triggers)
include(CPack)
