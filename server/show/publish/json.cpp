// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "common/dataset/report_parts.h"

namespace coslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMs = 1000, kKilo = 1000;

// Invalid UTF-8, which only a bug could bring here, must not end the server.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// As short as the stamp is: 2.4, not 2.4000000000000004.
double seconds_of(TimeNs t_ns) { return static_cast<double>(t_ns) / 1e9; }

// Digits beyond are noise.
double tenths(double value) { return std::round(value * 10) / 10; }

const char* name_of(PublicStanding standing) {
  constexpr std::array<const char*, 5> kNames{"none", "tracking", "relative", "lost", "unheard"};
  return kNames.at(static_cast<std::size_t>(standing));
}

// What only a run at work knows; null where the state was made of a result.
template <class T>
Json if_live(const PublicState& state, T value) {
  return state.run == RunId() ? Json() : Json(value);
}

Json pose_of(const std::optional<Rigid3>& cam_from_map) {
  if (!cam_from_map) return nullptr;
  const Rigid3 pose = cam_from_map->inverse();
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

Json agent_of(const PublicState& state, const PublicAgent& a, const Rates& rates, RosNames& names) {
  const Rates::Agent rate = rates.rate_of(a.facts.name);
  const AgentStatus& status = a.facts.status;
  const CameraModel& c = a.camera;
  Json out;
  out["name"] = a.facts.name;
  out["topic"] = "/coslam/" + names.ros_name(a.facts.name);
  out["alive"] = a.alive;
  out["camera"] = a.facts.camera.value;
  out["map"] = a.map.value;
  out["group"] = a.group;
  out["frame"] = a.map == MapId() ? "" : frame_of(a.map, state.main);
  out["state"] = name_of(a.standing);
  out["why"] = a.why;
  out["rate_hz"] = tenths(a.rate_hz);
  out["frame_ms"] = tenths(status.frame_ms);
  out["kB_up_per_s"] = if_live(state, tenths(rate.bytes_up_per_s / kKilo));
  out["kB_down_per_s"] = if_live(state, tenths(rate.bytes_down_per_s / kKilo));
  out["lag_s"] = if_live(state, a.facts.wait_s);
  out["lost_percent"] = if_live(state, tenths(rate.lost_percent));
  out["account"] = if_live(state, json_of(a.facts.images));
  out["losses"] = if_live(state, a.facts.images.losses());
  out["path"] = a.facts.path ? json_of(*a.facts.path) : Json();
  out["images"] = words_of(status.image_fault).name;
  out["tracks"] = a.tracks;
  out["bound"] = a.bound;
  out["clock_offset_ms"] = a.clock_offset_s ? Json(kMs * *a.clock_offset_s) : Json();
  out["pose"] = pose_of(a.cam_from_map);
  out["scale_known"] = a.scale_known;
  out["fov"] = {c.width_px, c.height_px, c.fx, c.fy, c.cx, c.cy};
  return out;
}

Json server_of(const PublicState& state, const Rates& rates) {
  const auto left_out = state.loop.lost.find("sets_left_out");
  Json out;
  out["ms_per_set"] = rates.ms_per_set();
  out["points"] = state.points;
  out["moving_points"] = state.moving_points;
  out["objects"] = state.objects;
  out["maps"] = state.maps;
  out["key_frames"] = if_live(state, state.key_frames);
  out["memory_mib"] = if_live(state, tenths(state.loop.memory_mib));
  out["frame_sets"] = state.frame_sets;
  out["left_out"] = if_live(state, left_out == state.loop.lost.end() ? 0 : left_out->second);
  return out;
}

Json agents_of(const PublicState& state, const Rates& rates, RosNames& names) {
  Json out = Json::array();
  for (const PublicAgent& a : state.agents) out.push_back(agent_of(state, a, rates, names));
  return out;
}

Json links_of(const PublicState& state) {
  Json out = Json::array();
  for (const PublicState::Link& l : state.links) out.push_back({l.first, l.second, l.shared});
  return out;
}

}  // namespace

std::string state_json(const PublicState& state, const Rates& rates, RosNames& names) {
  Json out;
  out["t_s"] = seconds_of(state.t_ns);
  out["run"] = state.run == RunId() ? "" : format_hex(state.run.value);
  out["scale_known"] = state.scale_known;
  out["finishing"] = state.loop.finishing;
  out["result"] = state.loop.result;
  out["join"] = state.loop.join;
  out["server"] = server_of(state, rates);
  out["agents"] = agents_of(state, rates, names);
  out["groups"] = state.groups;
  out["links"] = links_of(state);
  return text_of(out);
}

std::string agents_json(const PublicState& state, const Rates& rates, RosNames& names) {
  return text_of(agents_of(state, rates, names));
}

std::string groups_json(const PublicState& state) {
  Json out;
  out["t_s"] = seconds_of(state.t_ns);
  out["groups"] = state.groups;
  out["links"] = links_of(state);
  return text_of(out);
}

std::string event_json(const PublicEvent& e) {
  Json out;
  out["t_s"] = seconds_of(e.t_ns);
  out["kind"] = e.kind;
  out["text"] = e.text;
  out["agents"] = e.agents;
  return text_of(out);
}

// By hand: there are thousands of them a second.
std::string tracks_json(const PublicImage& image) {
  constexpr std::size_t kUsualTrack = 28;
  std::string out;
  out.reserve(100 + kUsualTrack * image.tracks.size());
  out += "{\"t_s\":" + format_double(seconds_of(image.capture_ns)) +
         ",\"width\":" + std::to_string(image.camera.width_px) +
         ",\"height\":" + std::to_string(image.camera.height_px) + ",\"tracks\":[";
  for (const PublicTrack& t : image.tracks) {
    const Eigen::Vector2d raw_px = image.camera.raw_from_undistorted(t.undistorted_px.cast<double>());
    if (!raw_px.allFinite()) continue;
    std::array<char, 128> text{};
    const int n = std::snprintf(text.data(), text.size(), "%s[%u,%.1f,%.1f,%d]", out.back() == '[' ? "" : ",",
                                t.track.value, raw_px.x(), raw_px.y(), static_cast<int>(t.state));
    out.append(text.data(), std::min<std::size_t>(static_cast<std::size_t>(n), text.size() - 1));
  }
  return out += "]}";
}

const std::string_view kStateSchema =
    R"({"title":"coslam.State","type":"object","properties":{)"
    R"("t_s":{"type":"number"},"run":{"type":"string"},"scale_known":{"type":"boolean"},"finishing":{"type":"boolean"},)"
    R"("result":{"type":"string"},"join":{"type":"string"},)"
    R"("server":{"type":"object"},"agents":{"type":"array","items":{"type":"object"}},)"
    R"("groups":{"type":"array","items":{"type":"array"}},"links":{"type":"array","items":{"type":"array"}}}})";
const std::string_view kEventSchema = R"({"title":"coslam.Event","type":"object","properties":{)"
                                      R"("t_s":{"type":"number"},"kind":{"type":"string"},"text":{"type":"string"},)"
                                      R"("agents":{"type":"array","items":{"type":"string"}}}})";
const std::string_view kTracksSchema =
    R"({"title":"coslam.Tracks","type":"object","properties":{)"
    R"("t_s":{"type":"number"},"width":{"type":"integer"},"height":{"type":"integer"},)"
    R"("tracks":{"type":"array","items":{"type":"array","items":{"type":"number"}}}}})";

}  // namespace coslam
