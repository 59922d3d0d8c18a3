// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/own_host_transport.h"

#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/wire/addresses.h"

namespace coslam {
namespace {

struct OwnHostDescriptor : ChainedDescriptor {
  using ChainedDescriptor::ChainedDescriptor;
  rtps::TransportInterface* create_transport() const override;
};

// The addresses of this machine. Thread-safe.
class OwnAddresses {
 public:
  bool has(const rtps::Locator& locator) const {
    constexpr rtps::octet kLoopback = 127;
    if (rtps::IPLocator::getIPv4(locator)[0] == kLoopback) return true;
    const std::string address = rtps::IPLocator::toIPv4string(locator);
    const std::lock_guard lock(mutex_);
    if (known_.contains(address)) return true;
    const auto now = Clock::now();
    if (now - looked_ < std::chrono::seconds(1)) return false;
    looked_ = now;
    const std::vector<std::string> all = local_addresses();
    known_ = {all.begin(), all.end()};
    return known_.contains(address);
  }

 private:
  mutable std::mutex mutex_;
  mutable std::set<std::string> known_;
  mutable Clock::time_point looked_{};
};

class OwnHostTransport : public ChainedTransport<OwnHostDescriptor> {
 public:
  explicit OwnHostTransport(const OwnHostDescriptor& descriptor) : ChainedTransport(descriptor) {}

  bool forward(const Outgoing& datagram, rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end) override {
    return datagram.send(begin, end);
  }
  // On several threads of the middleware.
  void receive(rtps::TransportReceiverInterface* receiver, const rtps::octet* data, std::uint32_t size,
               const rtps::Locator& local, const rtps::Locator& remote) override {
    if (own_addresses_.has(remote)) receiver->OnDataReceived(data, size, local, remote);
  }

 private:
  rtps::Locator reached_at(const rtps::Locator& announced) const override {
    rtps::Locator near = announced;
    if (own_addresses_.has(announced)) rtps::IPLocator::setIPv4(near, "127.0.0.1");
    return near;
  }

  OwnAddresses own_addresses_;
};

rtps::TransportInterface* OwnHostDescriptor::create_transport() const { return new OwnHostTransport(*this); }

}  // namespace

std::shared_ptr<rtps::TransportDescriptorInterface> own_host_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> carrier) {
  return std::make_shared<OwnHostDescriptor>(std::move(carrier));
}

}  // namespace coslam
