// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/guarded_transport.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/log.h"

namespace coslam {
namespace {

struct GuardedDescriptor : ChainedDescriptor {
  GuardedDescriptor(std::shared_ptr<rtps::TransportDescriptorInterface> carrier, const FleetKey& k, RejectionCounts& r)
      : ChainedDescriptor(std::move(carrier)), key(k), refused(r) {
    maxMessageSize -= static_cast<std::uint32_t>(kSealBytes);
  }

  rtps::TransportInterface* create_transport() const override;

  FleetKey key;
  RejectionCounts& refused;
};

class GuardedTransport : public ChainedTransport<GuardedDescriptor> {
 public:
  explicit GuardedTransport(const GuardedDescriptor& descriptor)
      : ChainedTransport(descriptor), sealer_(descriptor.key), opener_(descriptor.key) {}

  // A seal for each destination: who is reached in two ways would take the second datagram for a replay. Debian's build
  // writes statistics into the end of what it sends, just before it does: not into sealed ones, where the first octet
  // of its empty statistics is not at its place.
  bool forward(const Outgoing& datagram, rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end) override {
    thread_local std::vector<std::uint8_t> room, sealed;
    thread_local std::vector<rtps::Locator> destination;
    const std::span<const rtps::octet> octets = datagram.octets(room);
    bool sent = true;
    for (; *begin != *end; ++*begin) {
      destination.assign(1, **begin);
      rtps::Locators first(destination.cbegin()), last(destination.cend());
      sealer_.seal(octets, sealed);
      sent &= datagram.send(sealed, &first, &last);
    }
    return sent;
  }

  // On several threads of the middleware.
  void receive(rtps::TransportReceiverInterface* receiver, const rtps::octet* data, std::uint32_t size,
               const rtps::Locator& local, const rtps::Locator& remote) override {
    const Opened opened = opener_.open({data, size});
    if (!opened.refused) {
      receiver->OnDataReceived(opened.payload.data(), static_cast<std::uint32_t>(opened.payload.size()), local, remote);
      return;
    }
    descriptor_.refused.add(*opened.refused);
    if (*opened.refused == Rejection::kUnauthentic) complain({data, size}, remote);
  }

 private:
  void complain(std::span<const rtps::octet> datagram, const rtps::Locator& remote) {
    constexpr std::string_view kUnsealed = "RTPS";
    const bool unsealed = std::ranges::equal(datagram.first(std::min(datagram.size(), kUnsealed.size())), kUnsealed);
    {
      const std::lock_guard lock(complaints_mutex_);
      if (!(unsealed ? of_no_key_ : of_another_key_).pass()) return;
    }
    log_warn("datagrams " + std::string(unsealed ? "without a key" : "with another key than the fleet's") +
             " arrive, the last one from " + rtps::IPLocator::toIPv4string(remote) +
             "; refused so far: " + std::to_string(descriptor_.refused[Rejection::kUnauthentic]));
  }

  Sealer sealer_;
  Opener opener_;
  std::mutex complaints_mutex_;
  LogLimiter of_no_key_{std::chrono::minutes(1)}, of_another_key_{std::chrono::minutes(1)};
};

rtps::TransportInterface* GuardedDescriptor::create_transport() const { return new GuardedTransport(*this); }

}  // namespace

std::shared_ptr<rtps::TransportDescriptorInterface> guarded_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> carrier, const FleetKey& key, RejectionCounts& refused) {
  return std::make_shared<GuardedDescriptor>(std::move(carrier), key, refused);
}

}  // namespace coslam
