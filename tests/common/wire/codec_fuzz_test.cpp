// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Octets from a stranger: whatever arrives is decoded to a usable value or rejected, never a crash. Deterministic; the
// sanitizer builds are where it bites.
#include <fastcdr/Cdr.h>
#include <gtest/gtest.h>

#include <random>

#include "common/wire/codec.h"
#include "tests/support/wire_values.h"

namespace coslam {
namespace {

using Octets = std::vector<char>;

template <class Message>
Octets serialize(const Message& message) {
  Octets octets(sample_bytes(message));
  eprosima::fastcdr::FastBuffer buffer(octets.data(), octets.size());
  eprosima::fastcdr::Cdr cdr(buffer);
  message.serialize(cdr);
  octets.resize(cdr.getSerializedDataLength());
  return octets;
}

// True when the octets made a value that encodes and decodes again.
template <class Message, class Encode>
bool survives(Octets octets, const Encode& encode_again) {
  Message message;
  try {
    eprosima::fastcdr::FastBuffer buffer(octets.data(), octets.size());
    eprosima::fastcdr::Cdr cdr(buffer);
    message.deserialize(cdr);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return false;
  }
  auto value = decode(message);
  if (!value) return false;
  EXPECT_TRUE(decode(encode_again(*value))) << "what passed once passes again";
  return true;
}

template <class Message, class Encode>
void fuzz(const Message& good, const Encode& encode_again) {
  std::mt19937 random(12345);
  const Octets original = serialize(good);
  ASSERT_TRUE(survives<Message>(original, encode_again));
  for (int i = 0; i < 3000; ++i) {  // a few octets changed
    Octets octets = original;
    for (int flips = 1 + i % 4; flips > 0; --flips) octets[random() % octets.size()] = static_cast<char>(random());
    survives<Message>(octets, encode_again);
  }
  for (std::size_t length = 0; length < std::min<std::size_t>(original.size(), 600); ++length) {  // cut short
    survives<Message>(Octets(original.begin(), original.begin() + static_cast<long>(length)), encode_again);
  }
  for (int i = 0; i < 2000; ++i) {  // noise
    Octets octets(random() % 2048);
    for (char& c : octets) c = static_cast<char>(random());
    survives<Message>(octets, encode_again);
  }
}

const double kScale = pixel_scale(test::vga_camera());
const auto plain = [](const auto& value) { return encode(value); };
const auto scaled = [](const auto& value) { return encode(value, std::exp2(-1)); };

TEST(CodecFuzz, TrackFrame) { fuzz(encode(test::WireValues(1).frame("cam0", RunId(1), 5, 40), kScale), scaled); }
TEST(CodecFuzz, PatchReply) {
  test::WireValues values(2);
  fuzz(encode(values.patches(values.frame("cam0", RunId(1), 5, 0), 3)), plain);
}
TEST(CodecFuzz, DescriptorReply) {
  test::WireValues values(3);
  fuzz(encode(values.descriptors(values.frame("cam0", RunId(1), 5, 0), 3)), plain);
}
TEST(CodecFuzz, MovingState) { fuzz(encode(test::WireValues(7).moving_state()), plain); }
TEST(CodecFuzz, Hello) { fuzz(encode(test::WireValues(4).hello("cam0", RunId(1))), plain); }
TEST(CodecFuzz, AgentStatus) {
  fuzz(encode(test::WireValues(5).agent_status("cam0", RunId(1), AgentState::kFinished)), plain);
}
TEST(CodecFuzz, MapPatch) {
  MapPatch patch = test::WireValues(6).map_patch("cam0", RunId(1), 5, 10);
  patch.placed = PlacedPose{};
  patch.new_from_old.scale = 2;
  fuzz(encode(patch), plain);
}
TEST(CodecFuzz, ServerStatus) {
  ServerStatus status = test::WireValues(7).server_status(RunId(1));
  status.refused = {{RunId(2), "no"}};
  fuzz(encode(status), plain);
}

}  // namespace
}  // namespace coslam
