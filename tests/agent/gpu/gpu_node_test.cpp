// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/gpu_node.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temp_folder.h"

namespace coslam::gpu_node_test {
namespace {

TEST(GpuNode, IsFoundByItsDriversName) {
  const test::TempFolder folder;
  const std::filesystem::path dev = folder.path();
  const auto put = [&](const char* name) { std::ofstream(dev / name) << ' '; };
  put("null");
  put("video0");
  EXPECT_FALSE(has_gpu_node(dev));
  std::filesystem::create_directory(dev / "dri");
  EXPECT_FALSE(has_gpu_node(dev));
  std::ofstream(dev / "dri" / "card0") << ' ';
  EXPECT_FALSE(has_gpu_node(dev)) << "it shows, but does not compute";
  std::ofstream(dev / "dri" / "renderD128") << ' ';
  EXPECT_TRUE(has_gpu_node(dev));
  std::filesystem::remove_all(dev / "dri");
  for (const char* name : {"mali0", "kgsl-3d0", "nvidia0", "nvhost-gpu", "dxg"}) {
    put(name);
    EXPECT_TRUE(has_gpu_node(dev)) << name;
    std::filesystem::remove(dev / name);
  }
  EXPECT_FALSE(has_gpu_node(dev));
}

TEST(GpuNode, MayBeThereWhereNobodyCanLook) {
  const test::TempFolder folder;
  EXPECT_TRUE(has_gpu_node(std::filesystem::path(folder.path()) / "nothing"));
}

}  // namespace
}  // namespace coslam::gpu_node_test
