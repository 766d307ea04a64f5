# SPDX-License-Identifier: GPL-3.0-or-later
#
# Installs the build folder BUILD under SCRATCH, then configures, builds and runs the projects in SOURCE against it.
file(REMOVE_RECURSE ${SCRATCH})
set(flags "")
if(SANITIZE)
  set(flags "-fsanitize=${SANITIZE}")
endif()

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "${command}\nended with ${status}\n${output}")
  endif()
endfunction()

# The program is one component and the library another; together they are all that there is.
foreach(component IN ITEMS program dev)
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/${component} --component ${component})
  file(GLOB_RECURSE files_${component} RELATIVE ${SCRATCH}/${component} ${SCRATCH}/${component}/*)
endforeach()
string(REGEX MATCH "libexec/ptin/[0-9.]+/ptin-whole" whole "${files_program}")  # none under sanitizers
set(program bin/ptin ${whole} share/bash-completion/completions/ptin share/man/man1/ptin.1)
if(NOT files_program STREQUAL program)
  message(FATAL_ERROR "the component program has ${files_program}, and is to have ${program}")
endif()
run(${SCRATCH}/program/bin/ptin --version)
run(${SCRATCH}/program/bin/ptin build ${SOURCE}/../data/mountains_257.tif -o ${SCRATCH}/m.ptin -q)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/prefix)
file(GLOB_RECURSE files RELATIVE ${SCRATCH}/prefix ${SCRATCH}/prefix/*)
list(REMOVE_ITEM files ${files_program} ${files_dev})
if(files)
  message(FATAL_ERROR "no component has ${files}")
endif()
function(build source folder)
  run(${CMAKE_COMMAND} -S ${source} -B ${folder} -G ${GENERATOR} -D CMAKE_PREFIX_PATH=${SCRATCH}/dev
      -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${flags} -D CMAKE_BUILD_TYPE=Release
      -D CMAKE_CXX_FLAGS_RELEASE=-O0 ${ARGN})
  run(${CMAKE_COMMAND} --build ${folder})
endfunction()

build(${SOURCE} ${SCRATCH}/build)
run(${CMAKE_COMMAND} -E chdir ${SCRATCH} ${SCRATCH}/build/ptin_user)
run(${SCRATCH}/build/ptin_geometry_user)
run(${SCRATCH}/build/readme_program ${SCRATCH}/hill.ptin)

set(without "")
foreach(package IN ITEMS CGAL CURL EXPAT GDAL)
  list(APPEND without -D CMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
build(${SOURCE}/query ${SCRATCH}/query_build ${without})
run(${SCRATCH}/query_build/ptin_asker ${SCRATCH}/hill.ptin)

# Libraries that a user must bring along to include a header are linked PUBLIC, and are few.
file(GLOB_RECURSE headers ${SCRATCH}/dev/include/ptin/*.h)
foreach(header IN LISTS headers)
  file(STRINGS ${header} foreign REGEX "^#include <([^>]*[/.].*)>")
  list(FILTER foreign EXCLUDE REGEX "<(nlohmann/json_fwd.hpp|sys/types.h)>")
  if(foreign)
    message(FATAL_ERROR "${header} is installed and says ${foreign}: link that PUBLIC, then list it here")
  endif()
endforeach()
