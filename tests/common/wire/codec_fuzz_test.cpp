// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Octets from a stranger: whatever arrives is decoded to a usable value or rejected, never a crash. Deterministic; the
// sanitizer builds are where it bites.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <type_traits>

#include "common/wire/codec.h"
#include "tests/common/wire/cdr_octets.h"
#include "tests/common/wire/every_message.h"
#include "tests/support/moving_tracks.h"
#include "tests/support/wire_values.h"

namespace coslam::codec_fuzz_test {
namespace {

using test::deserialize;
using test::Octets;
using test::serialize;

// True when the octets made a value that encodes and decodes again.
template <class Message, class Encode, class Decode>
bool survives(Octets octets, const Encode& encode_again, const Decode& decode_it) {
  const auto message = deserialize<Message>(std::move(octets));
  if (!message) return false;
  auto value = decode_it(*message);
  if (!value) return false;
  EXPECT_TRUE(decode_it(encode_again(*value))) << "what passed once passes again";
  return true;
}

const auto by_itself = [](const auto& message) { return decode(message); };

template <class Message, class Encode, class Decode = decltype(by_itself)>
void fuzz(const Message& good, const Encode& encode_again, const Decode& decode_it = by_itself) {
  std::mt19937 random(12345);
  const Octets original = serialize(good);
  ASSERT_TRUE(survives<Message>(original, encode_again, decode_it));
  for (int i = 0; i < 3000; ++i) {  // a few octets changed
    Octets octets = original;
    for (int flips = 1 + i % 4; flips > 0; --flips)
      octets[random() % octets.size()] = static_cast<std::uint8_t>(random());
    survives<Message>(octets, encode_again, decode_it);
  }
  for (std::size_t length = 0; length < std::min<std::size_t>(original.size(), 600); ++length) {  // cut short
    survives<Message>(Octets(original.begin(), original.begin() + static_cast<long>(length)), encode_again, decode_it);
  }
  for (int i = 0; i < 2000; ++i) {  // noise
    Octets octets(random() % 2048);
    for (std::uint8_t& c : octets) c = static_cast<std::uint8_t>(random());
    survives<Message>(octets, encode_again, decode_it);
  }
}

const double kScale = pixel_scale(test::vga_camera());
const auto again = [](const auto& value) {
  if constexpr (std::is_same_v<std::decay_t<decltype(value)>, TrackFrame>) {
    return encode(value, std::exp2(-1));  // whatever grid it is on
  } else {
    return encode(value);
  }
};

template <class Type>
class CodecFuzz : public testing::Test {};
TYPED_TEST_SUITE(CodecFuzz, test::MessageTypes, test::MessageName);

TYPED_TEST(CodecFuzz, IsUsableOrRejected) {
  fuzz(test::encoded(test::WireValues(1).sample<typename TypeParam::Value>()), again);
}

TEST(FrameFuzz, IsUsableOrRejectedWithAReference) {
  test::MovingTracks moving(test::vga_camera(), 10, 40);
  const TrackFrame before = moving.next(), now = moving.next();
  const CodedTracks tracks = coded_tracks(before, kScale);
  const TrackReference reference{before.frame, &tracks};
  const auto decode_it = [&](const idl::TrackFrame& message) {
    auto frame = decode(message, reference);
    EXPECT_TRUE(!frame || frame->tracks.size() <= idl::MAX_TRACKS);
    return frame;
  };
  const auto encode_it = [&](const TrackFrame& frame) {
    return frame.frame > before.frame && frame.frame.value < 60000 ? encode(frame, std::exp2(-1), reference)
                                                                   : encode(frame, std::exp2(-1));
  };
  const idl::TrackFrame good = encode(now, kScale, reference);
  fuzz(good, encode_it, decode_it);
  // Bits of the tracks alone, where all of a message but them is good.
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    idl::TrackFrame message = good;
    for (int flips = 1 + i % 3; flips > 0; --flips)
      message.tracks()[random() % message.tracks().size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    if (i % 5 == 0) message.track_count(static_cast<std::uint16_t>(random() % 2049));
    auto frame = decode_it(message);
    EXPECT_TRUE(!frame || frame->tracks.size() == message.track_count());
  }
}

}  // namespace
}  // namespace coslam::codec_fuzz_test
