// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/fastdds2/names.h"

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <string>
#include <vector>

namespace coslam {

// Another participant, as the middleware tells of it.
struct FoundParticipant {
  rtps::GUID_t guid;
  std::string name;
  std::vector<rtps::Locator> announcements, data;  // unicast addresses at which it listens
};

struct FoundWriter {
  rtps::GUID_t guid;
  std::string topic, type;  // DDS names
  bool reliable = false;
};

// Told who and what is there, on threads of the middleware.
class DiscoveryListener : public dds::DomainParticipantListener {
 protected:
  virtual void on_found(const FoundParticipant& participant) = 0;  // again when it says something new
  virtual void on_found(const FoundWriter& writer) = 0;
  virtual void on_participant_gone(const rtps::GUID_t& participant) = 0;
  virtual void on_writer_gone(const rtps::GUID_t& writer) = 0;

 private:
  void on_participant_discovery(dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) final {
    using Info = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
    const auto& found = info.info;
    if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT)
      return on_participant_gone(found.m_guid);
    const auto &meta = found.metatraffic_locators.unicast, &data = found.default_locators.unicast;
    on_found(
        {found.m_guid, found.m_participantName.to_string(), {meta.begin(), meta.end()}, {data.begin(), data.end()}});
  }

  void on_publisher_discovery(dds::DomainParticipant*, eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) final {
    const auto& found = info.info;
    if (info.status == eprosima::fastrtps::rtps::WriterDiscoveryInfo::REMOVED_WRITER)
      return on_writer_gone(found.guid());
    on_found({found.guid(), found.topicName().to_string(), found.typeName().to_string(),
              found.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS});
  }
};

}  // namespace coslam
