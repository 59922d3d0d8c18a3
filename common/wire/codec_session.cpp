// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Who takes part and how they are: Hello, AgentStatus, ServerStatus.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/wire/checks.h"
#include "common/wire/reply_parts.h"

namespace coslam {
namespace {

constexpr std::size_t kMaxName = 32;
constexpr std::size_t kMaxSentence = 200;

// Each name is followed by a space. Those beyond the bound are left out: others say how many come in a server's life.
std::string pack_names(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), idl::MAX_AGENTS); ++i) text += names[i] + ' ';
  return text;
}

// Each item is followed by `end`; text after the last one is lost, as a cut-off item is.
std::vector<std::string> split(const std::string& text, char end) {
  std::vector<std::string> items;
  std::size_t begin = 0;
  for (std::size_t at = 0; (at = text.find(end, begin)) != std::string::npos; begin = at + 1) {
    items.push_back(text.substr(begin, at - begin));
  }
  return items;
}

Problem unpack_names(const idl::ServerStatus& m, std::vector<std::string>& names) {
  names = split(m.agents().to_string(), ' ');
  if (const Problem p = check_count(names.size(), idl::MAX_AGENTS)) return p;
  return std::ranges::all_of(names, valid_agent_name) ? std::nullopt : Problem(Rejection::kBadText);
}

Problem unpack_refusals(const idl::ServerStatus& m, std::vector<Refusal>& refused) {
  if (const Problem p = check_count(m.refused().size(), idl::MAX_REFUSALS)) return p;
  const std::vector<std::string> reasons = split(m.reasons().to_string(), '\n');
  if (reasons.size() != m.refused().size()) return Rejection::kSizeMismatch;
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    refused.push_back({RunId(m.refused()[i]), reasons[i]});
    if (const Problem p = first_of({check_id(refused.back().agent_run), check_sentence(reasons[i], kMaxSentence)}))
      return p;
  }
  return std::nullopt;
}

CameraModel camera_of(const idl::Hello& m) {
  CameraModel c;
  // Far outside the range of an image size becomes 0, which is outside too.
  c.width_px = m.width_px() > INT32_MAX ? 0 : static_cast<int>(m.width_px());
  c.height_px = m.height_px() > INT32_MAX ? 0 : static_cast<int>(m.height_px());
  c.fx = m.fx();
  c.fy = m.fy();
  c.cx = m.cx();
  c.cy = m.cy();
  c.distortion = static_cast<DistortionModel>(m.distortion());
  c.coefficients = m.coefficients();
  return c;
}

Problem check_camera(const CameraModel& c) {
  const auto finite = [](double v) { return std::isfinite(v); };
  if (!std::ranges::all_of(std::array{c.fx, c.fy, c.cx, c.cy}, finite)) return Rejection::kNotFinite;
  if (!std::ranges::all_of(c.coefficients, finite)) return Rejection::kNotFinite;
  return problem_of(c) ? Problem(Rejection::kOutOfRange) : std::nullopt;
}

// This sender's, all of it.
Decoded<std::optional<DescriptorReply>> decode_last_image(const idl::AgentStatus& m) {
  if (m.last_image().empty()) return std::optional<DescriptorReply>();
  std::vector<DescriptorReply> parts;
  for (const idl::DescriptorReply& message : m.last_image()) {
    auto part = decode(message);
    if (!part) return part.rejection();
    parts.push_back(std::move(*part));
  }
  auto whole = in_one(std::move(parts));
  if (!whole) return whole.rejection();
  if (whole->agent != m.agent().to_string() || whole->agent_run.value != m.agent_run()) return Rejection::kWrongRun;
  return std::optional(std::move(*whole));
}

}  // namespace

bool valid_agent_name(std::string_view name) {
  const auto good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
  };
  return !name.empty() && name.size() <= kMaxName && name.front() != '.' && std::ranges::all_of(name, good);
}

idl::Hello encode(const Hello& h) {
  const CameraModel& c = h.camera;
  idl::Hello m;
  m.protocol(h.protocol);
  m.pacing(static_cast<std::uint8_t>(h.pacing));
  m.distortion(static_cast<std::uint8_t>(c.distortion));
  m.width_px(static_cast<std::uint32_t>(c.width_px));
  m.agent_run(h.agent_run.value);
  m.height_px(static_cast<std::uint32_t>(c.height_px));
  m.agent(h.agent);
  m.rate_hz(h.rate_hz);
  m.fx(c.fx);
  m.fy(c.fy);
  m.cx(c.cx);
  m.cy(c.cy);
  m.coefficients(c.coefficients);
  return m;
}

Decoded<Hello> decode(const idl::Hello& m) {
  Hello h;
  h.agent = m.agent().to_string();
  h.agent_run = RunId(m.agent_run());
  h.protocol = m.protocol();
  h.pacing = static_cast<Pacing>(m.pacing());
  h.rate_hz = m.rate_hz();
  h.camera = camera_of(m);
  const Problem problem = first_of({check_sender(h.agent, h.agent_run), check_enum(m.pacing(), Pacing::kLockstep),
                                    check_enum(m.distortion(), kLastDistortionModel),
                                    check_number(h.rate_hz, 0.001, 10000), check_camera(h.camera)});
  if (problem) return *problem;
  return h;
}

idl::AgentStatus encode(const AgentStatus& s) {
  COSLAM_CHECK(s.report_json.size() <= idl::MAX_REPORT_BYTES, "the report of an agent is too long");
  idl::AgentStatus m;
  m.agent_run(s.agent_run.value);
  m.frames(s.frames);
  m.dropped(s.dropped);
  m.left_out(s.left_out);
  m.tracks(s.tracks);
  m.frame_ms(s.frame_ms);
  m.patch_sent_ns(s.exchange.sent_ns);
  m.patch_received_ns(s.exchange.received_ns);
  m.sent_ns(s.exchange.replied_ns);
  m.state(static_cast<std::uint8_t>(s.state));
  m.pose_state(static_cast<std::uint8_t>(s.pose_state));
  m.image_fault(static_cast<std::uint8_t>(s.image_fault));
  m.agent(s.agent);
  m.report_json().assign(s.report_json.begin(), s.report_json.end());
  if (!s.last_image) return m;
  for (const DescriptorReply& part : in_parts(*s.last_image)) m.last_image().push_back(encode(part));
  return m;
}

Decoded<AgentStatus> decode(const idl::AgentStatus& m) {
  AgentStatus s;
  s.agent = m.agent().to_string();
  s.agent_run = RunId(m.agent_run());
  const Problem problem =
      first_of({check_sender(s.agent, s.agent_run), check_enum(m.state(), AgentState::kFinished),
                check_enum(m.pose_state(), PoseState::kLost), check_enum(m.image_fault(), ImageFault::kFeatureless),
                check_number(m.frame_ms(), 0, 1e9), check_count(m.report_json().size(), idl::MAX_REPORT_BYTES)});
  if (problem) return *problem;
  s.state = static_cast<AgentState>(m.state());
  s.pose_state = static_cast<PoseState>(m.pose_state());
  s.image_fault = static_cast<ImageFault>(m.image_fault());
  s.frames = m.frames();
  s.dropped = m.dropped();
  s.left_out = m.left_out();
  s.tracks = m.tracks();
  s.frame_ms = m.frame_ms();
  s.exchange = {m.patch_sent_ns(), m.patch_received_ns(), m.sent_ns(), 0};
  s.report_json.assign(m.report_json().begin(), m.report_json().end());
  auto last_image = decode_last_image(m);
  if (!last_image) return last_image.rejection();
  s.last_image = std::move(*last_image);
  return s;
}

idl::ServerStatus encode(const ServerStatus& s) {
  COSLAM_CHECK(s.refused.size() <= idl::MAX_REFUSALS, "more refusals than a status may carry");
  idl::ServerStatus m;
  m.protocol(s.protocol);
  m.started(s.started);
  m.stopping(s.stopping);
  m.frame_sets(s.frame_sets);
  m.server_run(s.server_run.value);
  m.start_utc_ns(s.start_utc_ns);
  m.points(s.points);
  std::string reasons;
  for (const Refusal& r : s.refused) {
    m.refused().push_back(r.agent_run.value);
    reasons += r.reason.substr(0, kMaxSentence) + '\n';
  }
  m.agents(pack_names(s.agents));
  m.reasons(reasons);
  return m;
}

Decoded<ServerStatus> decode(const idl::ServerStatus& m) {
  ServerStatus s;
  s.server_run = RunId(m.server_run());
  if (const Problem p = check_id(s.server_run)) return *p;
  if (const Problem p = unpack_names(m, s.agents)) return *p;
  if (const Problem p = unpack_refusals(m, s.refused)) return *p;
  s.protocol = m.protocol();
  s.started = m.started();
  s.stopping = m.stopping();
  s.start_utc_ns = m.start_utc_ns();
  s.frame_sets = m.frame_sets();
  s.points = m.points();
  return s;
}

}  // namespace coslam
