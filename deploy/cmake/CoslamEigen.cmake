# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Eigen rounds alike on amd64 and arm64. For arm64 it would multiply and add in one rounding, which no option of the
# compiler turns off, and add floats up by other halves of vectors. So arm64 is built with a copy of its headers in the build
# folder, in which both are as with SSE2.

# Replaces a piece of text of a file that must be there.
function(coslam_eigen_edit file old new)
  file(READ ${file} text)
  string(REPLACE "${old}" "${new}" edited "${text}")
  if(edited STREQUAL text)
    message(FATAL_ERROR "Eigen ${Eigen3_VERSION} is not the one that deploy/cmake/CoslamEigen.cmake knows: ${file} has no '${old}'")
  endif()
  file(WRITE ${file} "${edited}")
endfunction()

function(coslam_eigen_for_arm64)
  get_target_property(from Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
  set(to ${CMAKE_BINARY_DIR}/eigen3)
  set(made_of "${from} ${Eigen3_VERSION} 1")  # the number counts the edits below
  if(NOT EXISTS ${to}/made_of)
    set(was "")
  else()
    file(READ ${to}/made_of was)
  endif()
  if(NOT was STREQUAL made_of)
    file(REMOVE_RECURSE ${to})
    file(COPY ${from}/Eigen ${from}/unsupported DESTINATION ${to})
    set(neon ${to}/Eigen/src/Core/arch/NEON)
    coslam_eigen_edit(${neon}/PacketMath.h "#ifdef __ARM_FEATURE_FMA" "#if 0")
    coslam_eigen_edit(${neon}/PacketMath.h "#define EIGEN_HAS_SINGLE_INSTRUCTION_MADD" "")
    coslam_eigen_edit(${neon}/PacketMath.h "  typedef Packet4f type;\n  typedef Packet2f half;\n  enum\n  {\n    Vectorizable = 1,\n    AlignedOnScalar = 1,\n    size = 4,\n    HasHalfPacket = 1,"
                      "  typedef Packet4f type;\n  typedef Packet4f half;\n  enum\n  {\n    Vectorizable = 1,\n    AlignedOnScalar = 1,\n    size = 4,\n    HasHalfPacket = 0,")
    coslam_eigen_edit(${neon}/PacketMath.h "struct unpacket_traits<Packet4f>\n{\n  typedef float type;\n  typedef Packet2f half;"
                      "struct unpacket_traits<Packet4f>\n{\n  typedef float type;\n  typedef Packet4f half;")
    file(WRITE ${neon}/GeneralBlockPanelKernel.h "")  # the general one is taken
    file(WRITE ${to}/made_of "${made_of}")
  endif()
  set_target_properties(Eigen3::Eigen PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${to})
endfunction()
