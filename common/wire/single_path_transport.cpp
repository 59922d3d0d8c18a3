// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/single_path_transport.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "common/wire/addresses.h"

namespace coslam {
namespace {

struct SinglePathDescriptor : ChainedDescriptor {
  SinglePathDescriptor(std::shared_ptr<rtps::TransportDescriptorInterface> carrier, PeerPaths& p,
                       std::vector<std::string> i, std::shared_ptr<EchoAnswerer> e)
      : ChainedDescriptor(std::move(carrier)), paths(p), interfaces(std::move(i)), echo(std::move(e)) {}

  rtps::TransportInterface* create_transport() const override;

  PeerPaths& paths;
  std::vector<std::string> interfaces;
  std::shared_ptr<EchoAnswerer> echo;
};

// This host's address by which it would write to that one; 0: none.
std::uint32_t source_towards(std::uint32_t address) {
  const int s = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (s < 0) return 0;
  sockaddr_in peer{}, local{};
  peer.sin_family = AF_INET;
  peer.sin_port = htons(9);
  peer.sin_addr.s_addr = htonl(address);
  socklen_t size = sizeof local;
  const bool found = connect(s, reinterpret_cast<const sockaddr*>(&peer), sizeof peer) == 0 &&
                     getsockname(s, reinterpret_cast<sockaddr*>(&local), &size) == 0;
  ::close(s);
  return found ? ntohl(local.sin_addr.s_addr) : 0;
}

// Of the sockets on this host's chosen interfaces, the one by which a peer is written to. The middleware opens them in
// the order in which the system lists the interfaces, and uses all. Thread-safe.
class Sockets {
 public:
  explicit Sockets(const std::vector<std::string>& interfaces) {
    for (const std::string& address : local_addresses()) {
      in_addr binary{};
      if (std::ranges::find(interfaces, address) != interfaces.end() &&
          inet_pton(AF_INET, address.c_str(), &binary) == 1)
        addresses_.push_back(ntohl(binary.s_addr));
    }
  }

  bool use(const rtps::SenderResource* socket, std::uint32_t destination) {
    if (addresses_.size() < 2) return true;
    const std::lock_guard lock(mutex_);
    auto at = std::ranges::find(sockets_, socket);
    if (at == sockets_.end()) at = sockets_.insert(at, socket);
    if (sockets_.size() != addresses_.size()) return true;  // not all are known yet, or they are not as expected
    const std::uint32_t source = route(destination);
    const bool known = std::ranges::find(addresses_, source) != addresses_.end();
    return !known || addresses_[static_cast<std::size_t>(at - sockets_.begin())] == source;
  }

 private:
  std::uint32_t route(std::uint32_t destination) {
    auto& [source, looked] = routes_[destination];
    const auto now = Clock::now();
    if (source == 0 || now - looked > std::chrono::seconds(1)) {
      source = source_towards(destination);
      looked = now;
    }
    return source;
  }

  std::mutex mutex_;
  std::vector<std::uint32_t> addresses_;
  std::vector<const rtps::SenderResource*> sockets_;
  std::map<std::uint32_t, std::pair<std::uint32_t, Clock::time_point>> routes_;
};

class SinglePathTransport : public ChainedTransport<SinglePathDescriptor> {
 public:
  explicit SinglePathTransport(const SinglePathDescriptor& descriptor)
      : ChainedTransport(descriptor), sockets_(descriptor.interfaces) {}

  bool forward(const Outgoing& datagram, rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end) override {
    thread_local std::vector<rtps::Locator> destinations;
    destinations.clear();
    const auto now = Clock::now();
    for (; *begin != *end; ++*begin) {
      const rtps::Locator& locator = **begin;
      const Ipv4Endpoint endpoint = ipv4_endpoint(locator);
      const bool group = rtps::IPLocator::isMulticast(locator);
      if (group || (descriptor_.paths.goes(endpoint, now) && sockets_.use(datagram.socket(), endpoint.address)))
        destinations.push_back(locator);
    }
    if (destinations.empty()) return true;
    rtps::Locators first(destinations.cbegin()), last(destinations.cend());
    return datagram.send(&first, &last);
  }

  // On several threads of the middleware. A message of RTPS names its sender after 8 octets.
  void receive(rtps::TransportReceiverInterface* receiver, const rtps::octet* data, std::uint32_t size,
               const rtps::Locator& local, const rtps::Locator& remote) override {
    if (descriptor_.echo->take({data, size}, ipv4_endpoint(remote))) return;
    constexpr std::size_t kSender = 8;
    ParticipantKey sender;
    if (size >= kSender + sender.size()) {
      std::copy_n(data + kSender, sender.size(), sender.begin());
      descriptor_.paths.heard(sender, ipv4_endpoint(remote).address, Clock::now());
    }
    receiver->OnDataReceived(data, size, local, remote);
  }

 private:
  Sockets sockets_;
};

rtps::TransportInterface* SinglePathDescriptor::create_transport() const { return new SinglePathTransport(*this); }

}  // namespace

Ipv4Endpoint ipv4_endpoint(const rtps::Locator& locator) {
  const rtps::octet* a = rtps::IPLocator::getIPv4(locator);
  return {std::uint32_t{a[0]} << 24 | std::uint32_t{a[1]} << 16 | std::uint32_t{a[2]} << 8 | a[3],
          rtps::IPLocator::getPhysicalPort(locator)};
}

std::shared_ptr<rtps::TransportDescriptorInterface> single_path_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> carrier, PeerPaths& paths,
    const std::vector<std::string>& interfaces, std::shared_ptr<EchoAnswerer> echo) {
  return std::make_shared<SinglePathDescriptor>(std::move(carrier), paths, interfaces, std::move(echo));
}

}  // namespace coslam
