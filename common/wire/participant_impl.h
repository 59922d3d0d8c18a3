// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/wire/middleware.h"
#include "common/wire/participant.h"
#include "common/wire/peer_paths.h"
#include "common/wire/single_path_transport.h"

// Shared by the sources of this folder.
namespace coslam {

inline ParticipantKey participant_key(const rtps::GUID_t& guid) {
  ParticipantKey key;
  std::ranges::copy(guid.guidPrefix.value, key.begin());
  return key;
}

struct Participant::Impl : DiscoveryListener {
  struct Counts {
    std::atomic<std::uint64_t> sent{0}, sent_bytes{0}, received{0}, received_bytes{0};
  };

  WireConfig config;
  dds::DomainParticipant* participant = nullptr;
  int id = 0;  // number that determines the ports
  std::array<Counts, kTopicCount> counts;
  std::shared_ptr<RejectionCounts> rejections;
  PeerPaths paths;
  std::atomic<bool> given_up{false};
  std::mutex topics_mutex;

  std::mutex others_mutex;
  struct Other {
    std::string name;
    std::vector<std::string> addresses;
  };
  std::map<rtps::GUID_t, Other> others;
  std::map<rtps::GUID_t, OfferedTopic> offered;  // keyed by writer

  // Callbacks on threads of the middleware that note who and what is there.
  void on_found(const FoundParticipant& found) override {
    note_paths(found);
    const std::lock_guard lock(others_mutex);
    Other& other = others[found.guid] = {found.name, {}};
    for (const auto& locator : found.announcements) other.addresses.push_back(rtps::IPLocator::toIPv4string(locator));
  }

  void on_participant_gone(const rtps::GUID_t& guid) override {
    paths.forget(participant_key(guid));
    const std::lock_guard lock(others_mutex);
    others.erase(guid);
    std::erase_if(offered, [&](const auto& writer) { return writer.first.guidPrefix == guid.guidPrefix; });
  }

  void on_found(const FoundWriter& found) override {
    const std::lock_guard lock(others_mutex);
    offered[found.guid] = {found.topic, found.type, found.reliable};
  }

  void on_writer_gone(const rtps::GUID_t& guid) override {
    const std::lock_guard lock(others_mutex);
    offered.erase(guid);
  }

  // Addresses of the loopback device are nobody's in particular.
  void note_paths(const FoundParticipant& found) {
    std::vector<Ipv4Endpoint> endpoints;
    for (const auto* locators : {&found.data, &found.announcements}) {
      for (const auto& locator : *locators) {
        if (!rtps::IPLocator::isLocal(locator)) endpoints.push_back(ipv4_endpoint(locator));
      }
    }
    paths.set_peer(participant_key(found.guid), endpoints);
  }

  // The topic kTopics[index], created at first use.
  dds::Topic* topic(std::size_t index);

  std::uint64_t cost(std::size_t sample_bytes) const {
    return link_bytes(sample_bytes, config.max_message_bytes, !config.key_file.empty());
  }
};

}  // namespace coslam
