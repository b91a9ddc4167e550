# Part of collision_pairsConfig.cmake: the targets collision_pairs::core and collision_pairs::io, and collision_pairs::ompl
# where OMPL is installed.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
@[if DEVELSPACE]@
include("@(PROJECT_BINARY_DIR)/collision_pairsTargets.cmake")
@[else]@
include("${collision_pairs_DIR}/collision_pairsTargets.cmake")
@[end if]@
find_package(ompl QUIET)
if(ompl_FOUND AND NOT TARGET collision_pairs::ompl)
  add_library(collision_pairs::ompl INTERFACE IMPORTED)
  set_target_properties(collision_pairs::ompl PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${OMPL_INCLUDE_DIRS}"
    INTERFACE_LINK_LIBRARIES "collision_pairs::core;${OMPL_LIBRARIES}")
endif()
