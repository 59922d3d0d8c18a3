// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <optional>
#include <vector>

#include "common/wire/messages.h"
#include "common/wire/middleware.h"

// Samples as the octets that a reader gets, for tests that change them.
namespace coslam::test {

using Octets = std::vector<std::uint8_t>;

template <class Message>
Octets serialize(const Message& message) {
  Octets octets(sample_bytes(message));
  octets.resize(write_cdr(message, octets));
  return octets;
}

// Empty when the octets are those of no such message; what follows one is passed over.
template <class Message>
std::optional<Message> deserialize(Octets octets) {
  Message message;
  try {
    read_cdr(octets, message);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return message;
}

}  // namespace coslam::test
