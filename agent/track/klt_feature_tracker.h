// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "agent/track/feature_tracker.h"
#include "agent/track/tracker.h"
#include "common/geometry/camera_model.h"

namespace coslam {

// Tracks by Tracker, patches and SIFT descriptors cut from the image, tags by TagFinder. Throws UserError for an
// unknown family of tags (kNoTags: none are looked for), and for a mask that is none of this camera.
std::unique_ptr<FeatureTracker> klt_feature_tracker(const CameraModel& camera, const TrackerConfig& config,
                                                    const std::string& tag_family, std::unique_ptr<Matcher> matcher);

}  // namespace coslam
