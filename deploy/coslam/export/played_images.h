// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <set>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/dataset/sequence.h"
#include "common/geometry/camera_model.h"

namespace coslam::exporting {

// An image of a camera as it was played.
struct PlayedImage {
  FrameId frame;
  TimeNs t_ns = 0;             // played
  std::filesystem::path file;  // empty: the source has none for each image, as of a video
};

// The images of one camera of a sequence, read again. lens: as calibrated, for the size.
class PlayedImages {
 public:
  PlayedImages(const SequenceAgent& agent, double rate_hz, const CameraModel& lens)
      : agent_(agent), rate_hz_(rate_hz), lens_(lens) {}

  // Images in their order. Throws UserError: the source cannot be opened, or it is live.
  std::vector<PlayedImage> list() const;
  // Visits the images of these frames with their pixels, in colour where the source has it. Throws UserError too where
  // one is not there.
  void each(std::set<FrameId> frames, const std::function<void(FrameId, const cv::Mat&)>& visit) const;

 private:
  const SequenceAgent& agent_;
  double rate_hz_;
  const CameraModel& lens_;
};

}  // namespace coslam::exporting
