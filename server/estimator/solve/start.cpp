// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/start.h"

#include <algorithm>
#include <map>

#include "common/geometry/triangulation.h"
#include "server/estimator/solve/bundle.h"
#include "server/estimator/solve/partners.h"
#include "server/estimator/solve/pnp.h"
#include "server/estimator/solve/relative_pose.h"

namespace coslam {
namespace {

// Points under construction: features that are the same thing, over all images.
class Correspondences {
 public:
  explicit Correspondences(std::size_t images) : point_by_feature_(images) {}
  int point_of(int image, int feature) const {
    const auto& m = point_by_feature_[static_cast<std::size_t>(image)];
    const auto at = m.find(feature);
    return at == m.end() ? -1 : at->second;
  }
  void assign(int image, int feature, int point) {
    point_by_feature_[static_cast<std::size_t>(image)][feature] = point;
  }

 private:
  std::vector<std::map<int, int>> point_by_feature_;
};

void triangulate_pair(const std::vector<FeatureImage>& images, int a, int b, const std::vector<FeatureMatch>& matches,
                      const StartConfig& config, StartResult* result, Correspondences* links) {
  const auto &ia = images[static_cast<std::size_t>(a)], &ib = images[static_cast<std::size_t>(b)];
  for (const FeatureMatch& m : matches) {
    if (links->point_of(a, m.first) >= 0 || links->point_of(b, m.second) >= 0) continue;
    const View views[] = {{&ia.camera, *result->cam_from_world[static_cast<std::size_t>(a)],
                           ia.undistorted_px[static_cast<std::size_t>(m.first)]},
                          {&ib.camera, *result->cam_from_world[static_cast<std::size_t>(b)],
                           ib.undistorted_px[static_cast<std::size_t>(m.second)]}};
    const TriangulationResult t = triangulate(views, config.sigma_px, 0.5 * config.min_parallax_rad);
    if (t.status != TriangulationStatus::kOk || t.max_error_px > 3 * config.sigma_px * width_scale(ia.camera)) continue;
    const int point = static_cast<int>(result->points.size());
    result->points.push_back({t.position, {{a, m.first}, {b, m.second}}});
    links->assign(a, m.first, point);
    links->assign(b, m.second, point);
  }
}

// Adds image c: its matches with placed images that have points give 2D-3D pairs.
bool add_image(const std::vector<FeatureImage>& images, int c, const Partners& partners, const StartConfig& config,
               StartResult* result, Correspondences* links) {
  const FeatureImage& image = images[static_cast<std::size_t>(c)];
  std::map<int, int> point_of_feature;
  std::vector<std::pair<int, std::vector<FeatureMatch>>> all_matches;
  for (std::size_t p = 0; p < images.size(); ++p) {
    if (!result->cam_from_world[p] || !partners.are(static_cast<int>(p), c)) continue;
    all_matches.emplace_back(static_cast<int>(p), match_descriptors(images[p].descriptors, image.descriptors));
    for (const FeatureMatch& m : all_matches.back().second) {
      const int point = links->point_of(static_cast<int>(p), m.first);
      if (point >= 0) point_of_feature.emplace(m.second, point);
    }
  }
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  std::vector<std::pair<int, int>> feature_point;
  for (const auto& [feature, point] : point_of_feature) {
    points.push_back(result->points[static_cast<std::size_t>(point)].position);
    pixels.push_back(image.undistorted_px[static_cast<std::size_t>(feature)]);
    feature_point.emplace_back(feature, point);
  }
  const PnpResult placed = solve_pnp(image.camera, points, pixels, config.sigma_px, config.min_matches / 2);
  if (!placed.ok) return false;
  result->cam_from_world[static_cast<std::size_t>(c)] = placed.cam_from_world;
  for (const int i : placed.inliers) {
    const auto [feature, point] = feature_point[static_cast<std::size_t>(i)];
    auto& seen = result->points[static_cast<std::size_t>(point)].seen;
    if (std::any_of(seen.begin(), seen.end(), [&](const auto& s) { return s.first == c; })) continue;
    seen.emplace_back(c, feature);
    links->assign(c, feature, point);
  }
  for (const auto& [p, matches] : all_matches) triangulate_pair(images, p, c, matches, config, result, links);
  return true;
}

void adjust(const std::vector<FeatureImage>& images, const StartConfig& config, StartResult* result) {
  BundleProblem problem;
  std::vector<int> pose_of(images.size(), -1);
  for (std::size_t i = 0; i < images.size(); ++i) {
    problem.cameras.push_back(images[i].camera);
    if (!result->cam_from_world[i]) continue;
    pose_of[i] = static_cast<int>(problem.poses.size());
    problem.poses.push_back({*result->cam_from_world[i], static_cast<int>(i), static_cast<int>(i) == result->first});
  }
  std::vector<std::pair<std::size_t, std::size_t>> observation_at;
  for (std::size_t p = 0; p < result->points.size(); ++p) {
    problem.points.push_back(result->points[p].position);
    for (std::size_t s = 0; s < result->points[p].seen.size(); ++s) {
      const auto [image, feature] = result->points[p].seen[s];
      const FeatureImage& f = images[static_cast<std::size_t>(image)];
      problem.observations.push_back({pose_of[static_cast<std::size_t>(image)], static_cast<int>(p),
                                      f.undistorted_px[static_cast<std::size_t>(feature)],
                                      config.sigma_px * width_scale(f.camera)});
      observation_at.emplace_back(p, s);
    }
  }
  for (std::size_t a = 0; a < images.size(); ++a) {
    for (std::size_t b = a + 1; b < images.size() && result->metric; ++b) {
      const auto tie = by_rig(images[a], images[b]);
      if (tie && pose_of[a] >= 0 && pose_of[b] >= 0) problem.ties.push_back({pose_of[a], pose_of[b], *tie});
    }
  }
  BundleResult solved = solve_bundle(problem, {.max_iterations = 30});
  if (!solved.usable) return;
  fix_gauge(problem, pose_of[static_cast<std::size_t>(result->first)],
            pose_of[static_cast<std::size_t>(result->second)], &solved);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (pose_of[i] >= 0) result->cam_from_world[i] = solved.poses[static_cast<std::size_t>(pose_of[i])];
  }
  std::vector<StartResult::Point> points(result->points.size());
  for (std::size_t p = 0; p < points.size(); ++p) points[p].position = solved.points[p];
  for (std::size_t i = 0; i < observation_at.size(); ++i) {
    if (solved.is_inlier[i])
      points[observation_at[i].first].seen.push_back(
          result->points[observation_at[i].first].seen[observation_at[i].second]);
  }
  std::erase_if(points, [](const StartResult::Point& p) { return p.seen.size() < 2; });
  result->points = std::move(points);
}

}  // namespace

std::optional<Rigid3> by_rig(const FeatureImage& first, const FeatureImage& second) {
  if (first.rig.empty() || first.rig != second.rig) return std::nullopt;
  return second.cam_from_rig * first.cam_from_rig.inverse();
}

StartResult start_map(const std::vector<FeatureImage>& images, const StartConfig& config, Workers& workers) {
  StartResult result;
  result.cam_from_world.resize(images.size());
  const Partners partners(images);
  const std::vector<std::pair<int, int>> compared = partners.pairs();
  std::vector<std::optional<RelativePose>> pairs(compared.size());
  workers.each(compared.size(), [&](std::size_t i) {
    const auto [a, b] = compared[i];
    const auto matches = match_descriptors(images[static_cast<std::size_t>(a)].descriptors,
                                           images[static_cast<std::size_t>(b)].descriptors);
    pairs[i] = relative_pose(images, a, b, matches, config);
  });
  std::optional<RelativePose> best;
  for (std::optional<RelativePose>& pair : pairs) {
    if (!pair) continue;
    if (!best || std::pair(pair->metric, pair->score) > std::pair(best->metric, best->score)) best = std::move(pair);
  }
  if (!best) {
    result.reason = "no two cameras share enough view with enough parallax";
    return result;
  }
  result.first = best->first;
  result.second = best->second;
  result.metric = best->metric;
  result.cam_from_world[static_cast<std::size_t>(best->first)] = Rigid3();
  result.cam_from_world[static_cast<std::size_t>(best->second)] = best->second_from_first;
  Correspondences links(images.size());
  triangulate_pair(images, best->first, best->second, best->inliers, config, &result, &links);
  adjust(images, config, &result);
  links = Correspondences(images.size());
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    for (const auto& [image, feature] : result.points[p].seen) links.assign(image, feature, static_cast<int>(p));
  }
  for (bool added = true; added;) {
    added = false;
    for (int c = 0; c < static_cast<int>(images.size()); ++c) {
      if (result.cam_from_world[static_cast<std::size_t>(c)]) continue;
      added |= add_image(images, c, partners, config, &result, &links);
    }
  }
  adjust(images, config, &result);
  result.ok = static_cast<int>(result.points.size()) >= config.min_matches;
  if (!result.ok) result.reason = "too few points after the first bundle adjustment";
  return result;
}

StartResult start_from_matches(const FeatureImage& first, const FeatureImage& second,
                               const std::vector<FeatureMatch>& matches, const StartConfig& config) {
  StartResult result;
  const std::vector<FeatureImage> images{first, second};
  result.cam_from_world.resize(2);
  result.second = 1;
  const std::optional<RelativePose> pair = relative_pose(images, 0, 1, matches, config);
  if (!pair) {
    result.reason = "too little parallax in one camera's motion";
    return result;
  }
  result.cam_from_world[0] = Rigid3();
  result.cam_from_world[1] = pair->second_from_first;
  Correspondences links(2);
  triangulate_pair(images, 0, 1, pair->inliers, config, &result, &links);
  adjust(images, config, &result);
  result.ok = result.points.size() >= 40 && result.points.size() * 2 >= matches.size();
  if (!result.ok) result.reason = "too few points from one camera's motion";
  return result;
}

}  // namespace coslam
