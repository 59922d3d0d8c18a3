// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace coslam {

// Size limit of a UDP datagram, as the middleware counts.
constexpr int kMostMessageBytes = 65'500;

// Settings with which a process joins the network. Times and rates must be the same on all hosts unless the comment
// says otherwise.
struct WireConfig {
  int domain = 0;                       // DDS domain, 0 to 232: processes in different domains do not see each other
  std::vector<std::string> interfaces;  // IPv4 addresses of this host to use; empty = all
  std::vector<std::string> peers;       // IPv4 addresses or names to call instead of multicast: on agents, the server's
  std::vector<std::string> also_call;   // besides: where others were before this process joined anew; no setting
  bool own_host = false;     // processes of this host that name its other addresses are reached on the loopback device;
                             // for ROS 2 alone, no setting
  int peer_range = 4;        // participants on each peer that are called; every announcement goes to all
  std::string certificates;  // directory with ca.pem, cert.pem, key.pem, governance.p7s, permissions.p7s of this
                             // process; empty = no security
  std::string key_file;      // the fleet's key, see guard.h; the same content on all hosts; empty = whoever can send
                             // datagrams to this process can stop it

  double lease_s = 3.0;         // a participant unheard for this long is gone
  double announce_s = 1.0;      // period of announcements; at most a third of lease_s
  double silent_after_s = 0.5;  // no sign of life from an agent or server for this long: silent

  std::uint32_t bulk_bytes_per_s = 1'250'000;  // pace of patches and descriptors; below the uplink's rate; 0 = no limit
  int max_message_bytes = 1400;                // largest datagram: below the MTU, or one loss costs a whole sample
  std::uint32_t receive_buffer_bytes = 4u << 20;  // kernel buffers; the kernel cuts them to net.core.rmem_max, wmem_max
  std::uint32_t send_buffer_bytes = 1u << 20;
};

// All processes on this machine, nothing on the network: what `coslam run` uses.
WireConfig loopback_config(int domain);

}  // namespace coslam
