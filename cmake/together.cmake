# Most of the time to compile goes into headers that files share: Eigen, ROS, gtest. Therefore the files of a folder are
# compiled as one, ten at a time; what they keep in anonymous namespaces has different names. OFF is quicker only where
# one file is built again and again.
set(CMAKE_UNITY_BUILD ON CACHE BOOL "Compile the source files of a folder together")
set(compile_together ${CMAKE_UNITY_BUILD})
set(CMAKE_UNITY_BUILD OFF)  # that of CMake 3.16 itself would mix folders, and others with each file that is added

# The sources that the target has so far.
function(collision_pairs_together target)
  if(NOT compile_together)
    return()
  endif()
  set(folders "")
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    get_filename_component(source ${source} ABSOLUTE)
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
    string(MAKE_C_IDENTIFIER ${folder} folder)
    if(NOT DEFINED number_${folder})
      list(APPEND folders ${folder})
      set(number_${folder} 0)
    endif()
    math(EXPR part "${number_${folder}} / 10")
    math(EXPR number_${folder} "${number_${folder}} + 1")
    file(RELATIVE_PATH source ${PROJECT_SOURCE_DIR} ${source})  # so that ccache knows it in another tree
    string(APPEND ${folder}_${part} "#include \"${source}\"\n")
    set(parts_${folder} ${part})
  endforeach()
  # A class of which a member's type is in an anonymous namespace is no fault where it is in a source file; and GCC 12
  # warns falsely of std::string where more is inlined (GCC bug 105651).
  target_compile_options(${target} PRIVATE "$<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage;-Wno-restrict>")
  set(together "")
  foreach(folder ${folders})
    foreach(part RANGE ${parts_${folder}})
      set(file ${PROJECT_BINARY_DIR}/together/${target}_${folder}_${part}.cpp)
      set(old "")
      if(EXISTS ${file})
        file(READ ${file} old)
      endif()
      if(NOT old STREQUAL ${folder}_${part})
        file(WRITE ${file} "${${folder}_${part}}")
      endif()
      list(APPEND together ${file})
    endforeach()
  endforeach()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  set_target_properties(${target} PROPERTIES SOURCES "${together}")
endfunction()
