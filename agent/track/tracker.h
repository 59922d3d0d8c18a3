// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "agent/track/feature_tracker.h"
#include "agent/track/matcher.h"
#include "agent/track/tracker_config.h"
#include "common/base/ids.h"
#include "common/model/track_frame.h"

namespace coslam {

// Shi-Tomasi corners followed by pyramidal KLT with a gain and offset per window, checked forward and backward and
// against the patch that was seen first, which also keeps a track from drifting. New corners fill the emptiest parts of
// the image. A track that leaves the image, fails a check or jumps ends for good.
// Pure and deterministic: the same images give the same tracks. Thread-compatible.
class Tracker {
 public:
  explicit Tracker(const TrackerConfig& config) : Tracker(config, cpu_matcher(config)) {}
  Tracker(const TrackerConfig& config, std::unique_ptr<Matcher> matcher);
  ~Tracker();
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  // Follows all tracks into `grey` (CV_8UC1, constant size) and fills up. Returns the live tracks, ascending id.
  const std::vector<Track>& step(const cv::Mat& grey);

  // The live tracks, ascending id.
  const std::vector<Track>& live() const;

  // Starts tracks at these places of the newest image, beyond max_tracks if need be. Returns the id for each: that of a
  // live track where one is closer than `same_px`; none where one would have to start after `most_new` have been.
  std::vector<TrackId> add(const std::vector<Eigen::Vector2f>& raw_px, float same_px,
                           int most_new = std::numeric_limits<int>::max());

  // Ends tracks where they stand closest, newest first, until at most max_tracks are left or `at_most` were ended.
  void thin(int at_most);

  // Changes the image size by `ratio`; `grey` is the newest image at the new size. All tracks go on.
  void resize(const cv::Mat& grey, double ratio);

  // Sets the mask, of the size of the images (CV_8UC1): where it is black nothing is followed from now on. Empty:
  // everywhere.
  void set_mask(const cv::Mat& mask);

  // Forgets all tracks (after a gap in the images); ids go on.
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Patch of kPatchSide x kPatchSide around raw_px from the image scaled to 30 %: centred on the true sub-pixel position.
// `small` is that scaled image, see shrink_for_patches().
cv::Mat shrink_for_patches(const cv::Mat& grey);
ImagePatch cut_patch(const cv::Mat& small, const Track& track);

}  // namespace coslam
