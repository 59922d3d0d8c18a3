// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/participant_impl.h"

#include <cstdint>
#include <exception>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <span>

#include "common/wire/octet_topic.h"

// Shared by the sources of this folder: samples whose octets somebody else encodes and decodes.
namespace coslam {

// What is written is a span of octets; what is read is handed, in place, to a function.
using OnOctets = std::function<void(std::span<const std::uint8_t>)>;

// The topic in this participant, made where it is not there yet. Throws UserError: it is there with another type.
dds::Topic* octet_topic_in(Participant::Impl& participant, const OctetTopic& topic);
// The same with the project's QoS.
Topic with_qos_of(const OctetTopic& topic);

}  // namespace coslam
