// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/wire/wire_options.h"
#include "server/app/server_config.h"
#include "server/show/web/view_config.h"

namespace coslam {

// All keys of server.yaml.
struct ServerOptions {
  std::vector<std::string> agents;
  WireConfig wire;
  ServerConfig server;
  ViewConfig view;
};

template <class V>
void describe(V& v, ServerOptions& o) {
  v.field("agents", o.agents,
          "wait for these, number cameras in this order, end when they have ended; empty: run until stopped");
  v.section("wire", o.wire);
  v.section("server", o.server);
  v.section("server.view", o.view);
}

// Copies options for printing, without secrets.
template <class Options>
Options without_secrets(Options options) {
  if (!options.view.token.empty()) options.view.token = "(not told)";
  return options;
}

}  // namespace coslam
