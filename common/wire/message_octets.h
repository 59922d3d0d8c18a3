// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/wire/messages.h"

// Messages from agents as octets outside of DDS, for files: CDR, little endian, without an encapsulation header.
namespace coslam {

template <class Message>
std::vector<std::uint8_t> octets_of(const Message& message);

// Reads a message of the IDL; false when the octets are not those of one. The message still has to be decoded
// (codec.h).
template <class Message>
bool read_octets(std::span<const std::uint8_t> octets, Message& message);

}  // namespace coslam
