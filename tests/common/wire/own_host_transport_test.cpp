// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/own_host_transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "common/wire/addresses.h"

namespace coslam::own_host_transport_test {
namespace {

struct Receiver : rtps::TransportReceiverInterface {
  void OnDataReceived(const rtps::octet*, std::uint32_t, const rtps::Locator&, const rtps::Locator&) override {
    ++datagrams;
  }
  int datagrams = 0;
};

rtps::Locator at(const std::string& address) {
  rtps::Locator locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  rtps::IPLocator::setIPv4(locator, address);
  return locator;
}

class OwnHost : public testing::Test {
 protected:
  OwnHost() {
    auto carrier = std::make_shared<rtps::UDPv4TransportDescriptor>();
    carrier->interfaceWhiteList = {"127.0.0.1"};
    descriptor_ = own_host_transport(carrier);
    transport_.reset(descriptor_->create_transport());
    transport_->init();
  }
  int heard_from(const std::string& address) const {
    Receiver receiver;
    dynamic_cast<rtps::ChainingTransport&>(*transport_).receive(&receiver, nullptr, 0, at("127.0.0.1"), at(address));
    return receiver.datagrams;
  }

  std::shared_ptr<rtps::TransportDescriptorInterface> descriptor_;
  std::unique_ptr<rtps::TransportInterface> transport_;
};

TEST_F(OwnHost, OtherHostsAreNotHeard) {
  EXPECT_EQ(heard_from("127.0.0.1"), 1);
  for (const std::string& address : local_addresses()) EXPECT_EQ(heard_from(address), 1) << address;
  EXPECT_EQ(heard_from("203.0.113.9"), 0);
}

TEST_F(OwnHost, ItsAddressesAreReachedOnTheLoopbackDevice) {
  for (const std::string& address : local_addresses()) {
    rtps::Locator near;
    ASSERT_TRUE(transport_->transform_remote_locator(at(address), near)) << address;
    EXPECT_EQ(rtps::IPLocator::toIPv4string(near), "127.0.0.1");
  }
}

}  // namespace
}  // namespace coslam::own_host_transport_test
