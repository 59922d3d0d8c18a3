// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A foreign program in the domain that writes nonsense under our topic and type names.
#include "common/wire/middleware.h"  // first: other orders are ambiguous in C++20

#include <gtest/gtest.h>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <random>
#include <thread>

#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/qos.h"
#include "tests/support/eventually.h"
#include "tests/support/test_domain.h"
#include "tests/support/wire_values.h"

namespace coslam::stranger_test {
namespace {

using Octets = std::vector<std::uint8_t>;

// Says that it is the type of the tracks and writes any octets.
class Forger : public SampleType {
 public:
  Forger() : SampleType("coslam::idl::TrackFrame", 70000, true) {}

 private:
  std::uint32_t bytes_of(const void* sample) const override {
    return static_cast<std::uint32_t>(static_cast<const Octets*>(sample)->size());
  }
  bool write(const void* sample, rtps::SerializedPayload_t& payload) const override {
    const auto& octets = *static_cast<const Octets*>(sample);
    std::ranges::copy(octets, payload.data);
    payload.length = static_cast<std::uint32_t>(octets.size());
    return true;
  }
  bool read(const rtps::SerializedPayload_t&, void*) const override { return false; }
  bool get_key(dds::InstanceHandle_t& key) const override {
    key.value[0] = 1;
    return true;
  }
  void* make_sample() const override { return new Octets; }
  void delete_sample(void* sample) const override { delete static_cast<Octets*>(sample); }
};

TEST(Stranger, NonsenseIsSkippedAndTheRestGoesOn) {
  const test::TestDomain domain;
  const WireConfig config = loopback_config(domain.number());
  Participant server(config, "test");
  test::Collector<idl::TrackFrame> received;
  Loop loop(server, "server", std::chrono::milliseconds(50), [] {});
  loop.read<idl::TrackFrame>([&](const idl::TrackFrame& m, const Sample&) { received.add(m); });
  loop.start();

  RejectionCounts refused;
  PeerPaths paths;
  auto* factory = dds::DomainParticipantFactory::get_instance();
  auto* stranger = factory->create_participant(static_cast<std::uint32_t>(domain.number()),
                                               participant_qos(config, "stranger", refused, paths));
  const dds::TypeSupport type(new Forger());
  type.register_type(stranger);
  dds::Topic* topic =
      stranger->create_topic(topic_of<idl::TrackFrame>().name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  auto* writer = stranger->create_publisher(dds::PUBLISHER_QOS_DEFAULT)
                     ->create_datawriter(topic, writer_qos(topic_of<idl::TrackFrame>(), config));

  // Nonsense from the stranger, until a good frame has come through beside it.
  const idl::TrackFrame good = encode(test::WireValues(1).frame("cam0", RunId(1), 5), pixel_scale(test::vga_camera()));
  Writer<idl::TrackFrame> honest(server);
  std::mt19937 random(1);
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  std::size_t forged = 0;
  while (std::chrono::steady_clock::now() < end && (forged < 300 || received.values().empty())) {
    Octets octets(4 + random() % 3000);
    for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
    octets[0] = octets[2] = octets[3] = 0;  // a valid encapsulation header
    octets[1] = 1;
    write_sample(*writer, &octets);
    honest.write(good);
    dds::PublicationMatchedStatus matched;
    writer->get_publication_matched_status(matched);
    if (matched.current_count > 0) ++forged;
    std::this_thread::yield();
  }
  EXPECT_GE(forged, 300u);
  EXPECT_GE(server.rejections()[Rejection::kMalformed], 1u);
  const auto frames = received.values();
  EXPECT_TRUE(std::ranges::find(frames, good) != frames.end());

  stranger->delete_contained_entities();
  factory->delete_participant(stranger);
}

}  // namespace
}  // namespace coslam::stranger_test
