// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/answers.h"

#include "common/base/log.h"
#include "server/estimator/correct/pose_writer.h"

namespace coslam {

void send_answers(const FrameSet& set, std::vector<MapPatch> patches, const MapServer& server, Roster& roster,
                  const SetClock& sets, const std::function<TimeNs()>& monotonic_ns, ServerLink* link) {
  for (MapPatch& patch : patches) {
    if (!sets.lockstep()) {
      patch.sent_ns = monotonic_ns();
      patch.uplink_wait_s = static_cast<float>(sets.wait_s(roster.at(patch.agent).camera));
    }
    link->send(patch);
  }
  for (const MovingState& state : server.report<MovingStates>().all) link->send(state);
  const auto in_metres = [&](MapId map) { return server.scale_known(map); };
  for (const AgentPose& pose : agent_poses(server.map(), set, server.run(), in_metres)) link->send(pose);
}

ServerStatus status_of(const MapServer& server, const Roster& roster) {
  ServerStatus status;
  status.server_run = server.run();
  status.frame_sets = static_cast<std::uint32_t>(server.counts().frame_sets);
  status.points = static_cast<std::uint32_t>(server.map().points().size());
  status.agents = roster.names();
  return status;
}

void log_images(const AgentStatus& status) {
  if (status.image_fault == ImageFault::kNone) {
    log_info("agent " + status.agent + ": its images are to be believed again");
  } else {
    log_warn("agent " + status.agent +
             ": its images are not to be believed: " + std::string(words_of(status.image_fault).why));
  }
}

}  // namespace coslam
