// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/relative_pose.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/geometry/robust.h"
#include "common/geometry/triangulation.h"
#include "server/estimator/solve/two_view.h"

namespace coslam {
namespace {

std::vector<Eigen::Vector2d> normalized(const FeatureImage& image, const std::vector<FeatureMatch>& matches,
                                        bool second) {
  std::vector<Eigen::Vector2d> out;
  for (const FeatureMatch& m : matches) {
    const auto feature = static_cast<std::size_t>(second ? m.second : m.first);
    out.push_back(image.camera.normalized_from_pixel(image.undistorted_px[feature]));
  }
  return out;
}

// What fits a motion that is known.
TwoViewMotion known_motion(const Rigid3& second_from_first, const std::vector<Eigen::Vector2d>& a,
                           const std::vector<Eigen::Vector2d>& b, double threshold) {
  TwoViewMotion out;
  out.second_from_first = second_from_first;
  const Eigen::Matrix3d essential = skew(second_from_first.translation) * second_from_first.rotation.toRotationMatrix();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d line = essential * a[i].homogeneous();
    const double off = std::abs(b[i].homogeneous().dot(line)) / std::max(1e-12, line.head<2>().norm());
    out.fits.push_back(off < threshold);
    out.support += out.fits.back() ? 1 : 0;
  }
  return out;
}

// Matches that fit a known motion and lie in front of both cameras, or are too far away to tell.
int in_front(const TwoViewMotion& known, const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b,
             double threshold) {
  const Eigen::Vector3d& t = known.second_from_first.translation;
  int out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d far = known.second_from_first.rotation * a[i].homogeneous();
    if (!known.fits[i] || far.z() <= 0) continue;
    const Eigen::Vector2d at = far.hnormalized(), nearer = t.head<2>() - t.z() * at;
    out += (b[i] - at).dot(nearer.normalized()) > -threshold ? 1 : 0;
  }
  return out;
}

// As the rig has it; as the images have it where they contradict that: then the rig is not as it was given.
TwoViewMotion motion_of_rig(const Rigid3& second_from_first, const std::vector<Eigen::Vector2d>& a,
                            const std::vector<Eigen::Vector2d>& b, double threshold, bool* as_given) {
  TwoViewMotion known = known_motion(second_from_first, a, b, threshold);
  const int support = in_front(known, a, b, threshold);
  *as_given = true;
  if (2 * support >= static_cast<int>(a.size())) return known;
  auto seen = two_view_motion(a, b, threshold);
  *as_given = !seen || seen->support <= 2 * support;
  return *as_given ? known : *seen;
}

}  // namespace

std::optional<RelativePose> relative_pose(const std::vector<FeatureImage>& images, int a, int b,
                                          const std::vector<FeatureMatch>& matches, const StartConfig& config) {
  const auto &ia = images[static_cast<std::size_t>(a)], &ib = images[static_cast<std::size_t>(b)];
  if (static_cast<int>(matches.size()) < config.min_matches) return std::nullopt;
  const auto pa = normalized(ia, matches, false), pb = normalized(ib, matches, true);
  const double threshold = 2.0 * config.sigma_px * width_scale(ia.camera) / ia.camera.focal_px();
  const std::optional<Rigid3> rig = by_rig(ia, ib);
  bool known = false;
  const std::optional<TwoViewMotion> motion =
      rig ? motion_of_rig(*rig, pa, pb, threshold, &known) : two_view_motion(pa, pb, threshold);
  if (!motion || motion->support < config.min_matches) return std::nullopt;
  RelativePose pair{.first = a, .second = b};
  pair.second_from_first = motion->second_from_first;

  std::vector<double> parallax;
  std::set<std::pair<int, int>> cells;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!motion->fits[i]) continue;
    const View views[] = {
        {&ia.camera, {}, ia.undistorted_px[static_cast<std::size_t>(matches[i].first)]},
        {&ib.camera, pair.second_from_first, ib.undistorted_px[static_cast<std::size_t>(matches[i].second)]}};
    const double cosine = world_ray(views[0]).dot(world_ray(views[1]));
    parallax.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)));
    pair.inliers.push_back(matches[i]);
    cells.insert({static_cast<int>(8 * views[0].undistorted_px.x() / ia.camera.width_px),
                  static_cast<int>(6 * views[0].undistorted_px.y() / ia.camera.height_px)});
  }
  pair.median_parallax_rad = upper_median(parallax);
  pair.metric = known;
  // A rig sees far things with little parallax, and knows nonetheless where they are.
  if (!known && pair.median_parallax_rad < config.min_parallax_rad) return std::nullopt;
  // Many, spread over the image, and with depth to be gained up to about 8 degrees.
  pair.score = static_cast<double>(pair.inliers.size()) * std::sqrt(static_cast<double>(cells.size())) *
               std::min(pair.median_parallax_rad, 0.14);
  return pair;
}

}  // namespace coslam
