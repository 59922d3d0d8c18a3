// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>  // first: other orders are ambiguous in C++20

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/rtps/common/LocatorList.hpp>

#include <chrono>

// Common parts of the transports that wrap another one; only for the sources of this folder.
namespace coslam {

namespace rtps = eprosima::fastdds::rtps;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;
using Clock = std::chrono::steady_clock;

struct ChainedDescriptor : rtps::ChainingTransportDescriptor {
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  std::uint32_t max_message_size() const override { return maxMessageSize; }
};

// Descriptor: a ChainedDescriptor, which the transport keeps a copy of.
template <class Descriptor>
class ChainedTransport : public rtps::ChainingTransport {
 public:
  explicit ChainedTransport(const Descriptor& descriptor) : ChainingTransport(descriptor), descriptor_(descriptor) {}
  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  void shutdown() override { low_level_transport_->shutdown(); }

 protected:
  Descriptor descriptor_;
};

}  // namespace coslam
