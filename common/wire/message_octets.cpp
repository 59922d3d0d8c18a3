// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/message_octets.h"

#include <exception>

#include "common/wire/middleware.h"

namespace coslam {

template <class Message>
std::vector<std::uint8_t> octets_of(const Message& message) {
  std::vector<std::uint8_t> octets(cdr_bytes(message));
  octets.resize(write_cdr(message, octets));
  return octets;
}

template <class Message>
bool read_octets(std::span<const std::uint8_t> octets, Message& message) {
  std::vector<std::uint8_t> copy(octets.begin(), octets.end());  // the reader's interface asks for what may be written
  try {
    return read_cdr(copy, message);
  } catch (const std::exception&) {  // of several kinds, see Guarded in serialisers.cpp
    return false;
  }
}

template <class Message>
std::size_t sample_bytes(const Message& message) {
  constexpr std::size_t kEncapsulation = 4;
  return cdr_bytes(message) + kEncapsulation;
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

template std::size_t sample_bytes(const idl::Hello&);
template std::size_t sample_bytes(const idl::TrackFrame&);
template std::size_t sample_bytes(const idl::PatchReply&);
template std::size_t sample_bytes(const idl::DescriptorReply&);
template std::size_t sample_bytes(const idl::AgentStatus&);
template std::size_t sample_bytes(const idl::MapPatch&);
template std::size_t sample_bytes(const idl::MovingState&);
template std::size_t sample_bytes(const idl::AgentPose&);
template std::size_t sample_bytes(const idl::AgentImages&);
template std::size_t sample_bytes(const idl::ThumbnailRequest&);
template std::size_t sample_bytes(const idl::Thumbnail&);
template std::size_t sample_bytes(const idl::PublicSample&);
template std::size_t sample_bytes(const idl::ServerStatus&);

}  // namespace coslam
