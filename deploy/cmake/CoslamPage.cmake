# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# The page of the live view: bundled from npm packages at build time, in the build folder, into one C++ file.

option(COSLAM_PAGE "bundle the live view's page into the server (needs npm and, the first time, the network)" ON)
set(COSLAM_PAGE_DIR ${PROJECT_BINARY_DIR}/page)

# coslam_page(NAME FALLBACK no_page.cpp): the library of the page in the current folder, where npm is there; else none.
function(coslam_page name fallback)
  find_program(COSLAM_NODE node)
  find_program(COSLAM_NPM npm)
  if(NOT COSLAM_PAGE OR NOT COSLAM_NODE OR NOT COSLAM_NPM)
    return()
  endif()
  execute_process(COMMAND ${COSLAM_NODE} --version OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REGEX REPLACE "^v" "" version "${version}")
  if(version VERSION_LESS 18)
    message(NOTICE "page: left out, because node is ${version} and 18 is needed")
    return()
  endif()
  set(out ${COSLAM_PAGE_DIR}/page_files.cpp)
  if(EXISTS ${COSLAM_PAGE_DIR}/left_out)
    file(REMOVE ${out})  # configuring again is trying again
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/* ${CMAKE_CURRENT_SOURCE_DIR}/dev/*
       ${CMAKE_CURRENT_SOURCE_DIR}/test/*)
  set(script ${PROJECT_SOURCE_DIR}/deploy/cmake/make_page.cmake)
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -D FROM=${CMAKE_CURRENT_SOURCE_DIR} -D TO=${COSLAM_PAGE_DIR} -D OUT=${out}
            -D FALLBACK=${fallback} -D NODE=${COSLAM_NODE} -D NPM=${COSLAM_NPM} -D TESTS=${COSLAM_TESTS} -P ${script}
    DEPENDS ${sources} ${fallback} ${script} build.mjs bytes.mjs licences.mjs package.json package-lock.json .npmrc tsconfig.json
    COMMENT "Bundling the page"
    VERBATIM)
  coslam_library(${name} SOURCES ${out})
  set_property(GLOBAL PROPERTY COSLAM_PAGE_IS_BUILT ON)
endfunction()
