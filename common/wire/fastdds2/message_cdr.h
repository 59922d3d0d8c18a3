// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <cstddef>
#include <cstdint>
#include <span>

// Messages of the IDL as plain CDR, little endian, without an encapsulation header. Message: of idl/coslam.h.
namespace coslam {

template <class Message>
std::size_t cdr_bytes(const Message& message) {
  return Message::getCdrSerializedSize(message);
}

// Writes it to the front of `octets`, which has room; returns how many octets it has.
template <class Message>
std::size_t write_cdr(const Message& message, std::span<std::uint8_t> octets) {
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(octets.data()), octets.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS);
  message.serialize(cdr);
  return cdr.getSerializedDataLength();
}

// Reads a message; false: the octets are not one as a whole. Throws exceptions of several kinds.
template <class Message>
bool read_cdr(std::span<std::uint8_t> octets, Message& message) {
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(octets.data()), octets.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS);
  message.deserialize(cdr);
  return cdr.getSerializedDataLength() == octets.size();
}

}  // namespace coslam
