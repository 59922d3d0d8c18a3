// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/fastdds3/names.h"

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

// Common parts of the transports that wrap another one.
namespace coslam {

using Clock = std::chrono::steady_clock;

struct ChainedDescriptor : rtps::ChainingTransportDescriptor {
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  std::uint32_t max_message_size() const override { return maxMessageSize; }
};

// A datagram that a transport is asked to send, with the socket for it. Not kept. The middleware hands it over in
// parts.
class Outgoing {
 public:
  using Parts = std::vector<rtps::NetworkBuffer>;
  Outgoing(rtps::SenderResource& socket, const Parts& parts, std::uint32_t bytes, Clock::time_point deadline)
      : socket_(socket), parts_(parts), bytes_(bytes), deadline_(deadline) {}

  const rtps::SenderResource* socket() const { return &socket_; }
  // All its octets; `room` may be where they lie.
  std::span<const rtps::octet> octets(std::vector<rtps::octet>& room) const {
    room.clear();
    for (const rtps::NetworkBuffer& part : parts_) {
      const auto* from = static_cast<const rtps::octet*>(part.buffer);
      room.insert(room.end(), from, from + part.size);
    }
    return room;
  }

  // Sends it, or others in its place; false: it could not be sent.
  bool send(rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end) const {
    return socket_.send(parts_, bytes_, begin, end, deadline_);
  }
  bool send(std::span<const rtps::octet> octets, rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end) const {
    const auto bytes = static_cast<std::uint32_t>(octets.size());
    return socket_.send({rtps::NetworkBuffer(octets.data(), bytes)}, bytes, begin, end, deadline_);
  }

 private:
  rtps::SenderResource& socket_;
  const Parts& parts_;
  std::uint32_t bytes_;
  Clock::time_point deadline_;
};

// Descriptor: a ChainedDescriptor, which the transport keeps a copy of.
template <class Descriptor>
class ChainedTransport : public rtps::ChainingTransport {
 public:
  explicit ChainedTransport(const Descriptor& descriptor) : ChainingTransport(descriptor), descriptor_(descriptor) {}
  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  void shutdown() override { low_level_transport_->shutdown(); }

 protected:
  // Sends the datagram, or what stands for it, to these; false: it could not be sent.
  virtual bool forward(const Outgoing& datagram, rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end) = 0;
  // The address by which one that was announced is written to.
  virtual rtps::Locator reached_at(const rtps::Locator& announced) const { return announced; }

  Descriptor descriptor_;

 private:
  bool send(rtps::SenderResource* carrier, const std::vector<rtps::NetworkBuffer>& parts, std::uint32_t bytes,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end, const Clock::time_point& deadline) final {
    return forward(Outgoing(*carrier, parts, bytes, deadline), begin, end);
  }
  // The middleware asks by the other one; transports of UDP do not answer this.
  bool transform_remote_locator(const rtps::Locator& remote, rtps::Locator& result) const final {
    return transform_remote_locator(remote, result, true, true);
  }
  bool transform_remote_locator(const rtps::Locator& remote, rtps::Locator& result, bool remote_takes_loopback,
                                bool loopback_is_used) const final {
    return ChainingTransport::transform_remote_locator(reached_at(remote), result, remote_takes_loopback,
                                                       loopback_is_used);
  }
};

// A socket that notes where datagrams go, and sends none.
struct NotedSocket : rtps::SenderResource {
  NotedSocket() : SenderResource(LOCATOR_KIND_UDPv4) {
    send_buffers_lambda_ = [this](const std::vector<NetworkBuffer>&, std::uint32_t, rtps::LocatorsIterator* begin,
                                  rtps::LocatorsIterator* end, const Clock::time_point&) {
      ++calls;
      for (; *begin != *end; ++*begin) destinations.push_back(**begin);
      return true;
    };
  }
  std::vector<rtps::Locator> destinations;
  int calls = 0;
};

// Sends as the middleware does.
inline bool send_by(rtps::ChainingTransport& transport, rtps::SenderResource& socket,
                    std::span<const rtps::octet> octets, const std::vector<rtps::Locator>& destinations) {
  rtps::Locators begin(destinations.cbegin()), end(destinations.cend());
  const auto bytes = static_cast<std::uint32_t>(octets.size());
  return transport.send(&socket, {rtps::NetworkBuffer(octets.data(), bytes)}, bytes, &begin, &end, Clock::now());
}

}  // namespace coslam
