// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/counters.h"
#include "common/wire/messages.h"
#include "common/wire/middleware.h"
#include "common/wire/peer_paths.h"
#include "common/wire/wire_config.h"

// Every QoS setting of the project, with its reason; what the topics differ in stands in messages.h. Only for the
// sources of this folder: the headers are heavy.
namespace coslam {

// Datagrams without the key of `config` are counted in `refused`; by which of their addresses others are written to
// stands in `paths`. Both outlive the participant. Throws UserError: the file of the key.
dds::DomainParticipantQos participant_qos(const WireConfig& config, const std::string& name, RejectionCounts& refused,
                                          PeerPaths& paths);
dds::DataWriterQos writer_qos(const Topic& topic, const WireConfig& config, Repeat repeat = Repeat::kUsual);
dds::DataReaderQos reader_qos(const Topic& topic, const WireConfig& config);

}  // namespace coslam
