// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "common/video/sound.h"

namespace coslam {

// The first ten minutes; empty: the file has no sound, or none that can be read.
std::optional<Sound> sound_of(const std::filesystem::path& video);

// How much later the second recording of the same sounds began than the first, sample against sample: the highest peak
// of their correlation where each frequency counts alike (generalised cross-correlation with phase transform, Knapp and
// Carter 1976). Empty: no peak stands out, since they heard different things or what repeats itself.
std::optional<double> began_later_s(std::span<const float> first, std::span<const float> second, double rate_hz);

}  // namespace coslam
