# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
find_dependency(spdlog 1.10)
find_dependency(nlohmann_json 3.11)
find_dependency(OpenSSL 3.0)
find_dependency(fastcdr)
find_dependency(@COSLAM_MIDDLEWARE_WANTED@)  # what this package was built with
find_dependency(Threads)
include(${CMAKE_CURRENT_LIST_DIR}/coslamTargets.cmake)
