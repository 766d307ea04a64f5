# SPDX-License-Identifier: GPL-3.0-or-later
#
# The libraries that rooms stand on, found in one way by this project's build and by find_package(ptin). Whoever
# includes this defines what is to be done: ptin_need(<package> <arguments>...), a macro that looks for a package, and
# ptin_lack(<sentence>), a macro that ends the search.

# A library without a CMake package of its own, as the imported target <target>; none when it is not there.
function(ptin_import_library target header library)
  if(TARGET ${target})
    return()
  endif()
  string(MAKE_C_IDENTIFIER "PTIN_${library}" prefix)
  find_path(${prefix}_INCLUDE_DIR ${header})
  find_library(${prefix}_LIBRARY ${library})
  mark_as_advanced(${prefix}_INCLUDE_DIR ${prefix}_LIBRARY)
  if(${prefix}_INCLUDE_DIR AND ${prefix}_LIBRARY)
    add_library(${target} UNKNOWN IMPORTED)
    set_target_properties(${target} PROPERTIES IMPORTED_LOCATION "${${prefix}_LIBRARY}"
                                               INTERFACE_INCLUDE_DIRECTORIES "${${prefix}_INCLUDE_DIR}")
  endif()
endfunction()

# These are macros, because packages set variables for their caller, and because the search may end in them.
macro(ptin_need_library target header library)
  ptin_import_library(${target} ${header} ${library})
  if(NOT TARGET ${target})
    ptin_lack("ptin needs lib${library} and its header ${header}; on Debian run tools/install_dependencies")
  endif()
endmacro()

# ptin_find_dependencies(<room>...): what those rooms link.
macro(ptin_find_dependencies)
  set(_ptin_rooms ${ARGN})
  ptin_need(Threads)
  if("storage" IN_LIST _ptin_rooms)
    ptin_need(Boost 1.74 CONFIG)
    ptin_need(nlohmann_json CONFIG)
    ptin_need_library(ptin::xxhash xxhash.h xxhash)
  endif()
  if("second_index" IN_LIST _ptin_rooms)  # the program's, no room that is installed
    ptin_need_library(ptin::spatialindex spatialindex/SpatialIndex.h spatialindex)
  endif()
  if("crs" IN_LIST _ptin_rooms)
    ptin_need(GDAL CONFIG)
    ptin_need_library(ptin::proj geodesic.h proj)
  endif()
  if("remote" IN_LIST _ptin_rooms)
    ptin_need(GDAL CONFIG)
    ptin_need(CURL 7.85)
  endif()
  if("construct" IN_LIST _ptin_rooms)
    set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
    ptin_need(CGAL CONFIG)
    ptin_need(EXPAT)
  endif()
  if("mpi" IN_LIST _ptin_rooms)
    ptin_need(MPI COMPONENTS CXX)
  endif()
endmacro()
