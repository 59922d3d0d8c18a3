// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/cuda.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "agent/gpu/cuda_compiler.h"
#include "agent/gpu/match_program.h"

namespace coslam::cuda_test {
namespace {

// The compiler needs no GPU. 8.7 is a Jetson Orin's.
TEST(Cuda, ProgramIsTranslatedWhereItsCompilerIs) {
  try {
    const std::vector<char> code = cuda_machine_code(match_program(), 87);
    for (const std::string kernel : {"halve", "match_tracks", "find_corners"}) {
      EXPECT_NE(std::string_view(code.data(), code.size()).find(kernel), std::string_view::npos) << kernel;
    }
  } catch (const NoDevice&) {
    GTEST_SKIP() << "no libnvrtc";
  }
  EXPECT_THROW(cuda_machine_code("kernel void f() { nonsense }", 87), DeviceFailure);
}

TEST(Cuda, WithoutAGpuThereIsNoDevice) {
  try {
    EXPECT_NE(cuda_device(match_program()), nullptr);
  } catch (const NoDevice& none) {
    EXPECT_NE(std::string(none.what()).find("CUDA"), std::string::npos);
  }
}

}  // namespace
}  // namespace coslam::cuda_test
