# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# One CMake target a folder, sources listed, so that a layer cannot include what it does not link.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# Release keeps no asserts; the estimator's own checks are COSLAM_CHECK (common/base/check.h), always on.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
if(COSLAM_SANITIZE)
  set(CMAKE_CXX_FLAGS_RELEASE "-O1 -DNDEBUG")  # what the sanitizers add is hardly optimised: -O2 only builds longer
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
find_program(COSLAM_CCACHE ccache)
if(COSLAM_CCACHE)
  # As its manual asks for with precompiled headers; a second checkout finds what the first has compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${COSLAM_CCACHE})
endif()

# The files of a folder are compiled together, since what they include costs more than what they say. Names in anonymous
# namespaces are therefore unique in a folder. Without it a change compiles one file again: for those who develop.
option(COSLAM_UNITY "compile the files of a folder together" ON)
set(CMAKE_UNITY_BUILD ${COSLAM_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 12)

add_library(coslam_options INTERFACE)
target_include_directories(coslam_options INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/coslam>)
target_compile_features(coslam_options INTERFACE cxx_std_20)
# As Debian 13 builds its libraries: what is precompiled holds only for files that are compiled alike.
target_compile_definitions(coslam_options INTERFACE $<BUILD_INTERFACE:_FILE_OFFSET_BITS=64>)
set(warnings -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wno-psabi -Wno-missing-field-initializers)
if(COSLAM_UNITY)
  list(APPEND warnings -Wno-subobject-linkage)  # GCC takes each file but the first for a header
endif()
target_compile_options(coslam_options INTERFACE "$<BUILD_INTERFACE:${warnings}>")
# Every processor computes the same: no product is added without being rounded first, and char has a sign.
target_compile_options(coslam_options INTERFACE "$<BUILD_INTERFACE:-ffp-contract=off;-fsigned-char>")
if(COSLAM_WERROR)
  target_compile_options(coslam_options INTERFACE $<BUILD_INTERFACE:-Werror>)
endif()
if(COSLAM_SANITIZE)
  # Undefined behaviour ends the test, not only prints a line.
  target_compile_options(coslam_options INTERFACE -fsanitize=${COSLAM_SANITIZE} -fno-sanitize-recover=all
                                                  -fno-omit-frame-pointer -g1)
  target_link_options(coslam_options INTERFACE -fsanitize=${COSLAM_SANITIZE})
endif()

# What nearly every file includes, read once. Presets that look for what a file forgot to include leave it out
# (CMAKE_DISABLE_PRECOMPILE_HEADERS).
set(coslam_often <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <random> <ranges>
    <set> <span> <string> <unordered_map> <utility> <vector> <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry>)
function(coslam_precompiled name)
  file(WRITE ${CMAKE_BINARY_DIR}/${name}.cpp "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE coslam_options Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

# coslam_library(NAME SOURCES a.cpp ... DEPS other_target ...): the library of one folder.
function(coslam_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC coslam_options ${ARG_DEPS})
  target_precompile_headers(${name} REUSE_FROM coslam_often)
endfunction()

# coslam_program(NAME SOURCES main.cpp ... DEPS ...): an installed program. Of the component that it is named for, else tools.
function(coslam_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE coslam_options ${ARG_DEPS})
  target_precompile_headers(${name} REUSE_FROM coslam_often)
  set_target_properties(${name} PROPERTIES COSLAM_IS_INSTALLED ON)
  set(component tools)
  if(name MATCHES "^coslam-(agent|server|bridge)$")
    set(component ${CMAKE_MATCH_1})
  endif()
  install(TARGETS ${name} RUNTIME DESTINATION bin COMPONENT ${component})
endfunction()

# coslam_plug_in(NAME COMPONENT component OF library SOURCES a.cpp ... DEPS ...): what the library loads while a program
# runs. It brings what is large, in a package of its own.
function(coslam_plug_in name)
  cmake_parse_arguments(ARG "" "COMPONENT;OF" "SOURCES;DEPS" ${ARGN})
  add_library(${name} MODULE ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE coslam_options ${ARG_DEPS})
  target_compile_definitions(${name} PRIVATE COSLAM_VERSION="${PROJECT_VERSION}")
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                           LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/coslam/plugins)
  add_dependencies(${ARG_OF} ${name})
  install(TARGETS ${name} LIBRARY DESTINATION lib/coslam/plugins COMPONENT ${ARG_COMPONENT})
endfunction()

# coslam_test(NAME SOURCES x_test.cpp ... DEPS ... [LABELS unit] [SHARE n]): one GoogleTest program, its cases found by CTest.
# The target unit_tests builds all programs with the label unit, and so on. SHARE: how many halves of a core a case takes. A
# unit test computes all the time, so 2; another waits for most of it, so 1.
function(coslam_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT;SHARE" "SOURCES;DEPS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(CMAKE_CROSSCOMPILING)
    math(EXPR ARG_TIMEOUT "10 * ${ARG_TIMEOUT}")  # an emulator is as much slower
  endif()
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if(NOT ARG_SHARE)
    set(ARG_SHARE 1)
    if(ARG_LABELS STREQUAL unit)
      set(ARG_SHARE 2)
    endif()
  endif()
  add_executable(${name} ${ARG_SOURCES})
  foreach(label ${ARG_LABELS})
    if(NOT TARGET ${label}_tests)
      add_custom_target(${label}_tests)
    endif()
    add_dependencies(${label}_tests ${name})
  endforeach()
  target_link_libraries(${name} PRIVATE coslam_options ${ARG_DEPS} GTest::gtest_main GTest::gmock)
  target_precompile_headers(${name} REUSE_FROM coslam_often_tested)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test)
  include(GoogleTest)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}"
                                          PROCESSORS ${ARG_SHARE})
endfunction()
