// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <map>
#include <unordered_map>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "common/dataset/file.h"
#include "common/dataset/trajectory.h"
#include "deploy/tools/export/export.h"

namespace coslam::exporting {
namespace {

// The centre of COLMAP's first pixel is (0.5, 0.5), ours is (0, 0).
constexpr double kPixelCenter = 0.5;

struct Observation {
  Eigen::Vector2d raw_px;
  PointId point;  // 0 = none
};

struct ColmapImage {
  int id = 0;
  int camera = 0;
  std::string name;
  Rigid3 cam_from_world;
  std::vector<Observation> observations;
};

struct TrackElement {
  std::size_t image;  // index
  std::size_t observation;
};

struct Model {
  std::vector<CameraModel> cameras;  // id = index + 1
  std::vector<ColmapImage> images;
  std::unordered_map<PointId, ResultPoint> points;
  std::map<PointId, std::vector<TrackElement>> tracks;
};

void read_agent(Model& model, const ResultFolder& result, const SequenceAgent& agent) {
  constexpr TimeNs kMaxGap_ns = 1;  // only frames with a pose of their own
  const Trajectory trajectory = load_tum(result.trajectory(agent.name));
  model.cameras.push_back(load_calibration(agent.calibration));
  std::map<FrameId, std::size_t> image_of;
  for_each_track_row(result.tracks(agent.name), [&](const ResultTrackRow& row) {
    auto known = image_of.find(row.frame);
    if (known == image_of.end()) {
      const auto pose = pose_at(trajectory, row.t_ns, kMaxGap_ns);
      if (!pose) return;
      char name[64];
      std::snprintf(name, sizeof name, "%s/%06u.png", agent.name.c_str(), row.frame.value);
      known = image_of.emplace(row.frame, model.images.size()).first;
      const int id = static_cast<int>(model.images.size()) + 1;
      model.images.push_back({id, static_cast<int>(model.cameras.size()), name, *pose, {}});
    }
    const bool mapped = row.state == PointState::kStatic && model.points.contains(row.point);
    model.images[known->second].observations.push_back({row.raw_px, mapped ? row.point : PointId()});
  });
}

// COLMAP's points have two observations at least; others lose theirs.
void link_points(Model& model) {
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    for (std::size_t k = 0; k < model.images[i].observations.size(); ++k) {
      const PointId point = model.images[i].observations[k].point;
      if (point != PointId()) model.tracks[point].push_back({i, k});
    }
  }
  std::erase_if(model.tracks, [&](const auto& track) {
    if (track.second.size() >= 2) return false;
    for (const TrackElement& e : track.second) model.images[e.image].observations[e.observation].point = PointId();
    return true;
  });
}

std::string printed(const char* format, auto... values) {
  char text[512];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string camera_text(int id, const CameraModel& c) {
  const auto& k = c.coefficients;
  const bool high_order = k[4] != 0 || k[5] != 0 || k[6] != 0 || k[7] != 0;
  const char* model = "PINHOLE";
  int coefficients = 0;
  if (c.distortion == DistortionModel::kEquidistant) {
    model = "OPENCV_FISHEYE";
    coefficients = 4;
  } else if (c.distortion == DistortionModel::kDoubleSphere || c.distortion == DistortionModel::kOmni) {
    throw UserError("COLMAP has no model for the lens of camera " + std::to_string(id) + " (double sphere or omni)");
  } else if (c.distortion == DistortionModel::kRadTan) {
    model = high_order ? "FULL_OPENCV" : "OPENCV";
    coefficients = high_order ? 8 : 4;
  }
  std::string text = printed("%d %s %d %d %.10g %.10g %.10g %.10g", id, model, c.width_px, c.height_px, c.fx, c.fy,
                             c.cx + kPixelCenter, c.cy + kPixelCenter);
  for (int i = 0; i < coefficients; ++i) text += printed(" %.10g", k[static_cast<std::size_t>(i)]);
  return text + "\n";
}

std::string image_text(const ColmapImage& image) {
  const Eigen::Quaterniond& q = image.cam_from_world.rotation;
  const Eigen::Vector3d& t = image.cam_from_world.translation;
  std::string text = printed("%d %.9f %.9f %.9f %.9f %.9f %.9f %.9f %d %s\n", image.id, q.w(), q.x(), q.y(), q.z(),
                             t.x(), t.y(), t.z(), image.camera, image.name.c_str());
  for (std::size_t i = 0; i < image.observations.size(); ++i) {
    const Observation& o = image.observations[i];
    const long long point = o.point == PointId() ? -1 : static_cast<long long>(o.point.value);
    text +=
        printed("%s%.3f %.3f %lld", i == 0 ? "" : " ", o.raw_px.x() + kPixelCenter, o.raw_px.y() + kPixelCenter, point);
  }
  return text + "\n";
}

// Mean distance in raw pixels between the observations and the projected point; -1 behind a camera.
double reprojection_error_px(const Model& model, const Eigen::Vector3d& position,
                             const std::vector<TrackElement>& track) {
  double sum = 0;
  for (const TrackElement& e : track) {
    const ColmapImage& image = model.images[e.image];
    const CameraModel& camera = model.cameras[static_cast<std::size_t>(image.camera - 1)];
    const Eigen::Vector3d in_cam = image.cam_from_world * position;
    if (in_cam.z() <= 0) return -1;
    sum += (camera.raw_from_undistorted(camera.project(in_cam)) - image.observations[e.observation].raw_px).norm();
  }
  return sum / static_cast<double>(track.size());
}

std::string point_text(const Model& model, PointId id, const std::vector<TrackElement>& track) {
  const ResultPoint& p = model.points.at(id);
  std::string text = printed("%u %.9g %.9g %.9g %d %d %d %.4f", id.value, p.position.x(), p.position.y(),
                             p.position.z(), p.grey, p.grey, p.grey, reprojection_error_px(model, p.position, track));
  for (const TrackElement& e : track) text += printed(" %d %zu", model.images[e.image].id, e.observation);
  return text + "\n";
}

}  // namespace

Files export_colmap(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder) {
  Model model;
  for (const ResultPoint& point : read_points(map.folder.points())) {
    if (point.state == PointState::kStatic) model.points.emplace(point.id, point);
  }
  for (const SequenceAgent& agent : sequence.agents) {
    if (std::ranges::find(map.agents, agent.name) != map.agents.end()) read_agent(model, map.folder, agent);
  }
  if (model.images.empty())
    throw UserError(map.folder.path().string() + ": no image of the sequence has a pose and tracks");
  link_points(model);

  Files files = {folder / "cameras.txt", folder / "images.txt", folder / "points3D.txt"};
  std::ofstream cameras = create_file(files[0]);
  cameras << "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  for (std::size_t i = 0; i < model.cameras.size(); ++i)
    cameras << camera_text(static_cast<int>(i) + 1, model.cameras[i]);
  close_file(cameras, files[0]);
  std::ofstream images = create_file(files[1]);
  images << "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n";
  for (const ColmapImage& image : model.images) images << image_text(image);
  close_file(images, files[1]);
  std::ofstream points = create_file(files[2]);
  points << "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  for (const auto& [id, track] : model.tracks) points << point_text(model, id, track);
  close_file(points, files[2]);
  return files;
}

}  // namespace coslam::exporting
