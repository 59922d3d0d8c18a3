// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/wire_config.h"

// The keys of section `wire` in server.yaml and agent.yaml (see common/config/config.h).
namespace coslam {

template <class V>
void describe(V& v, WireConfig& c) {
  v.field("domain", c.domain, {0, 232}, "DDS domain: processes in different domains do not see each other");
  v.field("interfaces", c.interfaces, "IPv4 addresses of this host to use; empty: all");
  v.field("peers", c.peers, "hosts to call instead of multicast, by IPv4 address or name: on agents, the server's");
  v.field(
      "certificates", c.certificates,
      "folder with ca.pem, cert.pem, key.pem, governance.p7s and permissions.p7s of this process; empty: no security");
  v.field("key_file", c.key_file,
          "file with the fleet's key, see docs/security.md; empty: datagrams of strangers are read");
  v.field("max_message_bytes", c.max_message_bytes, {512, 65500},
          "largest datagram: 28 below the MTU of the way at most, 1200 through most tunnels; the same on all hosts");
  v.field("lease_s", c.lease_s, {0.5, 3600}, "a participant unheard for so long is gone; the same on all hosts");
  v.field("announce_s", c.announce_s, {0.05, 1000}, "period of announcements");
  v.field("silent_after_s", c.silent_after_s, {0.05, 1000}, "no sign of life for so long: silent");
}

}  // namespace coslam
