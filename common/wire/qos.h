// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>  // first: other orders are ambiguous in C++20

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "common/wire/counters.h"
#include "common/wire/messages.h"
#include "common/wire/peer_paths.h"
#include "common/wire/wire_config.h"

// Every QoS setting of the project, with its reason; what the topics differ in stands in messages.h. Only for the
// sources of this folder: the headers are heavy.
namespace coslam {

// Datagrams without the key of `config` are counted in `refused`; by which of their addresses others are written to
// stands in `paths`. Both outlive the participant. Throws UserError: the file of the key.
eprosima::fastdds::dds::DomainParticipantQos participant_qos(const WireConfig& config, const std::string& name,
                                                             RejectionCounts& refused, PeerPaths& paths);
eprosima::fastdds::dds::DataWriterQos writer_qos(const Topic& topic, const WireConfig& config,
                                                 Repeat repeat = Repeat::kUsual);
eprosima::fastdds::dds::DataReaderQos reader_qos(const Topic& topic, const WireConfig& config);

}  // namespace coslam
