// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "agent/agent_config.h"
#include "agent/capture/source.h"
#include "common/wire/wire_options.h"

namespace coslam {

// All keys of agent.yaml.
struct AgentOptions {
  std::string id = "cam0";
  std::string source;
  std::string calibration;
  std::string rate = "1";
  SourceOptions play;
  WireConfig wire;
  AgentConfig agent;
};

template <class V>
void describe(V& v, AgentOptions& o) {
  v.field("id", o.id, "name of this agent, unique among those of one server");
  v.field("source", o.source,
          "image folder, list.csv, video, EuRoC or TUM folder, bag:PATH#TOPIC, ros2:/TOPIC, v4l2:N, gst:PIPELINE, "
          "rtsp://...");
  v.field("calibration", o.calibration,
          "camera calibration: a file, bag:PATH#TOPIC or ros2:/TOPIC; empty: found out from the images");
  v.field("rate", o.rate, "speed of replay: a factor, or max (waits for the server, drops nothing)");
  v.field("start_s", o.play.start_s, {-3600, 1e9}, "offset into the source; negative: it plays so much later");
  v.field("rate_hz", o.play.rate_hz, {0.01, 1000}, "nominal frame rate");
  v.section("wire", o.wire);
  v.section("agent", o.agent);
}

}  // namespace coslam
