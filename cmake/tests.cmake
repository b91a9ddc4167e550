# One executable a module: test/test_<module>.cpp; Python tests by pytest; rostests in test/ros.
if(NOT BUILD_TESTING)
  return()
endif()
find_package(GTest REQUIRED)

function(collision_pairs_test name)
  add_executable(test_${name} test/test_${name}.cpp)
  target_link_libraries(test_${name} PRIVATE collision_pairs ${ARGN} GTest::gtest GTest::gmock
                                             GTest::gtest_main)
  target_include_directories(test_${name} PRIVATE src/core test)
  target_compile_definitions(test_${name} PRIVATE PROJECT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  collision_pairs_warnings(test_${name})
  add_test(NAME ${name} COMMAND test_${name})
endfunction()

collision_pairs_test(aabb)
collision_pairs_test(collision_detector)
collision_pairs_test(enclosure)
collision_pairs_test(joint_states_csv collision_pairs_io)
collision_pairs_test(mesh_loader collision_pairs_io)
collision_pairs_test(messages_and_markers collision_pairs_ros)
collision_pairs_test(pair_filter)
collision_pairs_test(parameters collision_pairs_ros)
collision_pairs_test(robot_model)
collision_pairs_test(shape)
collision_pairs_test(srdf)
collision_pairs_test(sweep_and_prune)
collision_pairs_test(text_files collision_pairs_io)
collision_pairs_test(transform_tracks collision_pairs_io ${catkin_LIBRARIES})
collision_pairs_test(urdf_errors)

function(collision_pairs_pytest name)
  add_test(NAME ${name}
    COMMAND ${PYTHON_EXECUTABLE} -m pytest -q -p no:cacheprovider
            --junitxml=${CMAKE_BINARY_DIR}/test_results/${name}.xml
            ${PROJECT_SOURCE_DIR}/test/test_${name}.py)
  set_tests_properties(${name} PROPERTIES ENVIRONMENT
    "COLLISION_PAIRS_TOOLS=${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION};PYTHONDONTWRITEBYTECODE=1")
endfunction()

collision_pairs_pytest(architecture)
collision_pairs_pytest(bag_outputs)
collision_pairs_pytest(check_bag)
collision_pairs_pytest(check_states)
collision_pairs_pytest(reference)

# Each under a master of its own: rostest takes a free port.
function(collision_pairs_rostest name)
  add_test(NAME rostest_${name} COMMAND rostest ${PROJECT_SOURCE_DIR}/test/ros/${name}.test)
  set_tests_properties(rostest_${name} PROPERTIES RUN_SERIAL TRUE TIMEOUT 180)
endfunction()

collision_pairs_rostest(node)
collision_pairs_rostest(boxes)
collision_pairs_rostest(bad_input)
collision_pairs_rostest(clock_jumps)
collision_pairs_rostest(late_start)
collision_pairs_rostest(replay)
collision_pairs_rostest(rviz)
