// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>  // first: other orders are ambiguous in C++20

#include <fastrtps/utils/IPLocator.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/wire/participant.h"
#include "common/wire/peer_paths.h"
#include "common/wire/single_path_transport.h"

// Shared by the sources of this folder.
namespace coslam {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::types::ReturnCode_t;

inline ParticipantKey participant_key(const eprosima::fastrtps::rtps::GUID_t& guid) {
  ParticipantKey key;
  std::ranges::copy(guid.guidPrefix.value, key.begin());
  return key;
}

struct Participant::Impl : dds::DomainParticipantListener {
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
  std::map<eprosima::fastrtps::rtps::GUID_t, Other> others;
  std::map<eprosima::fastrtps::rtps::GUID_t, OfferedTopic> offered;  // keyed by writer

  // Callbacks on threads of the middleware that note who and what is there.
  void on_participant_discovery(dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override {
    using Info = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
    note_paths(info);
    const std::lock_guard lock(others_mutex);
    if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
      others.erase(info.info.m_guid);
      std::erase_if(offered,
                    [&](const auto& writer) { return writer.first.guidPrefix == info.info.m_guid.guidPrefix; });
    } else {
      Other& other = others[info.info.m_guid] = {info.info.m_participantName.to_string(), {}};
      for (const auto& locator : info.info.metatraffic_locators.unicast)
        other.addresses.push_back(eprosima::fastrtps::rtps::IPLocator::toIPv4string(locator));
    }
  }

  void on_publisher_discovery(dds::DomainParticipant*, eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override {
    const std::lock_guard lock(others_mutex);
    if (info.status == eprosima::fastrtps::rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
      offered.erase(info.info.guid());
    } else {
      offered[info.info.guid()] = {info.info.topicName().to_string(), info.info.typeName().to_string(),
                                   info.info.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS};
    }
  }

  // Addresses of the loopback device are nobody's in particular.
  void note_paths(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info) {
    using Info = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
    const ParticipantKey key = participant_key(info.info.m_guid);
    if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) return paths.forget(key);
    std::vector<Ipv4Endpoint> endpoints;
    for (const auto* locators : {&info.info.default_locators.unicast, &info.info.metatraffic_locators.unicast}) {
      for (const auto& locator : *locators) {
        using eprosima::fastrtps::rtps::IPLocator;
        if (!IPLocator::isLocal(locator)) endpoints.push_back(ipv4_endpoint(locator));
      }
    }
    paths.set_peer(key, endpoints);
  }

  // The topic kTopics[index], created at first use.
  dds::Topic* topic(std::size_t index);

  std::uint64_t cost(std::size_t sample_bytes) const {
    return link_bytes(sample_bytes, config.max_message_bytes, !config.key_file.empty());
  }
};

}  // namespace coslam
