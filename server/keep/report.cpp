// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/report.h"

#include <algorithm>
#include <array>
#include <map>

#include "common/base/version.h"
#include "common/dataset/report_parts.h"
#include "common/dataset/result.h"
#include "server/estimator/solve/corrected_calibration.h"
#include "server/keep/verdict.h"

namespace coslam {
namespace {

using Json = nlohmann::ordered_json;

// {"stage": {"p50":, "p95":, "p99":, "mean":, "count":}}
TimeNs first_ns(const CameraFrames& camera) {
  return camera.past.frames > 0 ? camera.past.first_ns : camera.frames.front().capture_ns;
}

// From when to when a camera had no pose, played seconds.
Json lost_intervals(const CameraFrames& camera) {
  Json lost = Json::array();
  for (const auto& [from_ns, to_ns] : camera.past.lost) lost.push_back({to_seconds(from_ns), to_seconds(to_ns)});
  const FramePose* lost_from = nullptr;
  for (const FramePose& f : camera.present_frames()) {
    if (!f.valid() && lost_from == nullptr) lost_from = &f;
    if (f.valid() && lost_from != nullptr) {
      lost.push_back({to_seconds(lost_from->capture_ns), to_seconds(f.capture_ns)});
      lost_from = nullptr;
    }
  }
  if (lost_from != nullptr)
    lost.push_back({to_seconds(lost_from->capture_ns), to_seconds(camera.frames.back().capture_ns)});
  return lost;
}

Json intrinsics_report(const CameraModel& camera) {
  return {{"width_px", camera.width_px},
          {"height_px", camera.height_px},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy}};
}

// What was found to be wrong about a calibration, and what comes of it.
Json lens_report(const CameraLens& camera) {
  const auto [model, worst_px] = corrected_calibration(camera.model, camera.lens);
  const Eigen::VectorXd radial = camera.lens.radial();
  return {{"corrected", !camera.lens.none()},
          {"breathes", camera.breathing},
          {"focal_ratio", std::exp(camera.lens.log_focal())},
          {"focal_sigma", camera.lens_sigma[0]},
          {"centre_shift_px", {camera.lens.centre_px().x(), camera.lens.centre_px().y()}},
          {"aspect_ratio", std::exp(camera.lens.log_aspect())},
          {"tangential", {camera.lens.tangential().x(), camera.lens.tangential().y()}},
          {"radial", std::vector<double>(radial.begin(), radial.end())},
          {"fx", model.fx},
          {"fy", model.fy},
          {"cx", model.cx},
          {"cy", model.cy},
          {"file_differs_px", worst_px}};
}

// Once the map was adjusted as a whole: how good the camera's path is, without truth.
Json path_report(const MapServer& server, const MapCamera& camera, const ImageAccount& images) {
  const auto path = server.path_error(camera.id);
  if (!path) return {};
  return json_of(verdict_of(camera, *path, images));
}

// An agent as the server saw it. Tracked: in the common map, where the others are.
Json camera_report(const MapServer& server, CameraId id) {
  const MapCamera& camera = server.map().camera(id);
  const MapId common = server.largest_map();
  const int tracked = common == MapId() ? 0 : camera.frames_in_map(common);
  const double n = static_cast<double>(std::max<std::size_t>(1, camera.frames_ever()));
  const ClockOffset clock = server.stage<ClockOffsets>().offset(id);
  const auto lag = server.stage<StampLag>().lag(id);
  return {{"frames", camera.frames_ever()},
          {"frames_received", camera.frames_ever()},
          {"tracked_percent", 100.0 * static_cast<double>(tracked) / n},
          {"sigma_px", camera.sigma_px},
          {"clock_offset_ms", 1000 * clock.offset_s},
          {"clock_sigma_ms", 1000 * clock.sigma_s},
          {"clock_offset_used_ms", 1000 * to_seconds(camera.clock_offset_ns)},
          {"misdated_s", lag && lag->is_off() ? Json(lag->lag_s) : Json()},
          {"lag", lag ? Json{{"lag_s", lag->lag_s}, {"against", server.map().camera(lag->against).name}} : Json()},
          {"lost_intervals", lost_intervals(camera)},
          {"camera", intrinsics_report(camera.model)}};
}

// What an agent says of itself. Deeper than it ever is, it is nonsense that may be too deep to be written.
Json own_report(const std::string& text) {
  constexpr int kDeepest = 4;
  const auto keep = [](int depth, Json::parse_event_t, const Json&) { return depth <= kDeepest; };
  Json parsed = Json::parse(text, keep, false);
  return parsed.is_object() ? parsed : Json::object();
}

Json agent_report(const MapServer& server, const ServerLink& link, const ReportedAgent& agent) {
  Json out = camera_report(server, agent.camera);
  out["lens"] = lens_report(server.map().camera(agent.camera));
  out.update(own_report(agent.last_status.report_json));
  out["images"] = json_of(agent.images);
  if (!agent.problem.empty()) out["problem"] = agent.problem;
  out["frames"] = agent.images.captured();
  out["dropped"] = agent.images[ImageFate::kNotSent];
  out["tracked_percent"] = agent.images.percent(ImageFate::kTracked);
  out["path"] = path_report(server, server.map().camera(agent.camera), agent.images);
  const LinkBytes bytes = link.bytes(agent.name);
  out["bytes_up"] = bytes.up;
  out["bytes_down"] = bytes.down;
  // Per second of played time, so that the figure holds at any speed of replay.
  const MapCamera& played = server.map().camera(agent.camera);
  const double seconds = played.frames_ever() < 2 ? 0 : to_seconds(played.frames.back().capture_ns - first_ns(played));
  out["kb_per_s_up"] = seconds > 0 ? static_cast<double>(bytes.up) / 1000.0 / seconds : 0.0;
  out["kb_per_s_down"] = seconds > 0 ? static_cast<double>(bytes.down) / 1000.0 / seconds : 0.0;
  return out;
}

Json tags_report(const std::vector<MeasuredTag>& tags) {
  Json out = Json::array();
  for (const MeasuredTag& t : tags) {
    constexpr std::array<const char*, 4> kStates{"measured", "undetermined", "not in one place", "not square"};
    out.push_back({{"tag", t.tag.value},
                   {"state", kStates[static_cast<std::size_t>(t.size.status)]},
                   {"views", t.size.views},
                   {"side", t.size.side},
                   {"sigma", t.size.sigma},
                   {"error_px", t.size.error_px}});
  }
  return out;
}

Json points_report(const MapServer& server, MapId map_id) {
  std::map<std::string, int> by_state{{"static", 0}, {"dynamic", 0}, {"uncertain", 0}};
  for (const auto& [id, p] : server.map().points())
    by_state[state_name(told_state(p.phase))] += p.map == map_id ? 1 : 0;
  return by_state;
}

// Who is in which map, the common one first.
Json maps_report(const MapServer& server) {
  Json out = Json::array();
  for (const MapFrames& m : server.maps()) {
    Json agents = Json::object();
    for (const auto& [camera, frames] : m.frames) agents[server.map().camera(camera).name] = frames;
    out.push_back({{"map", m.map.value},
                   {"agents", agents},
                   {"points", points_report(server, m.map)},
                   {"scale_known", server.scale_known(m.map)}});
  }
  return out;
}

Json memory_report(const MemoryUse& use) {
  constexpr double kMib = 1 << 20;
  Json out = Json::object();
  for (const auto& [part, bytes] : use) out[part] = static_cast<double>(bytes) / kMib;
  return out;
}

Json server_report(const MapServer& server) {
  Json out;
  out["ms"] = json_of(server.times());
  out["points"] = points_report(server, server.largest_map());
  out["key_frames"] = server.map().key_frames().size();
  out["merges"] = server.counts().merges;
  out["maps"] = server.maps().size();
  out["inter_pose_calls"] = server.counts().inter_pose_calls;
  out["refinements"] = server.counts().refinements;
  out["scale_known"] = server.scale_known();
  if (const auto tags = server.stage<Scale>().tags().tags(server.largest_map()); !tags.empty())
    out["tags"] = tags_report(tags);
  out["events"] = server.counts().events;
  out["memory_mib"] = memory_report(server.memory());
  out["peak_memory_mib"] = peak_memory_mib();
  return out;
}

Json link_report(const ServerLinkCounts& counts) {
  return {{"dropped_frames", counts.dropped_frames},
          {"late_replies", counts.late_replies},
          {"resent_patches", counts.resent_patches}};
}

Json rejected_report(const RejectionCounts& counts) {
  Json out = Json::object();
  for (std::size_t i = 0; i < kRejectionCount; ++i) {
    const auto reason = static_cast<Rejection>(i);
    if (counts[reason] > 0) out[std::string(name_of(reason))] = counts[reason];
  }
  return out;
}

// Each agent's problem, where none has a pose.
std::string nothing_mapped(const ImageAccount& images, const std::vector<ReportedAgent>& agents) {
  if (images[ImageFate::kTracked] + images[ImageFate::kInOtherMaps] > 0) return "";
  std::string text;
  for (const ReportedAgent& a : agents) text += (text.empty() ? "nothing was mapped: " : "; ") + a.problem;
  return text;
}

}  // namespace

std::array<std::uint64_t, kImageFaults> faults_of(const std::string& report_json) {
  std::array<std::uint64_t, kImageFaults> out{};
  const Json agent_json = own_report(report_json);
  const auto left_out = agent_json.find("left_out");
  if (left_out == agent_json.end() || !left_out->is_object()) return out;
  for (std::size_t i = 0; i < kImageFaults; ++i) {
    const auto n = left_out->find(words_of(static_cast<ImageFault>(i)).name);
    if (n != left_out->end() && n->is_number_unsigned()) out[i] = n->get<std::uint64_t>();
  }
  return out;
}

Json make_report(const MapServer& server, const ServerLink& link, const FrameCounts& counts,
                 const std::vector<ReportedAgent>& agents, bool adjusted, const Json& configuration) {
  ImageAccount images;
  Json by_agent = Json::object();
  for (const ReportedAgent& agent : agents) {
    by_agent[agent.name] = agent_report(server, link, agent);
    by_agent[agent.name]["stamp_correction_ms"] = 1000 * to_seconds(counts.stamps.correction_ns(agent.camera));
    images += agent.images;
  }
  Json report;
  report["version"] = version();
  report["adjusted"] = adjusted;
  report["frame_sets"] = server.counts().frame_sets;
  report["images"] = json_of(images);
  report["warnings"] = json_of(warnings_given());
  if (const std::string problem = nothing_mapped(images, agents); !problem.empty()) report["problem"] = problem;
  report["frames"] = images.captured();
  report["dropped"] = images[ImageFate::kNotSent];
  report["late_frames"] = counts.late;
  report["overflowed_frames"] = counts.overflowed;
  report["frame_sets_left_out"] = counts.sets_left_out;
  report["frames_out_of_time"] = counts.stamps.refused();
  report["link"] = link_report(link.counts());
  report["agents"] = by_agent;
  report["maps"] = maps_report(server);
  report["server"] = server_report(server);
  report["rejected"] = rejected_report(link.rejections());
  report["configuration"] = configuration;
  return report;
}

nlohmann::ordered_json make_map_report(const MapServer& server) {
  Json agents = Json::object();
  for (const MapCamera& c : server.map().cameras()) agents[c.name] = camera_report(server, c.id);
  return {{"version", version()}, {"agents", agents}, {"maps", maps_report(server)}};
}

}  // namespace coslam
