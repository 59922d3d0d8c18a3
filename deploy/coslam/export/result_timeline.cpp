// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/result_timeline.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "deploy/coslam/export/result_events.h"
#include "server/show/publish/odom_frames.h"

namespace coslam::exporting {
namespace {

float sigma_of(const Eigen::Matrix3d& covariance) { return static_cast<float>(std::sqrt(covariance.trace())); }

PublicTrackState state_of(const std::optional<PointState>& state) {
  if (!state) return PublicTrackState::kNone;
  switch (*state) {
    case PointState::kStatic:
      return PublicTrackState::kStatic;
    case PointState::kDynamic:
      return PublicTrackState::kDynamic;
    case PointState::kUncertain:
      return PublicTrackState::kUncertain;
  }
  return PublicTrackState::kNone;
}

// Of a camera that nobody described: so large that all its tracks are in the image, and of a usual lens.
void grow(CameraModel* camera, const Eigen::Vector2d& px) {
  camera->width_px = std::max(camera->width_px, static_cast<int>(px.x()) + 1);
  camera->height_px = std::max(camera->height_px, static_cast<int>(px.y()) + 1);
  camera->fx = camera->fy = camera->width_px;
  camera->cx = 0.5 * camera->width_px;
  camera->cy = 0.5 * camera->height_px;
}

// A number or a text of a report; 0 or empty where it has something else there.
double number_in(const nlohmann::json& section, const char* name) {
  return section.is_object() && section.contains(name) && section[name].is_number() ? section[name].get<double>() : 0.0;
}
std::string text_in(const nlohmann::json& section, const char* name) {
  return section.is_object() && section.contains(name) && section[name].is_string() ? section[name].get<std::string>()
                                                                                    : "";
}

// The verdict on a path in a report.
std::optional<PathVerdict> path_of(const nlohmann::json& path) {
  const auto quality = quality_of(text_in(path, "quality"));
  if (!quality) return std::nullopt;
  PathVerdict out{
      .verdict = {*quality, text_in(path, "why")}, .length = number_in(path, "length"), .sigma = std::nullopt};
  if (const auto sigma = path.find("sigma"); sigma != path.end() && sigma->is_number())
    out.sigma = sigma->get<double>();
  return out;
}

// Reads the parts of a result one after the other.
class TimelineReader {
 public:
  explicit TimelineReader(const ResultContents& contents) {
    out_.main = contents.maps.front().id;
    out_.maps = contents.maps.size();
    for (const std::string& name : contents.agents) {
      ResultTimeline::Agent& agent = out_.agents.emplace_back();
      agent.name = name;
      agent.run = RunId(out_.agents.size());
      agent.camera.width_px = agent.camera.height_px = 0;
    }
    const ResultFolder& result = contents.maps.front().folder;
    if (contents.reported) read_report(result);
    for (const ResultMap& map : contents.maps) {
      read_map(map);
      read_moving(map);
    }
    std::ranges::stable_sort(out_.points, {}, &std::pair<TimeNs, ros::StaticPoint>::first);
    read_tracks(result);
    if (std::filesystem::exists(result.groups())) out_.groups = read_groups(result.groups());
    out_.events = public_events(result);
    gather_instants();
  }

  ResultTimeline take() { return std::move(out_); }

 private:
  ResultTimeline::Agent* find(const std::string& name) {
    const auto found = std::ranges::find(out_.agents, name, &ResultTimeline::Agent::name);
    return found == out_.agents.end() ? nullptr : &*found;
  }

  // What the report lacks stays as it is.
  void read_report(const ResultFolder& result) {
    const nlohmann::json report = read_json(result.report());
    const nlohmann::json none = nlohmann::json::object();
    const auto part = [&](const nlohmann::json& section, const char* name) {
      return section.is_object() && section.contains(name) ? section[name] : none;
    };
    const nlohmann::json server = part(report, "server");
    out_.scale_known = part(server, "scale_known") == true;
    out_.ms_per_set = number_in(part(part(server, "ms"), "frame_set"), "mean");
    for (ResultTimeline::Agent& agent : out_.agents) {
      const nlohmann::json agent_report = part(part(report, "agents"), agent.name.c_str());
      agent.frame_ms = number_in(agent_report, "ms_per_frame");
      agent.path = path_of(part(agent_report, "path"));
      const nlohmann::json camera = part(agent_report, "camera");
      agent.camera.width_px = static_cast<int>(number_in(camera, "width_px"));
      agent.camera.height_px = static_cast<int>(number_in(camera, "height_px"));
      agent.camera.fx = number_in(camera, "fx");
      agent.camera.fy = number_in(camera, "fy");
      agent.camera.cx = number_in(camera, "cx");
      agent.camera.cy = number_in(camera, "cy");
    }
  }

  void read_map(const ResultMap& map) {
    for (const std::string& name : map.agents) {
      ResultTimeline::Agent* agent = find(name);
      if (agent != nullptr) agent->paths.emplace_back(map.id, load_tum(map.folder.trajectory(name)));
    }
    if (!std::filesystem::exists(map.folder.points())) return;
    for (const ResultPoint& p : read_points(map.folder.points())) {
      if (p.state == PointState::kDynamic) continue;
      out_.points.push_back({p.first_ns,
                             {.position = p.position.cast<float>(),
                              .sigma = sigma_of(p.covariance),
                              .id = p.id,
                              .map = map.id,
                              .on_trial = p.state == PointState::kUncertain,
                              .views = static_cast<std::uint16_t>(std::clamp(p.views, 0, 65535))}});
    }
  }

  void read_moving(const ResultMap& map) {
    std::map<std::pair<TimeNs, PointId>, ObjectId> object_of;
    const auto at = [&](TimeNs t_ns) -> PublicMoving::InMap& { return out_.moving[t_ns].maps[map.id]; };
    if (std::filesystem::exists(map.folder.objects())) {
      for_each_object_row(map.folder.objects(), [&](const ResultObjectRow& row) {
        at(row.t_ns).objects.push_back({row.object, row.position, row.velocity_per_s, row.extent});
        for (const PointId id : row.members) object_of[{row.t_ns, id}] = row.object;
      });
    }
    if (!std::filesystem::exists(map.folder.dynamic())) return;
    for_each_dynamic_row(map.folder.dynamic(), [&](const ResultDynamicRow& row) {
      const auto object = object_of.find({row.t_ns, row.id});
      at(row.t_ns).points.push_back({row.position.cast<float>(), sigma_of(row.covariance), row.id,
                                     object == object_of.end() ? ObjectId() : object->second});
    });
  }

  // In raw pixels, and told as such: the camera has no distortion here.
  void read_tracks(const ResultFolder& result) {
    for (ResultTimeline::Agent& agent : out_.agents) {
      const std::filesystem::path file = result.tracks(agent.name);
      if (!std::filesystem::exists(file)) continue;
      const bool known = agent.camera.width_px > 0;
      std::map<TimeNs, PublicImage> images;
      for_each_track_row(file, [&](const ResultTrackRow& row) {
        images[row.t_ns].tracks.push_back({row.track, row.raw_px.cast<float>(), state_of(row.state)});
        if (!known) grow(&agent.camera, row.raw_px);
      });
      for (auto& [t_ns, image] : images) {
        image.agent = agent.name;
        image.capture_ns = t_ns;
        image.camera = agent.camera;
        out_.images[t_ns].push_back(std::move(image));
      }
    }
  }

  // Poses of all agents by time; those of one instant together, each agent once.
  void gather_instants() {
    constexpr double kTogether_s = 0.01;
    std::vector<std::pair<TimeNs, PublicPose>> all;
    for (ResultTimeline::Agent& agent : out_.agents) {
      for (const auto& [map, path] : agent.paths) {
        for (const StampedPose& pose : path)
          all.push_back({pose.t_ns, {agent.name, map, pose.t_ns, pose.cam_from_world, {}, std::nullopt, std::nullopt}});
        const double length_s = path.size() < 2 ? 0 : to_seconds(path.back().t_ns - path.front().t_ns);
        if (!path.empty()) agent.last_ns = std::max(agent.last_ns, path.back().t_ns);
        if (length_s > 0) agent.rate_hz = std::max(agent.rate_hz, static_cast<double>(path.size() - 1) / length_s);
      }
    }
    std::ranges::stable_sort(all, {}, &std::pair<TimeNs, PublicPose>::first);
    OdomFrames odom;
    for (auto& [t_ns, pose] : all) {
      const auto& paths = find(pose.agent)->paths;
      const auto path = std::ranges::find(paths, pose.map, &std::pair<MapId, Trajectory>::first);
      pose.cam_from_odom = odom.follow(pose.agent, t_ns, pose.cam_from_map,
                                       [&](TimeNs at_ns) { return coslam::pose_at(path->second, at_ns, 0); });
      const bool begins = out_.instants.empty() ||
                          to_seconds(t_ns - out_.instants.back().poses.front().capture_ns) > kTogether_s ||
                          std::ranges::count(out_.instants.back().poses, pose.agent, &PublicPose::agent) > 0;
      if (begins) out_.instants.emplace_back();
      out_.instants.back().t_ns = t_ns;
      out_.instants.back().poses.push_back(std::move(pose));
    }
  }

  ResultTimeline out_;
};

}  // namespace

ResultTimeline timeline_of(const ResultContents& contents) { return TimelineReader(contents).take(); }

}  // namespace coslam::exporting
