// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <optional>

#include "server/estimator/map/keys.h"

namespace coslam {

// Image that came with descriptors: its tracks, and the points that the map has for them by now.
struct DescribedImage {
  const MapCamera& camera;
  SetId set;                                  // set at which it was taken
  std::map<TrackId, Eigen::Vector2f> pixels;  // undistorted, all tracks
  std::map<TrackId, PointId> points;          // tracks that have a point

  const FramePose& frame() const { return *camera.frame_at(set); }
};

// Describes the newest image of a camera.
DescribedImage newest_image(const MapCamera& camera);

// Remembers images whose descriptors come after their frame, over a link that is slow or loses some: otherwise most of
// their tracks would have ended by then. Thread-compatible.
class AwaitedDescriptors {
 public:
  // Remembers the frame's image if the frame says that its descriptors follow.
  void await(PlaceRecognitionEdit& edit, const CameraFrame& frame);
  // Returns the image that the frame's descriptors belong to; the newest image when that one is not known, belongs to
  // another run of the agent or has no pose in the camera's map.
  DescribedImage image_of(const Map& map, const CameraFrame& frame) const;
  // Forgets the image, because its descriptors came.
  void came(const CameraFrame& frame);

 private:
  struct Awaited {
    FrameId frame;
    SetId set;
    LensCorrection lens;  // lens correction that the pixels are undistorted with
    std::map<TrackId, Eigen::Vector2f> pixels;
  };
  std::map<CameraId, std::deque<Awaited>> awaited_;
};

}  // namespace coslam
