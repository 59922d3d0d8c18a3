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

// Judges the quality of a camera's path without ground truth.
namespace coslam {

enum class Quality : std::uint8_t { kGood, kFair, kPoor };

struct PathFacts {
  double tracked_share = 0;             // share of the believed images that have a pose in the common map
  std::optional<double> error_percent;  // expected error in percent of the path's length, estimated from the images
  std::optional<double>
      focal_ratio;       // for a calibrated camera: focal length that its images fit over that of its calibration
  double breathing = 0;  // deviation of the focal length from its mean, as a share
};

struct Verdict {
  Quality quality = Quality::kPoor;
  std::string why;  // a clause; empty when it is good
};

Verdict verdict_of(const PathFacts& facts);
const char* name_of(Quality quality);  // "good", "fair", "poor"
std::optional<Quality> quality_of(std::string_view name);

// Verdict on one camera's path, with the figures it rests on.
struct PathVerdict {
  Verdict verdict;
  double length = 0;            // see PathError
  std::optional<double> sigma;  // see PathError
  std::optional<double> sigma_percent() const {
    return sigma && length > 0 ? std::optional(100 * *sigma / length) : std::nullopt;
  }
};
// The form of a verdict in reports and public messages.
nlohmann::ordered_json json_of(const PathVerdict& path);
PathVerdict verdict_of(const CameraLens& camera, const PathError& path, const ImageAccount& images);

}  // namespace coslam
