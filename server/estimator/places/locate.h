// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "server/estimator/map/map.h"
#include "server/estimator/places/described_image.h"
#include "server/estimator/places/key_image.h"

// Localises a camera by the points behind key images: features are matched by their descriptors, and PnP gives the pose
// that most of the matches agree on.
namespace coslam {

// Points behind the features of some key images, with the looks that they had in the best of these.
struct KnownPoints {
  std::vector<PointId> ids;
  std::vector<Eigen::Vector3d> positions;
  std::vector<int> images;  // index among the asked
  std::vector<std::uint8_t> descriptors;
};
// Collects the points of a map that these images describe.
KnownPoints known_points(const Map& map, MapId map_id, std::span<const KeyImage* const> asked);

// Known points that features of an image were matched with.
struct Matched {
  std::vector<TrackId> tracks;
  std::vector<int> known;               // index
  std::vector<Eigen::Vector2d> pixels;  // undistorted
};

struct NearMatches : Matched {
  std::vector<double> off_px;  // distances from where the points should appear
};

// Features of an image of which the descriptors came.
struct FeaturesOfImage {
  const MapCamera& camera;
  const std::vector<TrackId>& tracks;
  const std::vector<std::uint8_t>& descriptors;
  std::map<TrackId, Eigen::Vector2d> pixels;
};
FeaturesOfImage features_of(const DescribedImage& image, const DescriptorReply& reply);

// Standard deviation of a match by looks, at 640 px image width.
inline constexpr double kMatchSigma_px = 1.5;

// Conditions under which a pose is believed.
struct Agreement {
  double sigma_px;  // standard deviation of a match, at 640 px image width
  int min_inliers;
  double min_hull;  // least share of the image that the matches cover
};

// Finds the pose that most of the matches agree on.
std::optional<PlaceMatch> locate(const Map& map, CameraId id, std::span<const KeyImage* const> asked, MapId in,
                                 const KnownPoints& known, const Matched& matched, const Agreement& wanted);
// Matches known points with the most similar features among those near where this pose projects the points.
NearMatches match_near(const FeaturesOfImage& image, const Rigid3& cam_from_world, const KnownPoints& known,
                       const std::function<bool(PointId)>& may_match);
// Finds the pose first by appearance alone, from what the best of these images show. That pose tells where the points
// of all of them should be, and near there features that are not the only ones of their kind tell enough.
std::optional<PlaceMatch> locate_twice(const Map& map, std::span<const KeyImage* const> images, MapId in,
                                       const FeaturesOfImage& features, const RecogniseConfig& config);

}  // namespace coslam
