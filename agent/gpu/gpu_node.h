// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace coslam {

// Whether a kernel driver offers a GPU here. To ask OpenCL loads all that is installed of it, which for one that has
// but the processor (PoCL with its compiler) takes 54 MiB of memory. True where the folder of devices cannot be read.
bool has_gpu_node(const std::filesystem::path& devices = "/dev");

}  // namespace coslam
