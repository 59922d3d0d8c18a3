// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/verdict.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/printed.h"

namespace coslam {
namespace {

// Truth is one to three times as far off as observations leave open, in most recordings: see docs/accuracy.md.
constexpr double kGood_percent = 0.3, kFair_percent = 1;
constexpr double kGoodShare = 0.9, kFairShare = 0.5;
constexpr std::array<const char*, 3> kNames{"good", "fair", "poor"};
// Of the focal length: the calibration is of another camera; one as far off as that seldom leads to the right lens.
constexpr double kLensIsOther = 0.1, kLensIsFar = 0.5;
constexpr double kBreathes = 0.02, kZooms = 0.08;  // of the focal length, from image to image

Quality at_most(double value, double good, double fair) {
  if (value <= good) return Quality::kGood;
  return value <= fair ? Quality::kFair : Quality::kPoor;
}

}  // namespace

Verdict verdict_of(const PathFacts& facts) {
  Verdict out{Quality::kGood, {}};
  const auto lower = [&](Quality to, const std::string& why) {
    if (to > out.quality) out = {to, why};
  };
  const double lost_share = 1 - facts.tracked_share;
  lower(at_most(lost_share, 1 - kGoodShare, 1 - kFairShare),
        printed("%.0f %% of its images have no pose in the common map", 100 * lost_share));
  if (!facts.error_percent) {
    lower(Quality::kPoor, "its images do not tell its path: it hardly moved, or saw too little");
  } else {
    lower(at_most(*facts.error_percent, kGood_percent, kFair_percent),
          printed("what it saw leaves its path open by %.2g %% of its length", *facts.error_percent));
  }
  if (facts.focal_ratio && std::abs(std::log(*facts.focal_ratio)) > kLensIsOther) {
    lower(std::abs(std::log(*facts.focal_ratio)) > kLensIsFar ? Quality::kPoor : Quality::kFair,
          printed("its images fit a focal length of %.2f times its calibration's", *facts.focal_ratio));
  }
  lower(at_most(facts.breathing, kBreathes, kZooms),
        printed("its focal length changes by up to %.0f %% from image to image", 100 * facts.breathing));
  return out;
}

nlohmann::ordered_json json_of(const PathVerdict& path) {
  using Json = nlohmann::ordered_json;
  const auto sigma_percent = path.sigma_percent();
  return {{"quality", name_of(path.verdict.quality)},
          {"why", path.verdict.why},
          {"length", path.length},
          {"sigma", path.sigma ? Json(*path.sigma) : Json()},
          {"sigma_percent", sigma_percent ? Json(*sigma_percent) : Json()}};
}

PathVerdict verdict_of(const CameraLens& camera, const PathError& path, const ImageAccount& images) {
  PathVerdict out{.verdict = {}, .length = path.length, .sigma = path.sigma};
  PathFacts facts;
  const std::uint64_t believed = images.captured() - images[ImageFate::kLeftOut];
  if (believed > 0)
    facts.tracked_share = static_cast<double>(images[ImageFate::kTracked]) / static_cast<double>(believed);
  facts.error_percent = out.sigma_percent();
  facts.breathing = camera.breathing;
  if (!camera.model.guessed()) facts.focal_ratio = std::exp(camera.lens.log_focal());
  out.verdict = verdict_of(facts);
  return out;
}

const char* name_of(Quality quality) { return kNames[static_cast<std::size_t>(quality)]; }

std::optional<Quality> quality_of(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<Quality>(i);
  }
  return std::nullopt;
}

}  // namespace coslam
