// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/masks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "deploy/coslam/export/point_colors.h"

namespace coslam::exporting {
namespace {

// Points at one instant that move as one; or one by itself.
using Bodies = std::vector<std::vector<Eigen::Vector3d>>;

class MovingThings {
 public:
  explicit MovingThings(const ResultFolder& result) {
    std::map<std::pair<TimeNs, PointId>, ObjectId> object_of;
    if (std::filesystem::exists(result.objects())) {
      for_each_object_row(result.objects(), [&](const ResultObjectRow& row) {
        for (const PointId id : row.members) object_of[{row.t_ns, id}] = row.object;
      });
    }
    if (!std::filesystem::exists(result.dynamic())) return;
    std::map<TimeNs, std::map<ObjectId, std::vector<Eigen::Vector3d>>> objects;
    for_each_dynamic_row(result.dynamic(), [&](const ResultDynamicRow& row) {
      const auto object = object_of.find({row.t_ns, row.id});
      if (object != object_of.end()) {
        objects[row.t_ns][object->second].push_back(row.position);
      } else {
        bodies_[row.t_ns].push_back({row.position});
      }
    });
    for (auto& [t_ns, objects_at_t] : objects) {
      for (auto& [id, points] : objects_at_t) bodies_[t_ns].push_back(std::move(points));
    }
  }

  bool empty() const { return bodies_.empty(); }
  // Of the instant that is nearest, if it is near.
  const Bodies& at(TimeNs t_ns) const {
    constexpr TimeNs kNear_ns = 50'000'000;
    static const Bodies kNone;
    auto after = bodies_.lower_bound(t_ns);
    if (after != bodies_.begin() && (after == bodies_.end() || t_ns - std::prev(after)->first < after->first - t_ns)) {
      --after;
    }
    return after == bodies_.end() || std::abs(after->first - t_ns) > kNear_ns ? kNone : after->second;
  }

 private:
  std::map<TimeNs, Bodies> bodies_;
};

// Corners lie within what moves: its outline is farther out by about so much of the image's width.
constexpr double kBeyondCorners = 0.03;

void darken(const std::vector<Eigen::Vector3d>& body, const ColmapModel::Image& image, const CameraModel& camera,
            cv::Mat* mask) {
  std::vector<cv::Point> px;
  for (const Eigen::Vector3d& p : body) {
    const Eigen::Vector3d in_cam = image.cam_from_world * p;
    if (in_cam.z() <= 0) continue;
    const Eigen::Vector2d at = camera.project(in_cam);
    if (camera.contains_raw(at, -camera.width_px)) px.emplace_back(std::lround(at.x()), std::lround(at.y()));
  }
  if (px.empty()) return;
  const int beyond_px = static_cast<int>(std::lround(kBeyondCorners * camera.width_px));
  std::vector<cv::Point> hull;
  cv::convexHull(px, hull);
  cv::fillConvexPoly(*mask, hull, cv::Scalar(0));
  for (std::size_t i = 0; i < hull.size(); ++i) {
    cv::line(*mask, hull[i], hull[(i + 1) % hull.size()], cv::Scalar(0), 2 * beyond_px, cv::LINE_8);
    cv::circle(*mask, hull[i], beyond_px, cv::Scalar(0), cv::FILLED);
  }
}

}  // namespace

bool write_masks(const ResultFolder& result, const ColmapModel& model, const std::filesystem::path& folder) {
  const MovingThings moving(result);
  if (moving.empty()) return false;
  for (const ColmapModel::Image& image : model.images) {
    const CameraModel& camera = model.camera_of(image);
    cv::Mat mask(camera.height_px, camera.width_px, CV_8U, cv::Scalar(255));
    for (const auto& body : moving.at(image.t_ns)) darken(body, image, camera, &mask);
    write_image(folder / (image.name + ".png"), mask);
  }
  return true;
}

}  // namespace coslam::exporting
