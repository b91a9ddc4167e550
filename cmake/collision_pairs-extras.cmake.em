# Part of collision_pairsConfig.cmake: the targets collision_pairs::core and collision_pairs::io.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
@[if DEVELSPACE]@
include("@(PROJECT_BINARY_DIR)/collision_pairsTargets.cmake")
@[else]@
include("${collision_pairs_DIR}/collision_pairsTargets.cmake")
@[end if]@
