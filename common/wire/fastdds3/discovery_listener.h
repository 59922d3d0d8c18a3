// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/fastdds3/names.h"

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
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryStatus status,
                                const dds::ParticipantBuiltinTopicData& found, bool& ignored) final {
    ignored = false;
    using Status = rtps::ParticipantDiscoveryStatus;
    if (status == Status::REMOVED_PARTICIPANT || status == Status::DROPPED_PARTICIPANT)
      return on_participant_gone(found.guid);
    const auto &meta = found.metatraffic_locators.unicast, &data = found.default_locators.unicast;
    on_found({found.guid, found.participant_name.to_string(), {meta.begin(), meta.end()}, {data.begin(), data.end()}});
  }

  void on_data_writer_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryStatus status,
                                const dds::PublicationBuiltinTopicData& found, bool& ignored) final {
    ignored = false;
    if (status == rtps::WriterDiscoveryStatus::REMOVED_WRITER) return on_writer_gone(found.guid);
    on_found({found.guid, found.topic_name.to_string(), found.type_name.to_string(),
              found.reliability.kind == dds::RELIABLE_RELIABILITY_QOS});
  }
};

}  // namespace coslam
