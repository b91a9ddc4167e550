# Part of collision_pairsConfig.cmake: the targets collision_pairs::core and collision_pairs::io, and collision_pairs::ompl
# where OMPL is installed.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
@[if DEVELSPACE]@
include("@(PROJECT_BINARY_DIR)/collision_pairsTargets.cmake")
@[else]@
# In Debian's /usr this file is in lib/ARCHITECTURE/cmake/collision_pairs.
set(collision_pairs_TARGETS "${collision_pairs_DIR}/collision_pairsTargets.cmake")
if(NOT EXISTS "${collision_pairs_TARGETS}")
  set(collision_pairs_TARGETS "${collision_pairs_DIR}/../../../../share/collision_pairs/cmake/collision_pairsTargets.cmake")
endif()
include("${collision_pairs_TARGETS}")
@[end if]@
find_package(ompl QUIET)
if(ompl_FOUND AND NOT TARGET collision_pairs::ompl)
  # CMake refuses folders that do not exist, and Debian 13's OMPL names one of HDF5, which it does not depend on.
  set(collision_pairs_OMPL_FOLDERS "")
  foreach(folder ${OMPL_INCLUDE_DIRS})
    if(IS_DIRECTORY "${folder}")
      list(APPEND collision_pairs_OMPL_FOLDERS "${folder}")
    endif()
  endforeach()
  add_library(collision_pairs::ompl INTERFACE IMPORTED)
  set_target_properties(collision_pairs::ompl PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${collision_pairs_OMPL_FOLDERS}"
    INTERFACE_LINK_LIBRARIES "collision_pairs::core;${OMPL_LIBRARIES}")
endif()
