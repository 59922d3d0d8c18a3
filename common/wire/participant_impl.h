// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>  // first: other orders are ambiguous in C++20

#include <array>
#include <atomic>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <map>
#include <mutex>

#include "common/wire/participant.h"
#include "idl/coslamPubSubTypes.h"

// Shared by the sources of this folder.
namespace coslam {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::types::ReturnCode_t;

// The generated serialiser, safe against strangers: it catches one kind of exception of its decoder only, and the
// others would end the process from a thread of the middleware.
template <class Generated>
struct Guarded : Generated {
  explicit Guarded(RejectionCounts& counts) : rejections(counts) {}

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    try {
      if (Generated::deserialize(payload, data)) return true;
    } catch (const std::exception&) {
    }
    rejections.add(Rejection::kMalformed);
    return false;
  }

  RejectionCounts& rejections;
};

template <class Message>
struct Serialiser;
template <>
struct Serialiser<idl::Hello> {
  using type = Guarded<idl::HelloPubSubType>;
};
template <>
struct Serialiser<idl::TrackFrame> {
  using type = Guarded<idl::TrackFramePubSubType>;
};
template <>
struct Serialiser<idl::PatchReply> {
  using type = Guarded<idl::PatchReplyPubSubType>;
};
template <>
struct Serialiser<idl::DescriptorReply> {
  using type = Guarded<idl::DescriptorReplyPubSubType>;
};
template <>
struct Serialiser<idl::AgentStatus> {
  using type = Guarded<idl::AgentStatusPubSubType>;
};
template <>
struct Serialiser<idl::MapPatch> {
  using type = Guarded<idl::MapPatchPubSubType>;
};
template <>
struct Serialiser<idl::MovingState> {
  using type = Guarded<idl::MovingStatePubSubType>;
};
template <>
struct Serialiser<idl::ServerStatus> {
  using type = Guarded<idl::ServerStatusPubSubType>;
};

struct Participant::Impl : dds::DomainParticipantListener {
  struct Counts {
    std::atomic<std::uint64_t> sent{0}, sent_bytes{0}, received{0}, received_bytes{0};
  };

  WireConfig config;
  dds::DomainParticipant* participant = nullptr;
  std::array<Counts, kTopicCount> counts;
  RejectionCounts rejections;
  std::mutex topics_mutex;

  std::mutex others_mutex;
  std::map<eprosima::fastrtps::rtps::GUID_t, std::string> others;

  // Takes note, on a thread of the middleware.
  void on_participant_discovery(dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override {
    using Info = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
    const std::lock_guard lock(others_mutex);
    if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
      others.erase(info.info.m_guid);
    } else {
      others[info.info.m_guid] = info.info.m_participantName.to_string();
    }
  }

  Counts& counts_of(coslam::Topic topic) { return counts[static_cast<std::size_t>(topic)]; }

  // The topic of the message, created at first use.
  template <class Message>
  dds::Topic* topic() {
    const std::lock_guard lock(topics_mutex);
    const std::string name = name_of(kTopicOf<Message>);
    if (dds::TopicDescription* known = participant->lookup_topicdescription(name)) {
      return static_cast<dds::Topic*>(known);
    }
    const dds::TypeSupport type(new typename Serialiser<Message>::type(rejections));
    type.register_type(participant);
    return participant->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  }

  std::uint64_t cost(std::size_t sample_bytes) const { return link_bytes(sample_bytes, config.max_message_bytes); }
};

}  // namespace coslam
