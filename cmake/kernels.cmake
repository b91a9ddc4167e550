# The inner loops once more for newer x86-64; which one runs is chosen at run time.
# These files use nothing of the C++ library that could leave such code in a shared function.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
  set(sweep ${PROJECT_SOURCE_DIR}/src/core/broad_phase/sweep_kernel)
  set(geometry ${PROJECT_SOURCE_DIR}/src/core/geometry/geometry_kernel)
  set(batch ${PROJECT_SOURCE_DIR}/src/core/batch_model/batch_kernel)
  target_sources(collision_pairs PRIVATE ${sweep}_avx2.cpp ${sweep}_avx512.cpp
                                         ${geometry}_avx2.cpp
                                         ${batch}_avx2.cpp ${batch}_avx512.cpp)
  target_compile_definitions(collision_pairs PRIVATE COLLISION_PAIRS_X86_KERNELS)
  set_source_files_properties(${sweep}_avx2.cpp PROPERTIES COMPILE_OPTIONS "-mavx2;-mbmi;-mpopcnt")
  set_source_files_properties(${batch}_avx2.cpp PROPERTIES COMPILE_OPTIONS "-mavx2")
  set_source_files_properties(${batch}_avx512.cpp PROPERTIES COMPILE_OPTIONS "-mavx512f")
  set_source_files_properties(${geometry}_avx2.cpp PROPERTIES COMPILE_OPTIONS "-mavx2")
  # GCC 12 warns of its own intrinsics (GCC bug 105593).
  set_source_files_properties(
    ${sweep}_avx512.cpp PROPERTIES COMPILE_OPTIONS
    "-mavx512f;-mbmi;-mpopcnt;$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>")
endif()
