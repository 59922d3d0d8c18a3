// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

namespace coslam {

// The focal length that an image or a video notes about itself, in pixels of an image of this size: of EXIF, as 35 mm
// film has it or by the size of the sensor's pixels; of a video's container, as phones write it. Empty: nothing noted,
// or nothing that a lens can have.
std::optional<double> noted_focal_px(const std::filesystem::path& file, int width_px, int height_px);

}  // namespace coslam
