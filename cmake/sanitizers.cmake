# Sanitizers, in all targets: scripts/test --sanitize and scripts/fuzz choose them.
set(COLLISION_PAIRS_SANITIZE "" CACHE STRING "address (and undefined behaviour), thread, or nothing")
option(COLLISION_PAIRS_FUZZ "Build the libFuzzer targets in test/fuzz (clang), with the sanitizer `address`" OFF)

if(COLLISION_PAIRS_FUZZ)
  set(sanitizers address,undefined)
  add_compile_options(-fsanitize=fuzzer-no-link)
elseif(COLLISION_PAIRS_SANITIZE STREQUAL "address")
  set(sanitizers address,undefined)
  set(runtime libasan.so)
elseif(COLLISION_PAIRS_SANITIZE STREQUAL "thread")
  set(sanitizers thread)
  set(runtime libtsan.so)
elseif(COLLISION_PAIRS_SANITIZE)
  message(FATAL_ERROR "COLLISION_PAIRS_SANITIZE is '${COLLISION_PAIRS_SANITIZE}', but must be address or thread")
endif()

if(COLLISION_PAIRS_SANITIZE)
  add_compile_options(-O1)  # a third of the time to build
endif()
if(sanitizers)
  add_compile_options(-g1 -fsanitize=${sanitizers} -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${sanitizers})
  add_compile_definitions(_GLIBCXX_ASSERTIONS)  # within a vector's capacity, the address is sound
endif()
if(runtime)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${runtime} OUTPUT_VARIABLE SANITIZER_LIBRARY
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
if(sanitizers)  # GCC 12 warns falsely of replaced operators in what it inlines for a sanitizer
  set_source_files_properties(test/test_sweep_allocations.cpp PROPERTIES COMPILE_OPTIONS -Wno-mismatched-new-delete)
endif()
