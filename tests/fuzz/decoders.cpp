// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A sample of any topic, as octets: the first says which topic. It is decoded to a usable value or rejected.
#include <cstdlib>
#include <span>
#include <string>

#include "common/wire/announcement.h"
#include "common/wire/codec.h"
#include "common/wire/echo.h"
#include "common/wire/guard.h"
#include "common/wire/track_codec.h"
#include "tests/common/wire/announcement_octets.h"
#include "tests/common/wire/cdr_octets.h"
#include "tests/common/wire/encoded.h"
#include "tests/fuzz/fuzzer.h"
#include "tests/support/moving_tracks.h"
#include "tests/support/wire_values.h"

namespace coslam {
namespace {

using test::deserialize;
using test::serialize;
using Sample = test::Octets;

void require(bool holds) {
  if (!holds) std::abort();
}

template <class Message>
void decode_octets(const Sample& octets) {
  const auto message = deserialize<Message>(octets);
  if (!message) return;
  if constexpr (std::is_same_v<Message, idl::TrackFrame>) {
    // As the server does: against frames that it has heard before.
    static const auto before = [] {
      test::MovingTracks moving(test::vga_camera(), 10, 40);
      return moving.next();
    }();
    static const CodedTracks tracks = coded_tracks(before, pixel_scale(test::vga_camera()));
    auto frame = decode(*message, {before.frame, &tracks});
    require(!frame || frame->tracks.size() <= idl::MAX_TRACKS);
    if (auto alone = decode(*message)) require(static_cast<bool>(decode(encode(*alone, std::exp2(-1)))));
  } else if (auto value = decode(*message)) {
    require(static_cast<bool>(decode(encode(*value))));  // what passed once passes again
  }
}

// The numbers behind the topics: a sealed datagram, and one that the doctor reads.
constexpr std::size_t kSealed = kTopicCount, kHeard = kTopicCount + 1;

std::span<const std::uint8_t> bytes_of(const Sample& octets) {
  return {reinterpret_cast<const std::uint8_t*>(octets.data()), octets.size()};
}

void open_sealed(const Sample& octets) {
  static Opener opener(fleet_key("a secret of sixteen", 7));
  const Opened opened = opener.open(bytes_of(octets));
  require(opened.refused.has_value());  // nobody guesses a seal
}

void hear(const Sample& octets) {
  const auto announcement = read_announcement(bytes_of(octets));
  require(!announcement || announcement->name.size() <= 64);
  (void)decode_echo_request(bytes_of(octets));
  if (const auto answer = decode_echo_answer(bytes_of(octets))) require(answer->name.size() < kEchoBytes);
}

void decode_any(std::size_t which, const Sample& octets) {
  std::size_t topic = 0;
  for_each_message_type([&]<class M, class S, class V>(const MessageType<M, S, V>&) {
    if (topic++ == which) decode_octets<M>(octets);
  });
  if (which == kSealed) open_sealed(octets);
  if (which == kHeard) hear(octets);
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  if (octets.empty()) return;
  decode_any(octets[0] % (kTopicCount + 2), {octets.begin() + 1, octets.end()});
}

void fuzz::write_seeds(const WriteSeed& write_seed) {
  test::WireValues values(1);
  const auto write = [&](std::size_t topic, const Sample& octets) {
    write_seed("topic" + std::to_string(topic), static_cast<char>(topic) + std::string(octets.begin(), octets.end()));
  };
  for_each_message_type([&]<class M, class S, class V>(const MessageType<M, S, V>&) {
    write(topic_index<M>(), serialize(test::encoded(values.sample<V>())));
  });
  write(kSealed, Sample(64, 'x'));
  const auto announcement = test::announcement();
  write(kHeard, Sample(announcement.begin(), announcement.end()));
}

}  // namespace coslam
