# Finds LCM (Debian ships neither a CMake package nor a .pc file that works without glib-2.0's) and defines
#   LCM::lcm                          the library
#   lcm_generate(TARGET name FILES…)  an interface target with the C++ headers that lcm-gen makes from .lcm files
find_path(LCM_INCLUDE_DIR lcm/lcm.h)
find_library(LCM_LIBRARY lcm)
find_program(LCM_GEN lcm-gen)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LCM REQUIRED_VARS LCM_LIBRARY LCM_INCLUDE_DIR LCM_GEN)

if(LCM_FOUND AND NOT TARGET LCM::lcm)
  add_library(LCM::lcm UNKNOWN IMPORTED)
  set_target_properties(LCM::lcm PROPERTIES IMPORTED_LOCATION ${LCM_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES
                                                                             ${LCM_INCLUDE_DIR})
endif()

function(lcm_generate)
  cmake_parse_arguments(ARG "" "TARGET" "FILES" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/generated)
  set(headers)
  foreach(file ${ARG_FILES})
    # lcmtypes/<package>_<type>.lcm becomes <package>/<type>.hpp
    get_filename_component(stem ${file} NAME_WE)
    file(STRINGS ${file} package_line REGEX "^package ")
    string(REGEX REPLACE "^package +([A-Za-z0-9_]+).*" "\\1" package "${package_line}")
    string(REGEX REPLACE "^${package}_" "" type ${stem})
    list(APPEND headers ${out}/${package}/${type}.hpp)
  endforeach()
  add_custom_command(
    OUTPUT ${headers}
    COMMAND ${LCM_GEN} --cpp --cpp-std=c++11 --cpp-hpath ${out} ${ARG_FILES}
    DEPENDS ${ARG_FILES}
    COMMENT "lcm-gen: C++ headers of ${ARG_TARGET}"
    VERBATIM)
  add_custom_target(${ARG_TARGET}_generated DEPENDS ${headers})
  add_library(${ARG_TARGET} INTERFACE)
  add_dependencies(${ARG_TARGET} ${ARG_TARGET}_generated)
  target_include_directories(${ARG_TARGET} SYSTEM INTERFACE ${out} ${LCM_INCLUDE_DIR})
endfunction()
