// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "server/estimator/map/map.h"
#include "server/estimator/places/described_image.h"
#include "server/estimator/places/key_image.h"

// Where a camera is by the points behind key images: their features are matched by their looks, and PnP says where most
// of the matches put the camera.
namespace coslam {

// Points behind the features of some key images, with the looks that they had in the best of these.
struct KnownPoints {
  std::vector<PointId> ids;
  std::vector<Eigen::Vector3d> positions;
  std::vector<int> images;  // index among the asked
  std::vector<std::uint8_t> descriptors;
};

// Collects the points of a map that these images describe.
KnownPoints known_points(const Map& map, MapId of, std::span<const KeyImage* const> asked);

// What matched of some known points.
struct Matched {
  std::vector<TrackId> tracks;
  std::vector<int> known;               // index
  std::vector<Eigen::Vector2d> pixels;  // undistorted
};

struct NearMatches : Matched {
  std::vector<double> off_px;  // from where the point should appear
};

struct FeaturesOfImage {
  const MapCamera& camera;
  const std::vector<TrackId>& tracks;
  const std::vector<std::uint8_t>& descriptors;
  std::map<TrackId, Eigen::Vector2d> pixels;
};
FeaturesOfImage features_of(const DescribedImage& image, const DescriptorReply& reply);

struct Agreement {
  double sigma_px;  // of a match, at 640 px image width
  int min_inliers;
  double min_hull;  // of the image
};

// Finds the pose that most of the matches agree on.
std::optional<PlaceMatch> locate(const Map& map, CameraId id, std::span<const KeyImage* const> asked, MapId in,
                                 const KnownPoints& known, const Matched& matched, const Agreement& wanted);
// Matches known points with the features that look most like them among those near where this pose puts the points.
NearMatches match_near(const FeaturesOfImage& image, const Rigid3& cam_from_world, const KnownPoints& known,
                       const std::function<bool(PointId)>& may_match);
// Finds the pose first by the looks alone of what the best of these images show. What that says where the camera is
// tells where the points of all of them should be, and near there looks that are not the only ones of their kind tell
// enough.
std::optional<PlaceMatch> locate_twice(const Map& map, std::span<const KeyImage* const> images, MapId in,
                                       const FeaturesOfImage& features, const RecogniseConfig& config);

}  // namespace coslam
