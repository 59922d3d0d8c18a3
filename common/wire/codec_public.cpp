// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the server tells whoever steers by it, and bridges: AgentPose, PublicSample.
#include <algorithm>

#include "common/base/check.h"
#include "common/wire/checks.h"

namespace coslam {
namespace {

constexpr std::size_t kMostTopic = 128, kMostType = 64;

// Names of topics and types: what may stand in a log and in the name of a DDS topic.
Problem check_word(std::string_view text, std::size_t most) {
  const auto good = [](char c) { return c > ' ' && c < 0x7f; };
  const bool fits = !text.empty() && text.size() <= most && std::ranges::all_of(text, good);
  return fits ? std::nullopt : Problem(Rejection::kBadText);
}

Problem check_variances(const Eigen::Matrix<float, 6, 6>& covariance) {
  if (!covariance.allFinite()) return Rejection::kNotFinite;
  return covariance.diagonal().minCoeff() >= 0 ? std::nullopt : Problem(Rejection::kOutOfRange);
}

}  // namespace

idl::AgentPose encode(const AgentPose& p) {
  idl::AgentPose m;
  m.agent_run(p.agent_run.value);
  m.server_run(p.server_run.value);
  m.t_ns(p.t_ns);
  m.map_id(p.map.value);
  m.epoch(p.epoch.value);
  m.pose_state(static_cast<std::uint8_t>(p.state));
  m.scale_known(p.scale_known);
  m.agent(p.agent);
  const Eigen::Quaterniond& q = p.map_from_cam.rotation;
  m.rotation({q.w(), q.x(), q.y(), q.z()});
  std::copy_n(p.map_from_cam.translation.data(), 3, m.translation().begin());
  for (Eigen::Index i = 0; i < 36; ++i) m.covariance()[static_cast<std::size_t>(i)] = p.covariance(i / 6, i % 6);
  return m;
}

Decoded<AgentPose> decode(const idl::AgentPose& m) {
  AgentPose p;
  p.agent = m.agent().to_string();
  p.agent_run = RunId(m.agent_run());
  p.server_run = RunId(m.server_run());
  p.t_ns = m.t_ns();
  p.map = MapId(m.map_id());
  p.epoch = MapEpoch(m.epoch());
  p.state = static_cast<PoseState>(m.pose_state());
  p.scale_known = m.scale_known();
  const auto& q = m.rotation();
  p.map_from_cam = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]), Eigen::Vector3d(m.translation().data())};
  for (Eigen::Index i = 0; i < 36; ++i) p.covariance(i / 6, i % 6) = m.covariance()[static_cast<std::size_t>(i)];
  const Problem problem = first_of({check_sender(p.agent, p.agent_run), check_id(p.server_run),
                                    check_enum(m.pose_state(), PoseState::kLost), check_pose(p.map_from_cam),
                                    check_variances(p.covariance)});
  if (problem) return *problem;
  if (p.state == PoseState::kTracked && p.map == MapId()) return Rejection::kBadId;
  return p;
}

idl::PublicSample encode(const PublicSample& s) {
  COSLAM_CHECK(s.topic.size() <= kMostTopic && s.type.size() <= kMostType, "the name of a public topic is too long");
  COSLAM_CHECK(s.octets.size() <= idl::MAX_PUBLIC_BYTES, "a public message is too long");
  idl::PublicSample m;
  m.topic(s.topic);
  m.type(s.type);
  m.t_ns(s.t_ns);
  m.octets(s.octets);
  return m;
}

Decoded<PublicSample> decode(const idl::PublicSample& m) {
  PublicSample s{m.topic().to_string(), m.type().to_string(), m.t_ns(), {}};
  const Problem problem = first_of({check_word(s.topic, kMostTopic), check_word(s.type, kMostType),
                                    check_count(m.octets().size(), idl::MAX_PUBLIC_BYTES)});
  if (problem) return *problem;
  if (s.topic.front() != '/') return Rejection::kBadText;
  s.octets = m.octets();
  return s;
}

}  // namespace coslam
