// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/gpu_node.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

namespace coslam {
namespace {

// Desktop GPUs, Jetson, Mali, Adreno, PowerVR, Vivante, and Windows' subsystem.
constexpr std::array<std::string_view, 9> kNodes{"kfd",  "nvidia", "nvhost-gpu", "nvgpu", "mali",
                                                 "kgsl", "pvr_",   "galcore",    "dxg"};

template <class Is>
bool any_in(const std::filesystem::path& folder, const Is& is, bool unreadable) {
  std::error_code error;
  std::filesystem::directory_iterator at(folder, error);
  if (error) return unreadable;
  for (; at != std::filesystem::directory_iterator(); at.increment(error)) {
    if (error) return unreadable;
    if (is(at->path().filename().string())) return true;
  }
  return false;
}

}  // namespace

bool has_gpu_node(const std::filesystem::path& devices) {
  const auto of_gpu = [](std::string_view name) {
    return std::ranges::any_of(kNodes, [&](std::string_view n) { return name.starts_with(n); });
  };
  const auto renders = [](std::string_view name) { return name.starts_with("renderD"); };
  return any_in(devices, of_gpu, true) || any_in(devices / "dri", renders, false);
}

}  // namespace coslam
