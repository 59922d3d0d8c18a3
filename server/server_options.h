// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/wire/wire_options.h"
#include "server/server_config.h"

namespace coslam {

// All keys of server.yaml.
struct ServerOptions {
  std::vector<std::string> agents;
  WireConfig wire;
  ServerConfig server;
};

template <class V>
void describe(V& v, ServerOptions& o) {
  v.field("agents", o.agents,
          "wait for these, number cameras in this order, end when they have ended; empty: run until stopped");
  v.section("wire", o.wire);
  v.section("server", o.server);
}

}  // namespace coslam
