// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "agent/track/cell_corners.h"
#include "agent/track/key_patch.h"
#include "agent/track/pyramid.h"
#include "agent/track/tracker_config.h"

namespace coslam {

// A track where it was in the image before, and what is known of it.
struct Sought {
  Eigen::Vector2f from_px, motion_px;  // the motion is that of the image before
  bool moving = false;                 // apart from the image as a whole
  const KeyPatch* key = nullptr;       // never null; of two with one number only the warp differs
};

// Position of a track in the newest image.
struct TrackSighting {
  bool found = false;                            // result from the two images alone
  Eigen::Vector2f px = Eigen::Vector2f::Zero();  // if found
  KeyAlignment key;                              // the first patch, looked for around px
};

struct Following {
  Eigen::Vector2f shift_px = Eigen::Vector2f::Zero();  // shift of the image as a whole
  std::vector<TrackSighting> sightings;                // sighting of each track
};

// The tracker's work on pixels, so that a GPU may do it: the tracker decides what becomes of the tracks.
// Thread-compatible.
class Matcher {
 public:
  virtual ~Matcher() = default;

  // Takes the newest image (CV_8UC1, constant size); the one before it is kept.
  virtual void push(const cv::Mat& grey) = 0;

  // Forgets all images and cells: the next image may have another size.
  virtual void restart() = 0;

  // Follows tracks from the image before into the newest; last_shift_px is the shift that the last call gave.
  virtual Following follow(const std::vector<Sought>& tracks, const Eigen::Vector2f& last_shift_px) = 0;

  // Sets the cells where corners will be asked for, pixels of the level corner_level(). Called once, after the first
  // push() of a size.
  virtual void watch(const std::vector<CornerCell>& cells) = 0;
  // Corners of one of these cells in the newest image.
  virtual CellCorners corners(std::size_t cell) = 0;

  // The two images on the CPU: the finest level at least. Empty before they came.
  virtual const Pyramid& before() const = 0;
  virtual const Pyramid& newest() const = 0;
};

std::unique_ptr<Matcher> cpu_matcher(const TrackerConfig& config);

}  // namespace coslam
