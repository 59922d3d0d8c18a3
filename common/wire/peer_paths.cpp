// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/peer_paths.h"

#include <algorithm>
#include <utility>

namespace coslam {

namespace {

using namespace std::chrono_literals;

constexpr auto kSettled = 2 * PeerPaths::kFresh;  // then the other one has had time to choose, too
constexpr auto kTryAgain = 30s;                   // a way on which the other one did not hear
constexpr int kFewDatagrams = 4;                  // in a second: announcements to a group go on all ways

}  // namespace

void PeerPaths::set_own(const ParticipantKey& key) {
  const std::lock_guard lock(mutex_);
  own_key_ = key;
}

void PeerPaths::set_peer(const ParticipantKey& key, const std::vector<Ipv4Endpoint>& endpoints) {
  const std::lock_guard lock(mutex_);
  std::erase_if(by_endpoint_, [&](const auto& known) { return known.second == key; });
  Peer& peer = peers_[key];
  std::map<std::uint32_t, Path> paths;
  for (const Ipv4Endpoint& e : endpoints) {
    by_endpoint_[e] = key;
    paths[e.address] = peer.paths[e.address];
  }
  peer.paths = std::move(paths);
  if (peer.chosen && !peer.paths.contains(*peer.chosen)) peer.chosen.reset();
}

void PeerPaths::forget(const ParticipantKey& key) {
  const std::lock_guard lock(mutex_);
  std::erase_if(by_endpoint_, [&](const auto& known) { return known.second == key; });
  peers_.erase(key);
}

void PeerPaths::heard(const ParticipantKey& key, std::uint32_t address, TimePoint now) {
  const std::lock_guard lock(mutex_);
  const auto peer = peers_.find(key);
  if (peer == peers_.end()) return;
  auto& [paths, chosen, chosen_at, second] = peer->second;
  const auto path = paths.find(address);
  if (path == paths.end()) return;
  if (now - second >= 1s) {
    for (auto& [other, p] : paths) p.datagrams_before = now - second < 2s ? std::exchange(p.datagrams, 0) : 0;
    second = now;
  }
  path->second.heard = now;
  ++path->second.datagrams;
}

bool PeerPaths::goes(const Ipv4Endpoint& destination, TimePoint now) {
  const std::lock_guard lock(mutex_);
  const auto key = by_endpoint_.find(destination);
  if (key == by_endpoint_.end()) return true;
  Peer& peer = peers_.at(key->second);
  if (peer.paths.size() < 2) return true;
  if (own_key_ < key->second) {
    lead(&peer, now);
  } else {
    follow(&peer, now);
  }
  return !peer.chosen || *peer.chosen == destination.address;
}

bool PeerPaths::is_deaf(const Peer& peer, TimePoint now) {
  if (now - peer.chosen_at < kSettled) return false;
  const int on_chosen = peer.paths.at(*peer.chosen).datagrams_before;
  return std::ranges::any_of(peer.paths, [&](const auto& path) {
    return path.first != *peer.chosen && path.second.datagrams_before > std::max(kFewDatagrams, on_chosen / 2);
  });
}

void PeerPaths::lead(Peer* peer, TimePoint now) {
  if (peer->chosen && is_fresh(peer->paths.at(*peer->chosen), now)) {
    if (!is_deaf(*peer, now)) return;
    peer->paths.at(*peer->chosen).tried_in_vain = now;
  }
  peer->chosen.reset();
  for (const auto& [address, path] : peer->paths) {
    if (!is_fresh(path, now) || (path.tried_in_vain && now - *path.tried_in_vain < kTryAgain)) continue;
    if (!peer->chosen || path.heard < peer->paths.at(*peer->chosen).heard) peer->chosen = address;
  }
  peer->chosen_at = now;
}

void PeerPaths::follow(Peer* peer, TimePoint now) {
  peer->chosen.reset();
  for (const auto& [address, path] : peer->paths) {
    if (is_fresh(path, now) && (!peer->chosen || path.heard > peer->paths.at(*peer->chosen).heard))
      peer->chosen = address;
  }
}

}  // namespace coslam
