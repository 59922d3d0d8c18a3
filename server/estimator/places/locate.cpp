// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/locate.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "common/geometry/pose_refinement.h"
#include "common/geometry/robust.h"
#include "server/estimator/solve/matching.h"
#include "server/estimator/solve/pnp.h"
#include "server/estimator/solve/root_sift.h"

namespace coslam {
namespace {

// The first of these images that describes the point, and at which of its tracks; `in_order`: their indices, ascending
// by set and camera.
struct DescribedIn {
  std::size_t image, track;
};
std::optional<DescribedIn> described_in(const MapPoint& p, std::span<const KeyImage* const> images,
                                        const std::vector<std::size_t>& in_order) {
  std::optional<DescribedIn> first;
  const auto key = [](const auto& o) { return std::pair(o.set, o.camera); };
  auto seen = p.key_observations.begin();
  for (const std::size_t i : in_order) {
    const KeyImage& image = *images[i];
    seen = std::find_if(seen, p.key_observations.end(), [&](const auto& o) { return key(o) >= key(image); });
    if (seen == p.key_observations.end()) break;
    if (key(*seen) != key(image) || (first && first->image < i)) continue;
    const auto track = std::ranges::lower_bound(image.tracks, seen->track);
    if (track == image.tracks.end() || *track != seen->track) continue;
    first = {i, static_cast<std::size_t>(track - image.tracks.begin())};
  }
  return first;
}

Matched match_anywhere(const FeaturesOfImage& image, const KnownPoints& known) {
  Matched out;
  for (const FeatureMatch& m : match_descriptors(image.descriptors, known.descriptors)) {
    const TrackId track = image.tracks[static_cast<std::size_t>(m.first)];
    const auto pixel = image.pixels.find(track);
    if (pixel == image.pixels.end()) continue;
    out.tracks.push_back(track);
    out.known.push_back(m.second);
    out.pixels.push_back(pixel->second);
  }
  return out;
}

// The nearest by its looks among those near by place, and how near the second is.
struct NearestLooks {
  std::size_t other = 0;
  float first = 2, second = 2;  // squared distances
  double off_px = 0;

  void offer(std::size_t index, float d2, double px) {
    if (d2 < first) {
      second = first;
      first = d2;
      other = index;
      off_px = px;
    } else {
      second = std::min(second, d2);
    }
  }
  bool distinct() const { return first < kDistinctRatio * kDistinctRatio * second; }
};

}  // namespace

KnownPoints known_points(const Map& map, MapId map_id, std::span<const KeyImage* const> asked) {
  KnownPoints out;
  std::vector<ImageKey> images;
  images.reserve(asked.size());
  for (const KeyImage* image : asked) images.emplace_back(image->set, image->camera);
  std::vector<std::size_t> in_order(asked.size());
  std::iota(in_order.begin(), in_order.end(), 0);
  std::ranges::sort(in_order, {}, [&](std::size_t i) { return images[i]; });
  for (const MapPoint* p : map.points_observed_in(images)) {
    if (p->map != map_id || !p->rests()) continue;
    const auto described = described_in(*p, asked, in_order);
    if (!described) continue;
    out.ids.push_back(p->id);
    out.positions.push_back(p->position);
    out.images.push_back(static_cast<int>(described->image));
    const auto& bytes = asked[described->image]->descriptors;
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(described->track * kDescriptorBytes);
    out.descriptors.insert(out.descriptors.end(), begin, begin + kDescriptorBytes);
  }
  return out;
}

std::optional<PlaceMatch> locate(const Map& map, CameraId id, std::span<const KeyImage* const> asked, MapId in,
                                 const KnownPoints& known, const Matched& matched, const Agreement& wanted) {
  const MapCamera& camera = map.camera(id);
  std::vector<Eigen::Vector3d> positions;
  const std::vector<Eigen::Vector2d>& pixels = matched.pixels;
  for (const int k : matched.known) positions.push_back(known.positions[static_cast<std::size_t>(k)]);
  const PnpResult placed = solve_pnp(camera.model, positions, pixels, wanted.sigma_px, wanted.min_inliers);
  if (!placed.ok) return std::nullopt;
  PlaceMatch out{.map = in, .cam_from_world = placed.cam_from_world};
  std::vector<Eigen::Vector2d> spread;
  std::vector<double> depths;
  std::vector<int> by_image(asked.size(), 0);
  for (const int inlier : placed.inliers) {
    const auto i = static_cast<std::size_t>(inlier);
    const auto k = static_cast<std::size_t>(matched.known[i]);
    out.matches.emplace_back(matched.tracks[i], known.ids[k]);
    spread.push_back(pixels[i]);
    depths.push_back((placed.cam_from_world * positions[i]).z());
    ++by_image[static_cast<std::size_t>(known.images[k])];
  }
  if (hull_fraction(spread, camera.model) < wanted.min_hull) return std::nullopt;
  const auto best = static_cast<std::size_t>(std::max_element(by_image.begin(), by_image.end()) - by_image.begin());
  out.key_camera = asked[best]->camera;
  out.key_set = asked[best]->set;
  out.median_depth = upper_median(depths);
  return out;
}

FeaturesOfImage features_of(const DescribedImage& image, const DescriptorReply& reply) {
  FeaturesOfImage out{image.camera, reply.tracks, reply.descriptors, {}};
  for (const auto& [id, px] : image.pixels) out.pixels.emplace_hint(out.pixels.end(), id, px.cast<double>());
  return out;
}

NearMatches match_near(const FeaturesOfImage& image, const Rigid3& cam_from_world, const KnownPoints& known,
                       const std::function<bool(PointId)>& may_match) {
  constexpr double kSearch = 0.03;  // of the image width
  const Descriptors features = root_sift(image.descriptors), points = root_sift(known.descriptors);
  std::vector<Eigen::Vector2d> pixels;
  for (const TrackId id : image.tracks) {
    const auto at = image.pixels.find(id);
    pixels.push_back(at == image.pixels.end() ? Eigen::Vector2d::Constant(std::nan("")) : at->second);
  }
  std::vector<NearestLooks> of_point(known.ids.size()), of_feature(pixels.size());
  for (std::size_t p = 0; p < known.ids.size(); ++p) {
    Eigen::Vector2d px;
    if (!may_match(known.ids[p])) continue;
    if (!project_world(image.camera.model, cam_from_world, known.positions[p], &px)) continue;
    for (std::size_t f = 0; f < pixels.size(); ++f) {
      const double off_px = (pixels[f] - px).norm();
      if (!(off_px < kSearch * image.camera.model.width_px)) continue;
      const float d2 = 2 - 2 * points.row(static_cast<Eigen::Index>(p)).dot(features.row(static_cast<Eigen::Index>(f)));
      of_point[p].offer(f, d2, off_px);
      of_feature[f].offer(p, d2, off_px);
    }
  }
  NearMatches out;
  for (std::size_t p = 0; p < known.ids.size(); ++p) {
    const NearestLooks& best = of_point[p];
    constexpr float kMost = 0.5F;  // squared: where nothing else is near, there is no second best to compare with
    if (best.first > kMost || !best.distinct() || !of_feature[best.other].distinct()) continue;
    if (of_feature[best.other].other != p) continue;
    out.tracks.push_back(image.tracks[best.other]);
    out.known.push_back(static_cast<int>(p));
    out.pixels.push_back(pixels[best.other]);
    out.off_px.push_back(best.off_px);
  }
  return out;
}

std::optional<PlaceMatch> locate_twice(const Map& map, std::span<const KeyImage* const> images, MapId in,
                                       const FeaturesOfImage& features, const RecogniseConfig& config) {
  const CameraId id = features.camera.id;
  const auto best = images.first(std::min(images.size(), static_cast<std::size_t>(config.images)));
  const KnownPoints known = known_points(map, in, best);
  const auto first =
      locate(map, id, best, in, known, match_anywhere(features, known), {kMatchSigma_px, config.min_first, 0});
  if (!first) return std::nullopt;
  const KnownPoints around = known_points(map, in, images);
  const NearMatches near = match_near(features, first->cam_from_world, around, [](PointId) { return true; });
  return locate(map, id, images, in, around, near, {kMatchSigma_px, config.min_inliers, config.min_hull});
}

}  // namespace coslam
