// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <compare>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "common/wire/ipv4_endpoint.h"

namespace coslam {

// The prefix of the GUIDs of a participant of DDS.
using ParticipantKey = std::array<std::uint8_t, 12>;

// Chooses the address to which a peer with several is written, as one on Wi-Fi and a radio: one at which it was heard
// of late, since otherwise every byte would be sent once per path. All addresses are used as long as the peer was heard
// on none.
//
// Of two participants the one with the smaller key leads. It keeps to the first way on which it hears the other. The
// other answers on the way on which it heard the leader last. Where that one is silent for kFresh, as after a cable was
// pulled, both write on all ways until they hear each other again. A peer that writes on all ways to a leader does
// not hear it: the leader then tries the next way. Thread-safe.
class PeerPaths {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::milliseconds kFresh{1000};

  void set_own(const ParticipantKey& key);
  void set_peer(const ParticipantKey& key, const std::vector<Ipv4Endpoint>& endpoints);
  void forget(const ParticipantKey& key);
  void heard(const ParticipantKey& key, std::uint32_t address, TimePoint now);
  // Whether a datagram to this endpoint is to be sent.
  bool goes(const Ipv4Endpoint& destination, TimePoint now);

 private:
  struct Path {
    std::optional<TimePoint> heard;
    std::optional<TimePoint> tried_in_vain;
    int datagrams = 0, datagrams_before = 0;  // in this second and in the one before
  };
  struct Peer {
    std::map<std::uint32_t, Path> paths;  // keyed by address
    std::optional<std::uint32_t> chosen;
    TimePoint chosen_at, second;
  };

  static bool is_fresh(const Path& path, TimePoint now) { return path.heard && now - *path.heard < kFresh; }
  static bool is_deaf(const Peer& peer, TimePoint now);
  static void lead(Peer* peer, TimePoint now);
  static void follow(Peer* peer, TimePoint now);

  std::mutex mutex_;
  ParticipantKey own_key_{};
  std::map<ParticipantKey, Peer> peers_;
  std::map<Ipv4Endpoint, ParticipantKey> by_endpoint_;
};

}  // namespace coslam
