# SPDX-License-Identifier: GPL-3.0-or-later
#
# Every line of the CSV MADE is a line of the CSV PUBLISHED: counts that no machine changes, which a change of the builder
# makes stale.
# usage: cmake -D MADE=... -D PUBLISHED=... -P published_figures.cmake
cmake_policy(VERSION 3.25)
file(STRINGS "${PUBLISHED}" published)
file(STRINGS "${MADE}" made)
foreach(line IN LISTS made)
  if(NOT line IN_LIST published)
    message(SEND_ERROR "${PUBLISHED} has no line\n  ${line}\nMake it again (bench/README.md), and look at what its document says of it.")
  endif()
endforeach()
