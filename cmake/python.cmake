# The Python package: compiled module, __init__ and type stubs, beside the generated messages of the
# same name. messages.cmake keeps catkin from installing an __init__ of its own.
find_package(Python 3 REQUIRED COMPONENTS Interpreter Development)  # pybind11 takes this prefix
find_package(pybind11 REQUIRED)

pybind11_add_module(collision_pairs_python MODULE NO_EXTRAS
  src/python/check_result.cpp
  src/python/detector.cpp
  src/python/joint_states.cpp
  src/python/module.cpp
  src/python/motions.cpp
  src/python/objects.cpp
  src/python/robot.cpp
  src/python/scene.cpp
)
target_include_directories(collision_pairs_python PRIVATE src/core/base)
target_link_libraries(collision_pairs_python PRIVATE collision_pairs_io)
collision_pairs_together(collision_pairs_python)
collision_pairs_warnings(collision_pairs_python)
collision_pairs_checked_indices(collision_pairs_python)
file(RELATIVE_PATH libraries /${CATKIN_PACKAGE_PYTHON_DESTINATION} /${CATKIN_PACKAGE_LIB_DESTINATION})
set_target_properties(collision_pairs_python PROPERTIES
  OUTPUT_NAME _native
  LIBRARY_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_PYTHON_DESTINATION}
  INSTALL_RPATH $ORIGIN/${libraries})

set(python_sources __init__.py __init__.pyi py.typed watchdog.py)
foreach(file ${python_sources})
  configure_file(src/python/collision_pairs/${file}
                 ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_PYTHON_DESTINATION}/${file} COPYONLY)
endforeach()
list(TRANSFORM python_sources PREPEND src/python/collision_pairs/)
install(FILES ${python_sources} DESTINATION ${CATKIN_PACKAGE_PYTHON_DESTINATION})
install(TARGETS collision_pairs_python LIBRARY DESTINATION ${CATKIN_PACKAGE_PYTHON_DESTINATION})
