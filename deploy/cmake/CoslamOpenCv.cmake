# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# OpenCV as targets coslam_opencv_core, coslam_opencv_imgproc and so on. Programs that are installed link its archives,
# where there are any: the shared libraries of Debian bring OpenGL, X11 and LLVM along, 230 MB. Tests link the shared
# ones, which link faster and go together with the modules that only tests use.
find_package(OpenCV 4.6 REQUIRED COMPONENTS core)
set(tags aruco)  # the module that finds printed tags, see agent/track/aruco.h
if(OpenCV_VERSION VERSION_GREATER_EQUAL 4.7)
  set(tags objdetect)
endif()
set(modules ${tags} calib3d core features2d imgproc video)
find_package(OpenCV REQUIRED COMPONENTS ${modules} imgcodecs videoio)
find_package(TBB REQUIRED)
find_package(LAPACK REQUIRED)

get_target_property(shared opencv_core IMPORTED_LOCATION_RELEASE)
cmake_path(GET shared PARENT_PATH folder)
set(archives)
foreach(module ${tags} video calib3d features2d flann imgproc core)
  set(archive ${folder}/libopencv_${module}.a)
  if(NOT EXISTS ${archive})
    message(NOTICE "opencv: linked as shared libraries, because there is no ${archive}")
    set(archives)
    break()
  endif()
  list(APPEND archives ${archive})
endforeach()

if(archives)
  # Its drawing by OpenGL is linked along but never called.
  add_library(coslam_no_opengl STATIC ${PROJECT_SOURCE_DIR}/deploy/cmake/no_opengl.cpp)
  add_library(coslam_opencv_archives INTERFACE)
  list(JOIN archives "," group)
  string(APPEND group ",coslam_no_opengl")
  target_include_directories(coslam_opencv_archives SYSTEM INTERFACE ${OpenCV_INCLUDE_DIRS})
  target_link_options(coslam_opencv_archives INTERFACE -Wl,--gc-sections)
  target_link_libraries(coslam_opencv_archives INTERFACE "$<LINK_GROUP:RESCAN,${group}>"
                        TBB::tbb LAPACK::LAPACK ZLIB::ZLIB Threads::Threads ${CMAKE_DL_LIBS})
endif()
foreach(module ${modules})
  add_library(coslam_opencv_${module} INTERFACE)
  if(archives)
    target_link_libraries(coslam_opencv_${module} INTERFACE
      $<IF:$<BOOL:$<TARGET_PROPERTY:COSLAM_IS_INSTALLED>>,coslam_opencv_archives,opencv_${module}>)
  else()
    target_link_libraries(coslam_opencv_${module} INTERFACE opencv_${module})
  endif()
endforeach()
add_library(coslam_opencv_tags ALIAS coslam_opencv_${tags})
