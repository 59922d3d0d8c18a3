// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>

#include <optional>
#include <vector>

#include "common/wire/messages.h"

// Samples as the octets that a reader gets, for tests that change them.
namespace coslam::test {

using Octets = std::vector<char>;

template <class Message>
Octets serialize(const Message& message) {
  Octets octets(sample_bytes(message));
  eprosima::fastcdr::FastBuffer buffer(octets.data(), octets.size());
  eprosima::fastcdr::Cdr cdr(buffer);
  message.serialize(cdr);
  octets.resize(cdr.getSerializedDataLength());
  return octets;
}

// Empty when the octets are those of no such message; what follows one is passed over.
template <class Message>
std::optional<Message> deserialize(Octets octets) {
  Message message;
  try {
    eprosima::fastcdr::FastBuffer buffer(octets.data(), octets.size());
    eprosima::fastcdr::Cdr cdr(buffer);
    message.deserialize(cdr);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return std::nullopt;
  }
  return message;
}

}  // namespace coslam::test
