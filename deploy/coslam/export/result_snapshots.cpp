// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/result_snapshots.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/base/error.h"
#include "deploy/coslam/export/result_events.h"
#include "server/show/publish/odom_frames.h"

namespace coslam::exporting {
namespace {

constexpr double kCloud_s = 1.0, kCloudBytes_per_s = 1.5e6, kPaths_s = 1.0;
constexpr std::size_t kMostOfPath = 500;  // poses
constexpr double kPointBytes = 28;

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

}  // namespace

ResultSnapshots::ResultSnapshots(const ResultContents& contents)
    : main_(contents.maps.front().id), maps_(contents.maps.size()) {
  for (const std::string& name : contents.agents) {
    Agent& agent = agents_.emplace_back();
    agent.name = name;
    agent.run = RunId(agents_.size());
    agent.camera.width_px = agent.camera.height_px = 0;
  }
  const ResultFolder& result = contents.maps.front().folder;
  if (contents.reported) read_report(result);
  for (const ResultMap& map : contents.maps) {
    read_map(map);
    read_moving(map);
  }
  std::ranges::stable_sort(points_, {}, &std::pair<TimeNs, ros::StaticPoint>::first);
  read_tracks(result);
  if (std::filesystem::exists(result.groups())) groups_ = read_groups(result.groups());
  events_ = public_events(result);
  gather_instants();
}

namespace {

// Of a report.
std::optional<PathVerdict> path_of(const nlohmann::json& path) {
  if (!path.is_object()) return std::nullopt;
  const auto quality = quality_of(path.value("quality", ""));
  if (!quality) return std::nullopt;
  PathVerdict out{.verdict = {*quality, path.value("why", "")}, .length = path.value("length", 0.0), .sigma = {}};
  if (const auto sigma = path.find("sigma"); sigma != path.end() && sigma->is_number())
    out.sigma = sigma->get<double>();
  return out;
}

}  // namespace

ResultSnapshots::Agent* ResultSnapshots::find(const std::string& name) {
  const auto found = std::ranges::find(agents_, name, &Agent::name);
  return found == agents_.end() ? nullptr : &*found;
}

// What the report lacks stays as it is.
void ResultSnapshots::read_report(const ResultFolder& result) {
  const nlohmann::json report = read_json(result.report());
  const nlohmann::json none = nlohmann::json::object();
  const auto part = [&](const nlohmann::json& section, const char* name) {
    return section.is_object() && section.contains(name) ? section[name] : none;
  };
  const auto number = [](const nlohmann::json& section, const char* name) {
    return section.is_object() && section.contains(name) && section[name].is_number() ? section[name].get<double>()
                                                                                      : 0.0;
  };
  const nlohmann::json server = part(report, "server");
  scale_known_ = server.value("scale_known", false);
  ms_per_set_ = number(part(part(server, "ms"), "frame_set"), "mean");
  for (Agent& agent : agents_) {
    const nlohmann::json agent_report = part(part(report, "agents"), agent.name.c_str());
    agent.frame_ms = number(agent_report, "ms_per_frame");
    agent.path = path_of(part(agent_report, "path"));
    const nlohmann::json camera = part(agent_report, "camera");
    agent.camera.width_px = static_cast<int>(number(camera, "width_px"));
    agent.camera.height_px = static_cast<int>(number(camera, "height_px"));
    agent.camera.fx = number(camera, "fx");
    agent.camera.fy = number(camera, "fy");
    agent.camera.cx = number(camera, "cx");
    agent.camera.cy = number(camera, "cy");
  }
}

void ResultSnapshots::read_map(const ResultMap& map) {
  for (const std::string& name : map.agents) {
    Agent* agent = find(name);
    if (agent != nullptr) agent->paths.emplace_back(map.id, load_tum(map.folder.trajectory(name)));
  }
  if (!std::filesystem::exists(map.folder.points())) return;
  for (const ResultPoint& p : read_points(map.folder.points())) {
    if (p.state == PointState::kDynamic) continue;
    points_.push_back({p.first_ns,
                       {.position = p.position.cast<float>(),
                        .sigma = sigma_of(p.covariance),
                        .id = p.id,
                        .map = map.id,
                        .on_trial = p.state == PointState::kUncertain,
                        .views = static_cast<std::uint16_t>(std::clamp(p.views, 0, 65535))}});
  }
}

void ResultSnapshots::read_moving(const ResultMap& map) {
  std::map<std::pair<TimeNs, PointId>, ObjectId> object_of;
  const auto at = [&](TimeNs t_ns) -> PublicMoving::InMap& { return moving_[t_ns].maps[map.id]; };
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
void ResultSnapshots::read_tracks(const ResultFolder& result) {
  for (Agent& agent : agents_) {
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
      images_[t_ns].push_back(std::move(image));
    }
  }
}

// Poses of all agents by time; those of one instant together, each agent once.
void ResultSnapshots::gather_instants() {
  constexpr double kTogether_s = 0.01;
  std::vector<std::pair<TimeNs, PublicPose>> all;
  for (Agent& agent : agents_) {
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
    const bool begins = instants_.empty() ||
                        to_seconds(t_ns - instants_.back().poses.front().capture_ns) > kTogether_s ||
                        std::ranges::count(instants_.back().poses, pose.agent, &PublicPose::agent) > 0;
    if (begins) instants_.emplace_back();
    instants_.back().t_ns = t_ns;
    instants_.back().poses.push_back(std::move(pose));
  }
}

bool ResultSnapshots::due(std::optional<TimeNs>* last, TimeNs t_ns, double period_s) const {
  const bool at_the_end = next_ == instants_.size();
  if (*last && !at_the_end && to_seconds(t_ns - **last) < period_s) return false;
  *last = t_ns;
  return true;
}

std::shared_ptr<const PublicMoving> ResultSnapshots::moving_at(TimeNs t_ns) {
  // The newest that is not later; rows are of frame sets, whose stamps are those of one of their frames.
  auto after = moving_.upper_bound(t_ns);
  auto out = std::make_shared<PublicMoving>();
  if (after != moving_.begin()) *out = std::prev(after)->second;
  moving_.erase(moving_.begin(), after);
  const bool something = !out->maps.empty();
  if (!something && !moves_) return nullptr;  // it was told that all is at rest
  moves_ = something;
  out->t_ns = t_ns;
  out->main = main_;
  return out;
}

std::shared_ptr<const PublicCloud> ResultSnapshots::cloud_at(TimeNs t_ns) {
  const auto seen = std::ranges::upper_bound(points_, t_ns, {}, &std::pair<TimeNs, ros::StaticPoint>::first);
  const auto count = static_cast<std::size_t>(seen - points_.begin());
  const double period_s = std::max(kCloud_s, kPointBytes * static_cast<double>(count) / kCloudBytes_per_s);
  if ((count == told_points_ && cloud_ns_) || !due(&cloud_ns_, t_ns, period_s)) return nullptr;
  told_points_ = count;
  auto out = std::make_shared<PublicCloud>();
  out->t_ns = t_ns;
  out->main = main_;
  for (auto p = points_.begin(); p != seen; ++p) out->points.push_back(p->second);
  return out;
}

std::shared_ptr<const PublicPaths> ResultSnapshots::paths_at(TimeNs t_ns) {
  if (!due(&paths_ns_, t_ns, kPaths_s)) return nullptr;
  auto out = std::make_shared<PublicPaths>();
  out->t_ns = t_ns;
  out->main = main_;
  for (const Agent& agent : agents_) {
    if (!agent.newest) continue;
    PublicPath path{.agent = agent.name, .map = agent.newest->map, .cam_from_map = {}};
    const auto whole = std::ranges::find(agent.paths, path.map, &std::pair<MapId, Trajectory>::first);
    const auto end = std::ranges::upper_bound(whole->second, t_ns, {}, &StampedPose::t_ns);
    const auto count = static_cast<std::size_t>(end - whole->second.begin());
    // A power of two, so that the poses stay the same from one path to the next.
    std::size_t stride = 1;
    while (count / stride > kMostOfPath) stride *= 2;
    for (std::size_t i = 0; i < count; i += stride)
      path.cam_from_map.emplace_back(whole->second[i].t_ns, whole->second[i].cam_from_world);
    out->cameras.push_back(std::move(path));
  }
  return out;
}

std::shared_ptr<const PublicTracks> ResultSnapshots::tracks_until(TimeNs t_ns) {
  const auto after = images_.upper_bound(t_ns);
  if (after == images_.begin()) return nullptr;
  auto out = std::make_shared<PublicTracks>();
  out->t_ns = t_ns;
  out->main = main_;
  for (auto image = images_.begin(); image != after; ++image) {
    for (PublicImage& of_agent : image->second) {
      if (Agent* agent = find(of_agent.agent)) {
        agent->tracks = of_agent.tracks.size();
        agent->bound = static_cast<std::size_t>(std::ranges::count_if(
            of_agent.tracks, [](const PublicTrack& t) { return t.state != PublicTrackState::kNone; }));
      }
      out->cameras.push_back(std::move(of_agent));
    }
  }
  images_.erase(images_.begin(), after);
  return out;
}

std::optional<Snapshot> ResultSnapshots::next() {
  if (next_ == instants_.size()) return std::nullopt;
  const Instant& now = instants_[next_++];
  Snapshot out;
  auto poses = std::make_shared<PublicPoses>();
  poses->t_ns = now.t_ns;
  poses->main = main_;
  poses->cameras = now.poses;
  out.poses = poses;
  for (const PublicPose& pose : now.poses) {
    Agent* agent = find(pose.agent);
    agent->newest = pose;
    ++agent->frames;
  }
  out.moving = moving_at(now.t_ns);
  out.cloud = cloud_at(now.t_ns);
  out.paths = paths_at(now.t_ns);
  out.tracks = tracks_until(now.t_ns);
  auto state = state_at(now.t_ns);
  if (state && out.moving) {
    auto counted = std::make_shared<PublicState>(*state);
    for (const auto& [map, in_map] : out.moving->maps) {
      counted->moving_points += in_map.points.size();
      counted->objects += in_map.objects.size();
    }
    state = counted;
  }
  out.state = state;
  const bool last = next_ == instants_.size();
  while (next_event_ < events_.size() && (last || events_[next_event_].t_ns <= now.t_ns))
    out.events.push_back(events_[next_event_++]);
  return out;
}

}  // namespace coslam::exporting
