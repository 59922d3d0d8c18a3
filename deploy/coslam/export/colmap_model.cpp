// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/colmap_model.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <unordered_map>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/printed.h"
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
// parts of others, after their tracks were first seen. An agent that was started again has other tracks.
std::vector<PointId> shown_points(const ColmapModel& model, const std::vector<ResultTrackRow>& rows) {
  std::vector<PointId> shown(rows.size());
  std::unordered_map<TrackId, PointId> later;
  for (std::size_t i = rows.size(); i-- > 0;) {
    const ResultTrackRow& row = rows[i];
    if (i + 1 < rows.size() && rows[i + 1].frame < row.frame) later.clear();
    if (row.state == PointState::kDynamic) continue;
    if (model.points.contains(row.point)) later[row.track] = row.point;
    if (const auto point = later.find(row.track); point != later.end()) shown[i] = point->second;
  }
  return shown;
}

constexpr TimeNs kMaxGap_ns = 1;  // only frames with a pose of their own

// Without them the model can be written all the same.
std::vector<PlayedImage> played_images(const SequenceAgent& agent, double rate_hz, const CameraModel& lens) {
  try {
    return PlayedImages(agent, rate_hz, lens).list();
  } catch (const UserError& e) {
    log_warn(std::string(e.what()) + "; images are named by their numbers");
    return {};
  }
}

void read_agent(const ResultFolder& result, const SequenceAgent& agent, double rate_hz, int every, ColmapModel* model) {
  const Trajectory trajectory = load_tum(result.trajectory(agent.name));
  const std::vector<ResultTrackRow> rows = track_rows(result, agent.name);
  const std::vector<PointId> shown = shown_points(*model, rows);
  // As it was found, else as it was given.
  const std::filesystem::path found = result.calibration(agent.name);
  const CameraModel lens = load_calibration(std::filesystem::exists(found) ? found : agent.calibration);
  model->cameras.push_back({agent, lens, played_images(agent, rate_hz, lens)});
  struct Taken {
    std::size_t image;
    TimeNs t_ns;
  };
  std::map<FrameId, Taken> taken;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (every > kTracksOfEvery && rows[i].frame.value % static_cast<std::uint32_t>(every) != 0) continue;
    auto at = taken.find(rows[i].frame);
    if (at == taken.end()) {
      const auto pose = pose_at(trajectory, rows[i].t_ns, kMaxGap_ns);
      if (!pose) continue;
      at = taken.emplace(rows[i].frame, Taken{model->images.size(), rows[i].t_ns}).first;
      model->images.push_back({model->cameras.size() - 1, rows[i].frame, rows[i].t_ns, *pose, {}, {}});
    }
    if (at->second.t_ns != rows[i].t_ns) continue;  // of an agent that was started again and counts anew
    model->images[at->second.image].observations.push_back({rows[i].raw_px, shown[i]});
  }
}

// Of the points, how many each image shows.
bool drop_empty_images(ColmapModel* model) {
  constexpr std::ptrdiff_t kLeastPoints = 8;
  const auto removed = std::erase_if(model->images, [&](const ColmapModel::Image& image) {
    return std::ranges::count_if(image.observations, [](const auto& o) { return o.point != PointId(); }) < kLeastPoints;
  });
  return removed > 0;
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

ColmapModel read_colmap_model(const ResultMap& map, const Sequence& sequence, int every) {
  ColmapModel model;
  for (const ResultPoint& point : read_points(map.folder.points())) {
    if (point.state == PointState::kStatic) model.points[point.id].position = point.position;
  }
  for (const SequenceAgent& agent : sequence.agents) {
    if (std::ranges::find(map.agents, agent.name) != map.agents.end())
      read_agent(map.folder, agent, sequence.rate_hz, every, &model);
  }
  link_points(&model);
  return model;
}

namespace {

// How the images of one camera were moved by the adjustment: world_before_from_after, at frames, ascending.
struct Moved {
  std::uint32_t frame;
  Rigid3 change;
};

std::vector<Moved> moved_images(const ColmapModel& model, std::size_t camera, const Trajectory& before) {
  std::vector<Moved> out;
  for (const auto& image : model.images) {
    if (image.camera != camera) continue;
    if (const auto pose = pose_at(before, image.t_ns, kMaxGap_ns)) {
      out.push_back({image.frame.value, pose->inverse() * image.cam_from_world});
    }
  }
  std::ranges::sort(out, {}, &Moved::frame);
  return out;
}

Rigid3 change_at(const std::vector<Moved>& moved, std::uint32_t frame) {
  const auto after = std::ranges::lower_bound(moved, frame, {}, &Moved::frame);
  if (after == moved.end()) return moved.back().change;
  if (after == moved.begin() || after->frame == frame) return after->change;
  const Moved& before = *std::prev(after);
  return interpolate(before.change, after->change,
                     static_cast<double>(frame - before.frame) / (after->frame - before.frame));
}

std::string numbered(const ColmapModel& model, const ColmapModel::Image& image) {
  return printed("%s/%06u.png", model.cameras[image.camera].agent.name.c_str(), image.frame.value);
}

const std::filesystem::path* file_of(const ColmapModel& model, const ColmapModel::Image& image) {
  const auto& played = model.cameras[image.camera].played;
  if (image.frame.value >= played.size()) return nullptr;
  const auto& file = played[image.frame.value].file;
  return file.empty() ? nullptr : &file;
}

// Of two absolute paths.
std::filesystem::path common_folder(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::filesystem::path out;
  for (auto i = a.begin(), k = b.begin(); i != a.end() && k != b.end() && *i == *k; ++i, ++k) out /= *i;
  return out;
}

}  // namespace

void add_images_between(const ResultMap& map, int every, ColmapModel* model) {
  if (every >= kTracksOfEvery) return;
  for (std::size_t c = 0; c < model->cameras.size(); ++c) {
    const auto& [agent, lens, played] = model->cameras[c];
    const Trajectory path = load_tum(map.folder.trajectory(agent.name));
    const std::vector<Moved> moved = moved_images(*model, c, path);
    if (moved.empty()) continue;
    if (played.empty()) throw UserError("agent " + agent.name + ": images between those with tracks need the source");
    for (const PlayedImage& image : played) {
      const std::uint32_t frame = image.frame.value;
      if (frame % static_cast<std::uint32_t>(every) != 0 || frame % kTracksOfEvery == 0) continue;
      const auto pose = pose_at(path, image.t_ns, kMaxGap_ns);
      if (pose) model->images.push_back({c, image.frame, image.t_ns, *pose * change_at(moved, frame), {}, {}});
    }
  }
}

namespace {

using NameOfFile = std::function<std::string(const ColmapModel::Image&, const std::filesystem::path&)>;

// No two images have one name: those of a camera whose files would, as of a list that has one twice, have numbers.
void name_images(const NameOfFile& name_of_file, ColmapModel* model) {
  std::set<std::string> taken;
  std::set<std::size_t> by_number;
  for (auto& image : model->images) {
    const auto* file = file_of(*model, image);
    image.name = file == nullptr ? numbered(*model, image) : name_of_file(image, *file);
    if (!taken.insert(image.name).second) by_number.insert(image.camera);
  }
  for (auto& image : model->images) {
    if (by_number.contains(image.camera)) image.name = numbered(*model, image);
  }
}

}  // namespace

std::filesystem::path name_as_files(ColmapModel* model) {
  const auto whole = [](const std::filesystem::path& file) {
    return std::filesystem::absolute(file).lexically_normal();
  };
  std::optional<std::filesystem::path> folder;
  for (const auto& image : model->images) {
    const auto* file = file_of(*model, image);
    if (file == nullptr) continue;
    const auto of_file = whole(*file).parent_path();
    folder = folder ? common_folder(*folder, of_file) : of_file;
  }
  name_images([&](const auto&, const auto& file) { return whole(file).lexically_relative(*folder).string(); }, model);
  return folder.value_or("");
}

void name_as_pngs(ColmapModel* model) {
  name_images(
      [&](const auto& image, const auto& file) {
        return model->cameras[image.camera].agent.name + "/" + file.stem().string() + ".png";
      },
      model);
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
