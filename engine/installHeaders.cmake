# SPDX-License-Identifier: GPL-3.0-or-later
#
# Run at installation: copies the headers that another program may include from SOURCE into INCLUDE_FOLDER/ptin. Those
# are what the program `ptin` itself includes of the engine, the few of `also` below, and what these include in turn; the
# others are how a room works inside.
cmake_policy(VERSION 3.25)
set(also engine/error.h engine/geometry/orient.h engine/mesh/validate.h engine/query/refine/moving_window.h storage/store_writer.h)

file(GLOB_RECURSE users RELATIVE "${SOURCE}" "${SOURCE}/tools/*.h" "${SOURCE}/tools/*.cc")
set(headers "")
set(unread ${users} ${also})
while(unread)
  list(POP_FRONT unread path)
  if(NOT path MATCHES "^tools/")
    list(APPEND headers ${path})
  endif()
  file(STRINGS "${SOURCE}/${path}" lines REGEX "^#include \"(engine|storage)/")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" included "${line}")
    if(NOT included IN_LIST headers AND NOT included IN_LIST unread)
      list(APPEND unread ${included})
    endif()
  endforeach()
endwhile()

list(SORT headers)
cmake_path(ABSOLUTE_PATH INCLUDE_FOLDER BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
foreach(header IN LISTS headers)
  get_filename_component(folder ${header} DIRECTORY)
  file(INSTALL DESTINATION "${INCLUDE_FOLDER}/ptin/${folder}" TYPE FILE FILES "${SOURCE}/${header}")
endforeach()
