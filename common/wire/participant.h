// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/wire/counters.h"
#include "common/wire/messages.h"
#include "common/wire/wire_config.h"

namespace coslam {

// Traffic of one topic in this process, see link_bytes().
struct TopicCounts {
  std::uint64_t sent = 0, sent_bytes = 0;
  std::uint64_t received = 0, received_bytes = 0;
};

// Bytes that a sample costs on the network: its serialized form and the headers of the datagrams that carry it, with
// the seals where there is a key.
std::uint64_t link_bytes(std::size_t sample_bytes, int max_message_bytes, bool with_key = false);

// Variables of the environment that steer the middleware, for the ROS 2 nodes beside; participants here ignore them.
constexpr std::array<const char*, 7> kIgnoredVariables = {"ROS_DISCOVERY_SERVER",
                                                          "ROS_SUPER_CLIENT",
                                                          "FASTDDS_ENVIRONMENT_FILE",
                                                          "FASTDDS_BUILTIN_TRANSPORTS",
                                                          "FASTDDS_DEFAULT_PROFILES_FILE",
                                                          "FASTRTPS_DEFAULT_PROFILES_FILE",
                                                          "FASTDDS_STATISTICS"};

const char* middleware_version();

// Topic that a writer of another participant offers.
struct OfferedTopic {
  std::string name, type;  // DDS names
  bool reliable = false;
  friend auto operator<=>(const OfferedTopic&, const OfferedTopic&) = default;
};

// The presence of this process in a DDS domain. Lives longer than the writers and loops made from it. Thread-safe.
class Participant {
 public:
  // `name` is what other participants and operators' tools see. Throws UserError, in one sentence: domain out of
  // range, no such interface, certificates missing or refused, key file missing or not fit, no port. Without
  // certificates and key, on more than the loopback device, one warning is logged. `rejections`: where it goes on
  // counting for one that was there before.
  Participant(const WireConfig& config, const std::string& name,
              std::shared_ptr<RejectionCounts> rejections = std::make_shared<RejectionCounts>());
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  const WireConfig& config() const;
  std::array<TopicCounts, kTopicCount> counts() const;
  // Names of the other participants that are known now. One is known before anything it says can be heard.
  std::vector<std::string> others() const;
  // Addresses that the other participants announce for themselves.
  std::vector<std::string> addresses_of_others() const;
  // Topics that the writers of others offer now, whether they are read here or not; sorted, without duplicates.
  std::vector<OfferedTopic> offered() const;
  // Samples that could not be decoded and datagrams without the key are counted here; links add what they turn down
  // later.
  RejectionCounts& rejections() const;
  // Nobody hears it any more: its writers do not wait for their readers when they end.
  void give_up();

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

// Sends on one topic of kTopics, with its QoS; Writer below says what. Thread-safe.
class TopicWriter {
 public:
  TopicWriter(Participant& participant, std::size_t topic, const std::string& partition, Repeat repeat);
  // Topics that keep the newest sample for late joiners: waits up to two seconds until the readers here have it, unless
  // the participant was given up.
  ~TopicWriter();
  TopicWriter(const TopicWriter&) = delete;
  TopicWriter& operator=(const TopicWriter&) = delete;

  // message: of the topic's type.
  std::uint64_t write(const void* message, std::size_t sample_bytes);
  void assert_alive();
  void forget();
  int readers() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Sends one type of message, on its topic. `partition`, when given, is seen by readers of the same partition only.
template <class Message>
class Writer {
 public:
  explicit Writer(Participant& participant, const std::string& partition = {}, Repeat repeat = Repeat::kUsual)
      : writer_(participant, topic_index<Message>(), partition, repeat) {}

  // Hands the message to the middleware and returns the bytes it costs; 0 when it could not take it.
  std::uint64_t write(const Message& message) { return writer_.write(&message, sample_bytes(message)); }
  void assert_alive() { writer_.assert_alive(); }    // a sign of life, for topics that have one
  void forget() { writer_.forget(); }                // drops written samples: they are not sent again, or not at all
  int readers() const { return writer_.readers(); }  // matched now

 private:
  TopicWriter writer_;
};

}  // namespace coslam
