// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/message_octets.h"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <exception>
#include <string>

namespace coslam {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

template <class Message>
std::vector<std::uint8_t> octets_of(const Message& message) {
  std::vector<std::uint8_t> octets(Message::getCdrSerializedSize(message));
  FastBuffer buffer(reinterpret_cast<char*>(octets.data()), octets.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS);
  message.serialize(cdr);
  octets.resize(cdr.getSerializedDataLength());
  return octets;
}

template <class Message>
bool read_octets(std::span<const std::uint8_t> octets, Message& message) {
  std::string copy(octets.begin(), octets.end());  // the reader's interface asks for what may be written
  FastBuffer buffer(copy.data(), copy.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS);
  try {
    message.deserialize(cdr);
  } catch (const std::exception&) {  // of several kinds, see Guarded in serialisers.cpp
    return false;
  }
  return cdr.getSerializedDataLength() == octets.size();
}

template std::vector<std::uint8_t> octets_of(const idl::Hello&);
template std::vector<std::uint8_t> octets_of(const idl::TrackFrame&);
template std::vector<std::uint8_t> octets_of(const idl::PatchReply&);
template std::vector<std::uint8_t> octets_of(const idl::DescriptorReply&);
template std::vector<std::uint8_t> octets_of(const idl::AgentStatus&);
template bool read_octets(std::span<const std::uint8_t>, idl::Hello&);
template bool read_octets(std::span<const std::uint8_t>, idl::TrackFrame&);
template bool read_octets(std::span<const std::uint8_t>, idl::PatchReply&);
template bool read_octets(std::span<const std::uint8_t>, idl::DescriptorReply&);
template bool read_octets(std::span<const std::uint8_t>, idl::AgentStatus&);

}  // namespace coslam
