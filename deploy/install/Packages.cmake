# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Debian packages, one a component: coslam-agent, coslam-server, coslam-bridge, coslam (the tools), coslam-video,
# coslam-gstreamer, libcoslam-dev.
set(CPACK_GENERATOR DEB)
# A package runs on the release that it was built on, so its version says which: 0.1.0+deb12.
file(STRINGS "${CMAKE_SYSROOT}/etc/os-release" os_release)
set(COSLAM_DEB_VERSION ${PROJECT_VERSION})
set(COSLAM_DEB_RELEASE unstable)
if(os_release MATCHES "VERSION_CODENAME=([a-z]+)")
  set(COSLAM_DEB_RELEASE ${CMAKE_MATCH_1})
endif()
if(os_release MATCHES "VERSION_ID=\"([0-9]+)\"")
  string(APPEND COSLAM_DEB_VERSION "+deb${CMAKE_MATCH_1}")
endif()
set(CPACK_DEBIAN_PACKAGE_VERSION ${COSLAM_DEB_VERSION})
set(CPACK_PACKAGE_NAME coslam)
set(COSLAM_MAINTAINER "The CoSLAM authors <coslam@localhost>" CACHE STRING "who hands out the packages: Name <mail>")
set(CPACK_PACKAGE_CONTACT ${COSLAM_MAINTAINER})
set(CPACK_PACKAGE_VENDOR "The CoSLAM authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL agent server bridge tools video dev)
if(TARGET coslam-gstreamer)
  list(APPEND CPACK_COMPONENTS_ALL gstreamer)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu ${CMAKE_SYSROOT}/lib/aarch64-linux-gnu)
endif()
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# coslam_package(COMPONENT NAME SECTION SUMMARY DESCRIPTION)
macro(coslam_package component name section summary description)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${description}")
  configure_file(copyright ${CMAKE_CURRENT_BINARY_DIR}/${name}/copyright COPYONLY)
  configure_file(changelog ${CMAKE_CURRENT_BINARY_DIR}/changelog @ONLY)
  execute_process(COMMAND gzip --best --no-name --stdout ${CMAKE_CURRENT_BINARY_DIR}/changelog
                  OUTPUT_FILE ${CMAKE_CURRENT_BINARY_DIR}/${name}/changelog.gz)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}/copyright ${CMAKE_CURRENT_BINARY_DIR}/${name}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endmacro()
coslam_package(agent coslam-agent science "camera agent of CoSLAM"
"Tracks features in one camera, localises it in the map that several cameras
build together, and sends tracks and poses, never images, to the map server.")
coslam_package(server coslam-server science "map server of CoSLAM"
"Builds one map from the tracks of several cameras that move on their own, with
the paths of what moves in it, and sends corrections back to the agents.")
coslam_package(bridge coslam-bridge science "bridge from CoSLAM to ROS 2 and PX4"
"Hands on what a map server knows to ROS 2 nodes on a DDS domain of the user's,
and the poses of an agent to a PX4 autopilot.")
coslam_package(tools coslam science "tools of CoSLAM, visual SLAM of several cameras"
"Runs whole sequences on one machine, measures results, exports and explains
them, looks after map files, calibrates cameras.")
coslam_package(video coslam-video video "videos and streams for CoSLAM"
"Lets agents and tools of CoSLAM read video files, streams from the network and
images other than PNG and JPEG, by FFmpeg.")
coslam_package(gstreamer coslam-gstreamer video "GStreamer pipelines for CoSLAM"
"Lets agents of CoSLAM take their images from a pipeline of GStreamer.")
coslam_package(dev libcoslam-dev libdevel "headers and libraries to speak with CoSLAM"
"What crosses the wire between agents and map server, for programs in C++ that
want to know where the cameras are and what moves around them.")
# An agent with a camera of its own, or with images of ROS 2, needs neither of them, and FFmpeg is larger than all else.
set(CPACK_DEBIAN_AGENT_PACKAGE_SUGGESTS "coslam-video (= ${COSLAM_DEB_VERSION}), coslam-gstreamer (= ${COSLAM_DEB_VERSION})")
set(CPACK_DEBIAN_GSTREAMER_PACKAGE_DEPENDS "gstreamer1.0-plugins-base")
# A robot has the agent alone, and the tools that look at it; `coslam run` says what it lacks.
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "coslam-agent (= ${COSLAM_DEB_VERSION}), coslam-server (= ${COSLAM_DEB_VERSION}), coslam-video (= ${COSLAM_DEB_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libeigen3-dev, libspdlog-dev, nlohmann-json3-dev, libssl-dev, libfastcdr-dev, ${COSLAM_MIDDLEWARE_DEB}")
foreach(part agent server bridge)
  string(TOUPPER ${part} upper)
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${part}/conffiles "/etc/coslam/${part}.yaml\n")
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_BINARY_DIR}/${part}/conffiles)
endforeach()
include(CPack)
