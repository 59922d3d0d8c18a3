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

// Takes the octets of a received sample, in place. Written samples are spans of octets.
using OnOctets = std::function<void(std::span<const std::uint8_t>)>;

// The topic in this participant, made where it is not there yet. Throws UserError: it is there with another type.
dds::Topic* octet_topic_in(Participant::Impl& participant, const OctetTopic& topic);
// The topic with the project's QoS.
Topic with_qos_of(const OctetTopic& topic);

}  // namespace coslam
