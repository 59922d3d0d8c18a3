// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

// The keys of server.yaml below `server.view` (see common/config/config.h).
namespace coslam {

struct ViewConfig {
  int port = -1;  // -1: no web server; 0: a free one
  std::string address = "127.0.0.1";
  std::string token;
  int most_clients = 100;
  std::vector<std::string> origins{"https://app.foxglove.dev"};

  bool on() const { return port >= 0; }
};

template <class V>
void describe(V& v, ViewConfig& c) {
  v.field("port", c.port, {-1, 65535}, "TCP port of the web server; 0: a free one, which it says; -1: none");
  v.field(
      "address", c.address,
      "IP address that it listens on; any but this host's own (127.0.0.1, ::1) needs a token: one is drawn and said");
  v.field("token", c.token, "what clients have to know, as ?token= or Authorization: Bearer; empty: see address");
  v.field("most_clients", c.most_clients, {1, 10000}, "connections at once");
  v.field("origins", c.origins,
          "pages from elsewhere that may connect without a token, beside those from this host: scheme://host[:port]");
}

}  // namespace coslam
