// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/single_path_transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace coslam::single_path_transport_test {
namespace {

constexpr std::uint16_t kPort = 7411;
const ParticipantKey kOwn{1}, kPeer{9};

rtps::Locator at(const std::string& address, std::uint16_t port = kPort) {
  rtps::Locator locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  rtps::IPLocator::setIPv4(locator, address);
  rtps::IPLocator::setPhysicalPort(locator, port);
  return locator;
}

struct Receiver : rtps::TransportReceiverInterface {
  void OnDataReceived(const rtps::octet*, std::uint32_t, const rtps::Locator&, const rtps::Locator&) override {
    ++datagrams;
  }
  int datagrams = 0;
};

class SinglePath : public testing::Test {
 protected:
  SinglePath() {
    paths_.set_own(kOwn);
    paths_.set_peer(kPeer, {ipv4_endpoint(at("192.0.2.1")), ipv4_endpoint(at("198.51.100.1"))});
    auto carrier = std::make_shared<rtps::UDPv4TransportDescriptor>();
    carrier->interfaceWhiteList = {"127.0.0.1"};
    descriptor_ =
        single_path_transport(carrier, paths_, {"127.0.0.1"}, std::make_shared<EchoAnswerer>("one", std::nullopt));
    transport_.reset(descriptor_->create_transport());
    transport_->init();
  }

  rtps::ChainingTransport& chain() { return dynamic_cast<rtps::ChainingTransport&>(*transport_); }

  // Addresses to which one datagram for all these goes.
  std::vector<std::string> sent_to(const std::vector<rtps::Locator>& destinations) {
    socket_.destinations.clear();
    EXPECT_TRUE(send_by(chain(), socket_, std::array<rtps::octet, 4>{}, destinations));
    std::vector<std::string> addresses;
    for (const rtps::Locator& to : socket_.destinations) addresses.push_back(rtps::IPLocator::toIPv4string(to));
    return addresses;
  }

  // Datagrams that are passed on.
  int hear(const std::vector<rtps::octet>& data, const std::string& from) {
    Receiver receiver;
    chain().receive(&receiver, data.data(), static_cast<std::uint32_t>(data.size()), at("127.0.0.1"), at(from));
    return receiver.datagrams;
  }

  // A message of RTPS names its sender after eight octets.
  static std::vector<rtps::octet> message_of(const ParticipantKey& sender) {
    std::vector<rtps::octet> out{'R', 'T', 'P', 'S', 2, 3, 1, 15};
    out.insert(out.end(), sender.begin(), sender.end());
    return out;
  }

  PeerPaths paths_;
  std::shared_ptr<rtps::TransportDescriptorInterface> descriptor_;
  std::unique_ptr<rtps::TransportInterface> transport_;
  NotedSocket socket_;
};

TEST_F(SinglePath, APeerThatWasHeardOnOneWayIsWrittenToOnThatAlone) {
  const std::vector<rtps::Locator> both{at("192.0.2.1"), at("198.51.100.1")};
  EXPECT_EQ(sent_to(both).size(), 2U) << "nobody was heard yet";
  EXPECT_EQ(hear(message_of(kPeer), "198.51.100.1"), 1);
  EXPECT_EQ(sent_to(both), std::vector<std::string>{"198.51.100.1"});
}

TEST_F(SinglePath, GroupsAndUnknownAddressesAreAlwaysWrittenTo) {
  hear(message_of(kPeer), "198.51.100.1");
  const auto sent = sent_to({at("239.255.0.1"), at("203.0.113.7"), at("192.0.2.1")});
  EXPECT_EQ(sent, (std::vector<std::string>{"239.255.0.1", "203.0.113.7"}));
}

TEST_F(SinglePath, WhereNoAddressIsLeftNothingIsSentAndThatIsNoFailure) {
  hear(message_of(kPeer), "198.51.100.1");
  EXPECT_TRUE(sent_to({at("192.0.2.1")}).empty());
  EXPECT_EQ(socket_.calls, 0);
}

TEST_F(SinglePath, ADatagramTooShortForASenderIsPassedOn) {
  EXPECT_EQ(hear({}, "192.0.2.1"), 1);
  std::vector<rtps::octet> brief = message_of(kPeer);
  brief.pop_back();
  EXPECT_EQ(hear(brief, "192.0.2.1"), 1);
  EXPECT_EQ(sent_to({at("192.0.2.1"), at("198.51.100.1")}).size(), 2U) << "its sender is not known";
}

TEST_F(SinglePath, QuestionsOfTheDoctorDoNotReachTheMiddleware) {
  const EchoOctets question = encode(EchoRequest{5, 0});
  EXPECT_EQ(hear({question.begin(), question.end()}, "127.0.0.1"), 0);
}

TEST_F(SinglePath, AnEndpointHasTheOctetsOfItsAddressInOrder) {
  const Ipv4Endpoint endpoint = ipv4_endpoint(at("192.0.2.1", 7415));
  EXPECT_EQ(endpoint.address, 0xc0000201U);
  EXPECT_EQ(endpoint.port, 7415);
}

}  // namespace
}  // namespace coslam::single_path_transport_test
