// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/export/colmap_model.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>
#include <unordered_map>

#include "common/dataset/calibration.h"
#include "common/dataset/trajectory.h"

namespace coslam::exporting {
namespace {

std::vector<ResultTrackRow> track_rows(const ResultFolder& result, const std::string& agent) {
  std::vector<ResultTrackRow> rows;
  for_each_track_row(result.tracks(agent), [&](const ResultTrackRow& row) { rows.push_back(row); });
  return rows;
}

// Which point each row shows: its own, or else the one that its track showed later, for points are made, and become
// parts of others, after their tracks were first seen.
std::vector<PointId> shown_points(const ColmapModel& model, const std::vector<ResultTrackRow>& rows) {
  std::vector<PointId> shown(rows.size());
  std::unordered_map<TrackId, PointId> later;
  for (std::size_t i = rows.size(); i-- > 0;) {
    const ResultTrackRow& row = rows[i];
    if (row.state == PointState::kDynamic) continue;
    if (model.points.contains(row.point)) later[row.track] = row.point;
    if (const auto point = later.find(row.track); point != later.end()) shown[i] = point->second;
  }
  return shown;
}

void read_agent(const ResultFolder& result, const SequenceAgent& agent, ColmapModel* model) {
  constexpr TimeNs kMaxGap_ns = 1;  // only frames with a pose of their own
  const Trajectory trajectory = load_tum(result.trajectory(agent.name));
  const std::vector<ResultTrackRow> rows = track_rows(result, agent.name);
  const std::vector<PointId> shown = shown_points(*model, rows);
  // As it was found, else as it was given.
  const std::filesystem::path found = result.calibration(agent.name);
  model->cameras.push_back({agent, load_calibration(std::filesystem::exists(found) ? found : agent.calibration)});
  struct Taken {
    std::size_t image;
    TimeNs t_ns;
  };
  std::map<FrameId, Taken> taken;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    auto at = taken.find(rows[i].frame);
    if (at == taken.end()) {
      const auto pose = pose_at(trajectory, rows[i].t_ns, kMaxGap_ns);
      if (!pose) continue;
      at = taken.emplace(rows[i].frame, Taken{model->images.size(), rows[i].t_ns}).first;
      model->images.push_back({model->cameras.size() - 1, rows[i].frame, *pose, {}});
    }
    if (at->second.t_ns != rows[i].t_ns) continue;  // of an agent that was started again and counts anew
    model->images[at->second.image].observations.push_back({rows[i].raw_px, shown[i]});
  }
}

// Of the points, how many each image shows.
bool drop_empty_images(ColmapModel* model) {
  constexpr std::ptrdiff_t kLeastPoints = 8;
  const auto gone = std::erase_if(model->images, [&](const ColmapModel::Image& image) {
    return std::ranges::count_if(image.observations, [](const auto& o) { return o.point != PointId(); }) < kLeastPoints;
  });
  return gone > 0;
}

void collect_tracks(ColmapModel* model) {
  for (auto& [id, point] : model->points) point.track.clear();
  for (std::size_t i = 0; i < model->images.size(); ++i) {
    auto& observations = model->images[i].observations;
    for (std::size_t k = 0; k < observations.size(); ++k) {
      if (observations[k].point == PointId()) continue;
      auto& track = model->points.at(observations[k].point).track;
      if (!track.empty() && track.back().image == i) {
        observations[k].point = PointId();  // two tracks on one point
      } else {
        track.push_back({i, k});
      }
    }
  }
}

void drop_short_tracks(ColmapModel* model) {
  std::erase_if(model->points, [&](const auto& entry) {
    const auto& track = entry.second.track;
    if (track.size() >= 2) return false;
    for (const auto& e : track) model->images[e.image].observations[e.observation].point = PointId();
    return true;
  });
}

}  // namespace

std::string ColmapModel::name_of(const Image& image) const {
  char number[32];
  std::snprintf(number, sizeof number, "/%06u.png", image.frame.value);
  return cameras[image.camera].agent.name + number;
}

ColmapModel read_colmap_model(const ResultMap& map, const Sequence& sequence) {
  ColmapModel model;
  for (const ResultPoint& point : read_points(map.folder.points())) {
    if (point.state == PointState::kStatic) model.points[point.id].position = point.position;
  }
  for (const SequenceAgent& agent : sequence.agents) {
    if (std::ranges::find(map.agents, agent.name) != map.agents.end()) read_agent(map.folder, agent, &model);
  }
  link_points(&model);
  return model;
}

void link_points(ColmapModel* model) {
  do {
    collect_tracks(model);
    drop_short_tracks(model);
  } while (drop_empty_images(model));
}

double error_px(const ColmapModel& model, const ColmapModel::Point& point, const ColmapModel::TrackElement& element) {
  const ColmapModel::Image& image = model.images[element.image];
  const CameraModel& camera = model.camera_of(image);
  const Eigen::Vector3d in_cam = image.cam_from_world * point.position;
  if (!(in_cam.z() > 0)) return std::numeric_limits<double>::infinity();
  return (camera.raw_from_undistorted(camera.project(in_cam)) - image.observations[element.observation].px).norm();
}

double mean_error_px(const ColmapModel& model, const ColmapModel::Point& point) {
  double sum = 0;
  for (const auto& element : point.track) sum += error_px(model, point, element);
  return sum / static_cast<double>(point.track.size());
}

double mean_error_px(const ColmapModel& model) {
  double sum = 0;
  for (const auto& [id, point] : model.points) sum += mean_error_px(model, point);
  return sum / static_cast<double>(model.points.size());
}

}  // namespace coslam::exporting
