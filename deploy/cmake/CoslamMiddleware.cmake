# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# The middleware and the ray caster, of which Debian 12 and 13 have versions with other names: one target for each.

# coslam_middleware: Fast DDS 3 (Debian 13) or 2.9 and later (Debian 12). COSLAM_MIDDLEWARE is the package's name in CMake,
# COSLAM_MIDDLEWARE_MAJOR what its version starts with.
find_package(fastcdr REQUIRED)
find_package(fastdds 3 QUIET)
if(fastdds_FOUND)
  set(COSLAM_MIDDLEWARE fastdds)
  set(COSLAM_MIDDLEWARE_MAJOR 3)
  set(COSLAM_MIDDLEWARE_WANTED "fastdds 3")
  set(COSLAM_MIDDLEWARE_DEB libfastdds-dev)
else()
  find_package(fastrtps 2.9 REQUIRED)
  set(COSLAM_MIDDLEWARE fastrtps)
  set(COSLAM_MIDDLEWARE_MAJOR 2)
  set(COSLAM_MIDDLEWARE_WANTED "fastrtps 2.9")
  set(COSLAM_MIDDLEWARE_DEB libfastrtps-dev)
endif()
add_library(coslam_middleware INTERFACE)
target_link_libraries(coslam_middleware INTERFACE ${COSLAM_MIDDLEWARE} fastcdr)

# coslam_ray_caster: Embree 4 (Debian 13) or 3 (Debian 12).
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)
endif()
add_library(coslam_ray_caster INTERFACE)
target_link_libraries(coslam_ray_caster INTERFACE embree)
