// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <optional>

#include "server/estimator/map/keys.h"

namespace coslam {

// An image that came with descriptors: what it showed, and the points that the map has for that by now.
struct DescribedImage {
  const MapCamera& camera;
  SetId set;                                  // it was taken at
  std::map<TrackId, Eigen::Vector2f> pixels;  // undistorted, of all its tracks
  std::map<TrackId, PointId> points;          // of those that have one

  const FramePose& frame() const { return *camera.frame_at(set); }
};

// The newest of a camera.
DescribedImage newest_image(const MapCamera& camera);

// Descriptors that come after their frame, over a link that carries little or loses some: their image is kept until
// then, or most of its tracks would have ended. Thread-compatible.
class AwaitedDescriptors {
 public:
  // What the map knows of an image of this set is kept from now on when its frame says that its descriptors follow.
  void await(PlaceRecognitionEdit& edit, const CameraFrame& frame);
  // The image that these are of; the newest, when it is not known, of another run of the agent or not placed in the
  // camera's map.
  DescribedImage image_of(const Map& map, const CameraFrame& frame) const;
  // They came: it is kept no longer.
  void came(const CameraFrame& frame);

 private:
  struct Awaited {
    FrameId frame;
    SetId set;
    LensCorrection lens;  // that they were seen through
    std::map<TrackId, Eigen::Vector2f> pixels;
  };
  std::map<CameraId, std::deque<Awaited>> awaited_;
};

}  // namespace coslam
