// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/octet_inbox.h"

#include "common/wire/middleware.h"  // first: other orders are ambiguous in C++20

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <memory>
#include <thread>
#include <vector>

#include "common/wire/ros_domain.h"
#include "tests/support/eventually.h"
#include "tests/support/test_domain.h"

namespace coslam::octet_inbox_test {
namespace {

using namespace std::chrono_literals;
using Octets = std::vector<std::uint8_t>;
using testing::IsEmpty;

const OctetTopic kImages{"rt/image", "sensor_msgs::msg::dds_::Image_", true, false, 4};

// Until it holds; what others do takes its time.
template <class Condition>
bool eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(5ms);  // a pace, nothing waits for it
  }
  return true;
}

// The next sample; empty when none comes.
Octets taken(OctetInbox& inbox) {
  Octets out;
  const auto copy = [&](std::span<const std::uint8_t> octets) { out.assign(octets.begin(), octets.end()); };
  eventually([&] {
    if (inbox.take(copy)) return true;
    inbox.wait(50ms);
    return false;
  });
  return out;
}

Octets counting(std::size_t size, int from) {
  Octets octets(size);
  for (std::size_t i = 0; i < size; ++i)
    octets[i] = static_cast<std::uint8_t>(i * 7 + i / 256 + static_cast<unsigned>(from));
  return octets;
}

class Inbox : public testing::Test {
 protected:
  const test::TestDomain domain_;
};

TEST_F(Inbox, SamplesComeAsTheyWereWritten) {
  Participant nodes(ros_wire(domain_.number()), "nodes"), here(ros_wire(domain_.number()), "here");
  OctetWriter writer(nodes, kImages);
  OctetInbox inbox(here, kImages);
  EXPECT_FALSE(inbox.take([](std::span<const std::uint8_t>) { FAIL() << "there is none"; }));
  ASSERT_TRUE(eventually([&] { return writer.readers() == 1 && inbox.writers() == 1; }));
  for (const std::size_t size : {8U, 1000U, 70'000U, 6'220'852U}) {
    const Octets sent = counting(size, 3);
    ASSERT_TRUE(writer.write(sent));
    EXPECT_TRUE(taken(inbox) == sent) << size;
  }
  EXPECT_EQ(inbox.missed(), 0U);
  EXPECT_EQ(inbox.unmatched_qos(), "");
}

TEST_F(Inbox, TheNewestAreKept) {
  Participant nodes(ros_wire(domain_.number()), "nodes"), here(ros_wire(domain_.number()), "here");
  OctetTopic deep = kImages;
  deep.depth = 100;
  OctetWriter writer(nodes, deep);
  OctetInbox inbox(here, kImages), other(here, deep);
  ASSERT_TRUE(eventually([&] { return writer.readers() == 2; }));
  ASSERT_TRUE(writer.write(counting(8, 0)));
  ASSERT_EQ(taken(inbox), counting(8, 0));
  for (int i = 1; i < 20; ++i) ASSERT_TRUE(writer.write(counting(8, i)));
  for (int i = 0; i < 20; ++i) ASSERT_EQ(taken(other), counting(8, i));
  // All are there, and `inbox` has had them in the same order.
  ASSERT_TRUE(writer.write(counting(8, 20)));
  ASSERT_EQ(taken(other), counting(8, 20));
  Octets last;
  int count = 0;
  while (last != counting(8, 20)) {
    last = taken(inbox);
    ASSERT_LE(++count, kImages.depth);
  }
  EXPECT_EQ(inbox.missed(), 20U - static_cast<unsigned>(count));
  EXPECT_EQ(other.missed(), 0U);
}

TEST_F(Inbox, WritersAreSeenWithWhatTheyOffer) {
  Participant here(ros_wire(domain_.number()), "here");
  EXPECT_THAT(here.offered(), IsEmpty());
  const OfferedTopic reliable{kImages.name, kImages.type, true}, loose{"rt/loose", "a::T_", false};
  auto nodes = std::make_unique<Participant>(ros_wire(domain_.number()), "nodes");
  auto writer = std::make_unique<OctetWriter>(*nodes, kImages);
  const OctetTopic best_effort{loose.name, loose.type, false, false, 1};
  auto second = std::make_unique<OctetWriter>(*nodes, best_effort),
       third = std::make_unique<OctetWriter>(*nodes, best_effort);
  ASSERT_TRUE(eventually([&] { return here.offered() == std::vector{reliable, loose}; }));
  writer = nullptr;
  ASSERT_TRUE(eventually([&] { return here.offered() == std::vector{loose}; }));
  second = nullptr;
  third = nullptr;
  nodes = nullptr;
  ASSERT_TRUE(eventually([&] { return here.offered().empty(); }));
}

TEST_F(Inbox, AWriterThatOffersLessIsNamedByItsQos) {
  Participant nodes(ros_wire(domain_.number()), "nodes"), here(ros_wire(domain_.number()), "here");
  OctetTopic best_effort = kImages;
  best_effort.reliable = false;
  const OctetWriter writer(nodes, best_effort);
  const OctetInbox inbox(here, kImages);
  ASSERT_TRUE(eventually([&] { return inbox.unmatched_qos() == "reliability"; }));
  EXPECT_EQ(inbox.writers(), 0);
}

// A node as the middleware's own defaults make it: all devices, shared memory, datagrams as large as they can be.
class DefaultNode {
 public:
  explicit DefaultNode(int domain) {
    auto* factory = dds::DomainParticipantFactory::get_instance();
    participant_ = factory->create_participant(static_cast<dds::DomainId_t>(domain), dds::PARTICIPANT_QOS_DEFAULT);
    const dds::TypeSupport type(new Type);
    type.register_type(participant_);
    topic_ = participant_->create_topic(kImages.name, kImages.type, dds::TOPIC_QOS_DEFAULT);
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    dds::DataWriterQos qos;
    qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    writer_ = publisher_->create_datawriter(topic_, qos);
  }
  ~DefaultNode() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  DefaultNode(const DefaultNode&) = delete;
  DefaultNode& operator=(const DefaultNode&) = delete;

  bool write(Octets octets) { return write_sample(*writer_, &octets); }

 private:
  struct Type : SampleType {
    Type() : SampleType(kImages.type, 16) {}
    std::uint32_t bytes_of(const void* sample) const override {
      return static_cast<std::uint32_t>(static_cast<const Octets*>(sample)->size());
    }
    bool write(const void* sample, rtps::SerializedPayload_t& payload) const override {
      const auto& octets = *static_cast<const Octets*>(sample);
      std::memcpy(payload.data, octets.data(), octets.size());
      payload.length = static_cast<std::uint32_t>(octets.size());
      payload.encapsulation = CDR_LE;
      return true;
    }
    bool read(const rtps::SerializedPayload_t&, void*) const override { return false; }
    void* make_sample() const override { return new Octets; }
    void delete_sample(void* sample) const override { delete static_cast<Octets*>(sample); }
  };
  dds::DomainParticipant* participant_ = nullptr;
  dds::Topic* topic_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::DataWriter* writer_ = nullptr;
};

TEST_F(Inbox, ANodeWithTheMiddlewaresDefaultsIsHeard) {
  Participant here(ros_wire(domain_.number()), "here");
  OctetInbox inbox(here, kImages);
  DefaultNode node(domain_.number());
  ASSERT_TRUE(eventually([&] { return inbox.writers() == 1; }));
  const Octets sent = counting(2'000'000, 5);
  Octets heard;
  ASSERT_TRUE(eventually([&] {  // the node may not have found this reader yet
    node.write(sent);
    inbox.wait(200ms);
    return inbox.take([&](std::span<const std::uint8_t> octets) { heard.assign(octets.begin(), octets.end()); });
  }));
  EXPECT_TRUE(heard == sent);
}

}  // namespace
}  // namespace coslam::octet_inbox_test
