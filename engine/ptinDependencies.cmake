# SPDX-License-Identifier: GPL-3.0-or-later
#
# The libraries that rooms stand on, found in one way by this project's build and by find_package(ptin).

# A library without a CMake package of its own, as the imported target <target>.
function(ptin_import_library target header library)
  if(TARGET ${target})
    return()
  endif()
  string(MAKE_C_IDENTIFIER "PTIN_${library}" prefix)
  find_path(${prefix}_INCLUDE_DIR ${header})
  find_library(${prefix}_LIBRARY ${library})
  mark_as_advanced(${prefix}_INCLUDE_DIR ${prefix}_LIBRARY)
  if(NOT ${prefix}_INCLUDE_DIR OR NOT ${prefix}_LIBRARY)
    message(FATAL_ERROR "ptin needs lib${library} and its header ${header}; on Debian run tools/install_dependencies")
  endif()
  add_library(${target} UNKNOWN IMPORTED)
  set_target_properties(${target} PROPERTIES IMPORTED_LOCATION "${${prefix}_LIBRARY}"
                                             INTERFACE_INCLUDE_DIRECTORIES "${${prefix}_INCLUDE_DIR}")
endfunction()

# ptin_find_dependencies(<room>...): what those rooms link. A macro, because packages set variables for their caller.
macro(ptin_find_dependencies)
  set(_ptin_rooms ${ARGN})
  find_package(Threads REQUIRED)
  if("storage" IN_LIST _ptin_rooms)
    find_package(Boost 1.74 CONFIG REQUIRED)
    find_package(nlohmann_json CONFIG REQUIRED)
    ptin_import_library(ptin::xxhash xxhash.h xxhash)
    ptin_import_library(ptin::spatialindex spatialindex/SpatialIndex.h spatialindex)
  endif()
  if("construct" IN_LIST _ptin_rooms)
    set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
    find_package(CGAL CONFIG REQUIRED)
    find_package(EXPAT REQUIRED)
    find_package(GDAL CONFIG REQUIRED)
    find_package(TBB CONFIG REQUIRED)
  endif()
endmacro()
