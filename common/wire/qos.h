// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>  // first: other orders are ambiguous in C++20

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "common/wire/topics.h"
#include "common/wire/wire_config.h"

// Every QoS setting of the project, with its reason. Only for the sources of this folder: the headers are heavy.
namespace coslam {

// Participants of one domain on one host: what callers on the loopback device reach.
constexpr int kMostPerHost = 32;

// What the topics differ in.
struct Profile {
  bool reliable;       // lost samples are sent again
  bool late_joiners;   // the writer keeps the newest sample for readers that come later (transient local)
  int writer_depth;    // samples kept per key until sent and acknowledged; the oldest makes room
  int reader_depth;    // samples kept per key until taken
  double heartbeat_s;  // how soon a reader learns that it missed the last sample
  bool paced;          // sent no faster than WireConfig::bulk_bytes_per_s
  bool sign_of_life;   // the reader is told when the writer falls silent
};

const Profile& profile_of(Topic topic);

eprosima::fastdds::dds::DomainParticipantQos participant_qos(const WireConfig& config, const std::string& name);
eprosima::fastdds::dds::DataWriterQos writer_qos(Topic topic, const WireConfig& config);
eprosima::fastdds::dds::DataReaderQos reader_qos(Topic topic, const WireConfig& config);

}  // namespace coslam
