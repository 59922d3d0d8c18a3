// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "common/model/image_account.h"
#include "server/estimator/adjust/certainty.h"

// How good a camera's path is, in words that need no truth.
namespace coslam {

enum class Quality : std::uint8_t { kGood, kFair, kPoor };

struct PathFacts {
  double tracked_share = 0;             // of its images that were believed: have a pose in the common map
  std::optional<double> error_percent;  // of its path's length, to be expected from what its images leave open
  std::optional<double> focal_ratio;    // of a calibrated camera: what its images fit, to what its calibration says
  double breathing = 0;                 // how far its focal length goes from the mean, as a share
};

struct Verdict {
  Quality quality = Quality::kPoor;
  std::string why;  // a clause; empty when it is good
};

Verdict verdict_of(const PathFacts& facts);
const char* name_of(Quality quality);  // "good", "fair", "poor"
std::optional<Quality> quality_of(std::string_view name);

// Of one camera, with what it rests on.
struct PathVerdict {
  Verdict verdict;
  double length = 0;            // as PathError
  std::optional<double> sigma;  // as PathError
  std::optional<double> sigma_percent() const {
    return sigma && length > 0 ? std::optional(100 * *sigma / length) : std::nullopt;
  }
};
// As reports and the public have it.
nlohmann::ordered_json json_of(const PathVerdict& path);
PathVerdict verdict_of(const MapCamera& camera, const PathError& path, const ImageAccount& images);

}  // namespace coslam
