// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/key_image_database.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <span>

#include "common/geometry/pose_refinement.h"
#include "common/geometry/robust.h"
#include "server/estimator/map/memory.h"
#include "server/estimator/solve/root_sift.h"
#include "server/estimator/solve/start.h"

namespace coslam {
namespace {

// Points behind the features of some key images, with the looks that they had in the best of these.
struct KnownPoints {
  std::vector<PointId> ids;
  std::vector<Eigen::Vector3d> positions;
  std::vector<int> images;  // index among the asked
  std::vector<std::uint8_t> descriptors;
};

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

KnownPoints known_points(const Map& map, MapId of, std::span<const KeyImage* const> asked) {
  KnownPoints out;
  std::vector<ImageKey> images;
  images.reserve(asked.size());
  for (const KeyImage* image : asked) images.emplace_back(image->set, image->camera);
  std::vector<std::size_t> in_order(asked.size());
  std::iota(in_order.begin(), in_order.end(), 0);
  std::ranges::sort(in_order, {}, [&](std::size_t i) { return images[i]; });
  for (const MapPoint* p : map.points_observed_in(images)) {
    if (p->map != of || !p->rests()) continue;
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

// What matched of some known points.
struct Matched {
  std::vector<TrackId> tracks;
  std::vector<int> known;               // index
  std::vector<Eigen::Vector2d> pixels;  // undistorted
};

struct Agreement {
  double sigma_px;  // of a match, at 640 px image width
  int min_inliers;
  double min_hull;  // of the image
};

// The pose that most of the matches agree on.
std::optional<PlaceMatch> locate(const Map& map, CameraId id, std::span<const KeyImage* const> asked, MapId in,
                                 const KnownPoints& known, const Matched& matched, const Agreement& wanted) {
  const MapCamera& camera = map.camera(id);
  std::vector<Eigen::Vector3d> positions;
  const std::vector<Eigen::Vector2d>& pixels = matched.pixels;
  for (const int k : matched.known) positions.push_back(known.positions[static_cast<std::size_t>(k)]);
  const PlaceResult placed = place_camera(camera.model, positions, pixels, wanted.sigma_px, wanted.min_inliers);
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

struct FeaturesOfImage {
  const MapCamera& camera;
  const std::vector<TrackId>& tracks;
  const std::vector<std::uint8_t>& descriptors;
  std::map<TrackId, Eigen::Vector2d> pixels;
};

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

FeaturesOfImage features_of(const DescribedImage& image, const DescriptorReply& reply) {
  FeaturesOfImage out{image.camera, reply.tracks, reply.descriptors, {}};
  for (const auto& [id, px] : image.pixels) out.pixels.emplace_hint(out.pixels.end(), id, px.cast<double>());
  return out;
}

struct NearMatches : Matched {
  std::vector<double> off_px;  // from where the point should appear
};

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

// Known points and features that look most like each other among those near where this pose puts the points.
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

// First by the looks alone of what the best of these images show. What that says where the camera is tells where the
// points of all of them should be, and near there looks that are not the only ones of their kind tell enough.
std::optional<PlaceMatch> locate_twice(const Map& map, std::span<const KeyImage* const> images, MapId in,
                                       const FeaturesOfImage& features, const RecogniseConfig& config) {
  const CameraId id = features.camera.id;
  const auto best = images.first(std::min(images.size(), static_cast<std::size_t>(config.images)));
  const KnownPoints known = known_points(map, in, best);
  const auto first = locate(map, id, best, in, known, match_anywhere(features, known), {1.5, config.min_first, 0});
  if (!first) return std::nullopt;
  const KnownPoints around = known_points(map, in, images);
  const NearMatches near = match_near(features, first->cam_from_world, around, [](PointId) { return true; });
  return locate(map, id, images, in, around, near, {1.5, config.min_inliers, config.min_hull});
}

}  // namespace

void KeyImageDatabase::add(PlaceRecognitionEdit& edit, const DescribedImage& image, const DescriptorReply& reply) {
  if (reply.tracks.empty()) return;
  edit.add_key_image(image.set, image.camera.id);
  images_[index_.add(reply.descriptors)] = {image.set, image.camera.id, reply.tracks, reply.descriptors};
}

void KeyImageDatabase::forget(const std::vector<ImageKey>& views) {
  if (views.empty()) return;
  const std::set<ImageKey> gone(views.begin(), views.end());
  std::erase_if(images_, [&](const auto& entry) {
    const auto& [number, image] = entry;
    if (!gone.contains({image.set, image.camera})) return false;
    index_.remove(number, image.descriptors);
    if (number < saved_) gone_.push_back(number);
    return true;
  });
}

std::size_t KeyImageDatabase::bytes() const {
  std::size_t bytes = index_.bytes();
  for (const auto& [number, i] : images_) bytes += sizeof i + bytes_of(i.tracks) + bytes_of(i.descriptors);
  return bytes;
}

ExpectedPlace KeyImageDatabase::find_expected(const Map& map, const DescribedImage& image, const DescriptorReply& reply,
                                              const std::vector<CameraId>& cameras, SetId since, double gate_px) const {
  const MapCamera& camera = image.camera;
  if (!image.frame().valid()) return {};
  std::vector<const KeyImage*> asked;
  for (const CameraId c : cameras) {
    const auto newest =
        std::find_if(images_.rbegin(), images_.rend(), [&](const auto& i) { return i.second.camera == c; });
    if (newest != images_.rend() && newest->second.set >= since) asked.push_back(&newest->second);
  }
  if (asked.empty()) return {};
  const KnownPoints known = known_points(map, camera.map, asked);
  const NearMatches near = match_near(features_of(image, reply), image.frame().cam_from_world, known,
                                      [&](PointId id) { return !seen_by(*map.find(id), camera.id); });
  ExpectedPlace out;
  for (std::size_t i = 0; i < near.tracks.size(); ++i) {
    if (near.off_px[i] > gate_px) continue;
    out.there.emplace_back(near.tracks[i], known.ids[static_cast<std::size_t>(near.known[i])]);
  }
  if (static_cast<int>(out.there.size()) >= config_.min_expected && 2 * out.there.size() >= near.tracks.size()) {
    return out;
  }
  out.there.clear();
  // Few have to do, so they have to agree well: chance matches lie anywhere in what was searched.
  out.beside = locate(map, camera.id, asked, camera.map, known, near, {0.75, config_.min_beside, 0});
  if (out.beside && 2 * out.beside->matches.size() < near.tracks.size()) out.beside.reset();
  if (out.beside) out.beside->expected = true;
  return out;
}

KeyImageDatabase::Asked KeyImageDatabase::asked_for(const Map& map, const std::vector<std::uint8_t>& descriptors,
                                                    const std::function<bool(const KeyImage&, MapId)>& may_ask) const {
  const std::vector<int> votes = index_.votes(descriptors);
  std::vector<std::pair<int, const KeyImage*>> order;
  for (const auto& [number, image] : images_) {
    const int n = votes[static_cast<std::size_t>(number)];
    if (n < config_.min_votes) continue;
    const FramePose* f = map.camera(image.camera).frame_at(image.set);
    if (!f->valid() || !may_ask(image, f->map)) continue;
    order.emplace_back(n, &image);
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  // The best image names the map; others of it lend their points.
  Asked asked;
  for (const auto& [n, image] : order) {
    const MapId of = map.camera(image->camera).frame_at(image->set)->map;
    if (asked.in == MapId()) asked.in = of;
    if (of == asked.in && static_cast<int>(asked.images.size()) < config_.around) asked.images.push_back(image);
  }
  return asked;
}

std::optional<PlaceMatch> KeyImageDatabase::find(const Map& map, const DescribedImage& image,
                                                 const DescriptorReply& reply,
                                                 const std::function<bool(const KeyImage&, MapId)>& may_ask) const {
  const Asked asked = asked_for(map, reply.descriptors, may_ask);
  if (asked.images.empty()) return std::nullopt;
  return locate_twice(map, asked.images, asked.in, features_of(image, reply), config_);
}

std::vector<const KeyImage*> KeyImageDatabase::images_of(const Map& map, MapId of) const {
  std::vector<const KeyImage*> out;
  for (const auto& [number, image] : images_) {
    const FramePose* f = map.camera(image.camera).frame_at(image.set);
    if (f != nullptr && f->valid() && f->map == of) out.push_back(&image);
  }
  return out;
}

std::set<MapId> KeyImageDatabase::maps(const Map& map) const {
  std::set<MapId> out;
  for (const auto& [number, image] : images_) {
    const FramePose* f = map.camera(image.camera).frame_at(image.set);
    if (f != nullptr && f->valid()) out.insert(f->map);
  }
  return out;
}

std::optional<LoopCandidate> KeyImageDatabase::find_again(
    const Map& map, const KeyImage& image, const std::function<bool(const KeyImage&, MapId)>& may_ask) const {
  const MapId of = map.camera(image.camera).frame_at(image.set)->map;
  const Asked asked = asked_for(map, image.descriptors, may_ask);
  if (asked.images.empty()) return std::nullopt;
  FeaturesOfImage features{map.camera(image.camera), image.tracks, image.descriptors, {}};
  LoopCandidate seen{.image = &image};
  for (const MapPoint* p : map.points_observed_in({{image.set, image.camera}})) {
    for (const KeyObservation& o : p->key_observations) {
      if (o.set != image.set || o.camera != image.camera || p->map != of) continue;
      features.pixels[o.track] = o.undistorted_px.cast<double>();
      seen.own[o.track] = p->id;
    }
  }
  auto place = locate_twice(map, asked.images, asked.in, features, config_);
  if (!place) return std::nullopt;
  seen.place = std::move(*place);
  return seen;
}

void KeyImageDatabase::take_in(const KeyImageDatabase& other, const Renumbered& as) {
  for (const auto& [number, theirs] : other.images_) {
    Renumber(as).apply(images_[index_.add(theirs.descriptors)] = theirs);
  }
}

bool covers_ground(const std::vector<const MapPoint*>& points, double farthest_depth) {
  constexpr std::size_t kLeast = 100;            // points
  constexpr double kAlong = 2.5, kAcross = 0.5;  // distances
  constexpr double kInside = 0.05;               // of the points, on either side, may be strays
  if (points.size() < kLeast) return false;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const MapPoint* p : points) mean += p->position / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const MapPoint* p : points) spread += (p->position - mean) * (p->position - mean).transpose();
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  const auto width = [&](int axis) {
    std::vector<double> along;
    along.reserve(points.size());
    for (const MapPoint* p : points) along.push_back(axes.col(axis).dot(p->position - mean));
    std::ranges::sort(along);
    const auto strays = static_cast<std::size_t>(kInside * static_cast<double>(along.size()));
    return along[along.size() - 1 - strays] - along[strays];
  };
  return width(2) > kAlong * farthest_depth && width(1) > kAcross * farthest_depth;
}

bool has_relief(const std::vector<const MapPoint*>& points, double median_depth) {
  constexpr double kFlat = 0.03;        // of the distance
  constexpr double kSigmas = 3;         // of a point along the plane's normal
  constexpr std::size_t kLeastOff = 6;  // points: more than are mismatched
  constexpr int kTries = 100;
  if (points.size() < 4) return false;
  std::mt19937 random(1);
  std::size_t least_off = points.size();
  for (int i = 0; i < kTries; ++i) {
    const auto any = [&] { return points[random() % points.size()]->position; };
    const Eigen::Vector3d a = any(), b = any(), c = any();
    const Eigen::Vector3d n = (b - a).cross(c - a);
    if (n.norm() < 1e-9 * median_depth * median_depth) continue;
    const Eigen::Vector3d normal = n.normalized();
    const auto off = static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const MapPoint* p) {
      const double sigma = std::sqrt(std::max(0.0, normal.dot(p->covariance * normal)));
      return std::abs(normal.dot(p->position - a)) > std::max(kFlat * median_depth, kSigmas * sigma);
    }));
    least_off = std::min(least_off, off);
  }
  return least_off >= kLeastOff;
}

}  // namespace coslam
