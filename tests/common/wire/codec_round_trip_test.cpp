// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "common/wire/codec.h"
#include "tests/common/wire/every_message.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

namespace coslam::codec_round_trip_test {
namespace {

using test::expect_same;
using test::WireValues;

const double kScale = pixel_scale(test::vga_camera());

template <class T>
void expect_unharmed(const T& value) {
  auto decoded = decode(encode(value));
  ASSERT_TRUE(decoded) << name_of(decoded.rejection());
  expect_same(*decoded, value);
}

template <class T>
void expect_unharmed_px(const T& value, double scale = kScale) {
  auto decoded = decode(encode(value, scale));
  ASSERT_TRUE(decoded) << name_of(decoded.rejection());
  expect_same(*decoded, value);
}

template <class Type>
class MessageRoundTrip : public testing::Test {};
TYPED_TEST_SUITE(MessageRoundTrip, test::MessageTypes, test::MessageName);

TYPED_TEST(MessageRoundTrip, ChangesNoBit) {
  const auto value = WireValues(17).sample<typename TypeParam::Value>();
  auto decoded = decode(test::encoded(value));
  ASSERT_TRUE(decoded) << name_of(decoded.rejection());
  expect_same(*decoded, value);
}

TEST(CodecRoundTrip, TrackFrames) {
  WireValues values(1);
  for (std::uint32_t i = 0; i < 50; ++i) {
    TrackFrame frame = values.frame("cam-0.left_1", RunId(~0ULL - i), i, static_cast<int>(40 * i));
    frame.pose_state = static_cast<PoseState>(i % 3);
    frame.wants_snapshot = i % 2 == 0;
    frame.descriptors_sent = static_cast<DescriptorsSent>(i % 3);
    frame.on_own_points = i % 2 == 0;
    frame.narrow_link = i % 2 == 1;
    frame.images_doubted = i % 3 == 1;
    frame.clock_set_ns = (TimeNs{i} - 25) * 100'000'000'000'000'000;
    frame.patches_sent = static_cast<std::uint16_t>(i);
    expect_unharmed_px(frame);
  }
}

TEST(CodecRoundTrip, FrameWithNothingInIt) { expect_unharmed_px(WireValues(1).frame("a", RunId(1), 0, 0)); }

TEST(CodecRoundTrip, ExtremeIdsAndCoordinates) {
  TrackFrame frame = WireValues(2).frame("cam0", RunId(1), 0xffffffff, 0);
  const double far_px = 1e6;
  frame.tracks = {{TrackId(1), quantised_px({-far_px, far_px}, kScale)},
                  {TrackId(128), quantised_px({far_px, -far_px}, kScale)},
                  {TrackId(0x7fffffff), quantised_px({0.03, 639.97}, kScale)},
                  {TrackId(0xffffffff), quantised_px({0, 0}, kScale)}};
  expect_unharmed_px(frame);
}

TEST(CodecRoundTrip, NoPoseNoCovariance) {
  TrackFrame frame = WireValues(2).frame("cam0", RunId(1), 1, 3);
  frame.pose_covariance.setZero();
  expect_unharmed_px(frame);
}

TEST(CodecRoundTrip, ATagPrintedTwiceIsInTheFrameTwice) {
  WireValues values(12);
  TrackFrame frame = values.frame("cam0", RunId(1), 3, 10);
  while (frame.tags.size() < kMaxTags) frame.tags.push_back(values.tag(7));
  expect_unharmed_px(frame);
}

TEST(CodecRoundTrip, EveryImageSizeKeepsItsGrid) {
  for (const int side : {16, 320, 640, 1280, 1920, 4096, 16384}) {
    CameraModel camera = test::vga_camera();
    camera.width_px = side;
    const double scale = pixel_scale(camera);
    TrackFrame frame = WireValues(3).frame("cam0", RunId(1), 0, 0);
    frame.tracks = {{TrackId(5), quantised_px({0.37 * side, -0.2 * side}, scale)}};
    expect_unharmed_px(frame, scale);
  }
}

TEST(CodecRoundTrip, Replies) {
  WireValues values(4);
  const TrackFrame frame = values.frame("cam0", RunId(9), 3);
  for (const int count : {0, 1, 16}) {
    expect_unharmed(values.patches(frame, count));
    expect_unharmed(values.descriptors(frame, count));
  }
}

TEST(CodecRoundTrip, Session) {
  WireValues values(5);
  Hello hello = values.hello("cam0", RunId(9));
  expect_unharmed(hello);
  hello.protocol = 999;
  hello.pacing = Pacing::kLive;
  expect_unharmed(hello);
  expect_unharmed(values.agent_status("cam0", RunId(9)));
  expect_unharmed(values.agent_status("cam0", RunId(9), AgentState::kFinished));
  ServerStatus status = values.server_status(RunId(4));
  expect_unharmed(status);
  status.refused = {{RunId(5), "the name 'cam0' is taken"}, {RunId(6), std::string(200, 'x')}};
  status.agents.assign(64, std::string(32, 'n'));
  expect_unharmed(status);
}

TEST(CodecRoundTrip, AStatusNamesAsManyAgentsAsFit) {
  ServerStatus status = WireValues(5).server_status(RunId(4));
  status.agents.clear();
  for (int i = 0; i < 100; ++i) status.agents.push_back("cam" + std::to_string(i));
  auto decoded = decode(encode(status));
  ASSERT_TRUE(decoded);
  status.agents.resize(idl::MAX_AGENTS);
  expect_same(*decoded, status);
}

TEST(CodecRoundTrip, MapPatches) {
  WireValues values(6);
  for (const int points : {0, 1, 100, 2000}) {
    MapPatch patch = values.map_patch("cam0", RunId(9), 1, points);
    expect_unharmed(patch);
    patch.snapshot = true;
    patch.descriptor_request = DescriptorRequest::kAtTracks;
    patch.scale_known = false;
    patch.placed = PlacedPose{FrameId(12), values.pose()};
    const Rigid3 moved = values.pose();
    patch.new_from_old = {1.25, moved.rotation, moved.translation};
    patch.lens.emplace().values << 0.03125, -4.5, 2.25, 0, 0.001953125, 0, -0.015625, 0.5, 0, 0, 0, 0.25;
    expect_unharmed(patch);
  }
}

TEST(CodecRoundTrip, MovingStates) {
  WireValues values(10);
  for (const std::size_t objects : {0U, 1U, 12U}) {
    expect_unharmed(values.moving_state(objects, 0));
    expect_unharmed(values.moving_state(objects, most_moving_points(objects)));
  }
}

TEST(CodecRoundTrip, AgentPoses) {
  WireValues values(12);
  AgentPose pose = values.agent_pose("cam0", RunId(9));
  expect_unharmed(pose);
  pose.state = PoseState::kNone;
  pose.map = MapId();
  pose.covariance.setZero();
  expect_unharmed(pose);
}

TEST(CodecRoundTrip, AgentImages) {
  AgentImages images = WireValues(14).agent_images("cam0", RunId(9));
  expect_unharmed(images);
  images.complete = false;
  images.problem.clear();
  expect_unharmed(images);
}

TEST(CodecRoundTrip, ThumbnailThatIsNotGiven) {
  Thumbnail thumbnail = WireValues(15).thumbnail("cam0", RunId(9));
  thumbnail.jpeg.clear();
  expect_unharmed(thumbnail);
}

TEST(CodecRoundTrip, PublicSamples) {
  PublicSample sample = WireValues(13).public_sample();
  expect_unharmed(sample);
  sample.octets.clear();
  expect_unharmed(sample);
  sample.octets.assign(5'000'000, 7);
  expect_unharmed(sample);
}

TEST(CodecRoundTrip, AlmostIdentityIsNotTakenForIdentity) {
  MapPatch patch = WireValues(7).map_patch("cam0", RunId(9), 1, 0);
  patch.new_from_old.scale = std::nextafter(1.0, 2.0);
  expect_unharmed(patch);
  patch.new_from_old = {};
  patch.new_from_old.translation.z() = 5e-324;
  expect_unharmed(patch);
}

TEST(CodecSize, AFrameAloneOf300ScatteredTracks) {
  const auto bytes = sample_bytes(encode(WireValues(8).frame("camera-front-left", RunId(1), 100, 300), kScale));
  RecordProperty("bytes", static_cast<int>(bytes));
  EXPECT_LE(bytes, 1500u);
  EXPECT_GE(bytes, 1100u) << "26 bits of coordinates and a few of id a track";
}

TEST(CodecSize, AFrameWithoutTracksIsItsHeader) {
  const auto bytes = sample_bytes(encode(WireValues(8).frame("cam0", RunId(1), 3, 0), kScale));
  EXPECT_EQ(bytes, 168u) << "docs/wire.md tells them one by one";
}

TEST(CodecSize, AMovingStateIsOneDatagram) {
  constexpr std::size_t kWithoutFragments = 1192;  // docs/wire.md, sealed
  for (std::size_t objects = 0; objects <= kMostMovingObjects; ++objects) {
    const MovingState full = WireValues(11).moving_state(objects, most_moving_points(objects));
    EXPECT_LE(sample_bytes(encode(full)), kWithoutFragments) << objects;
  }
}

TEST(CodecSize, ABoundPointCostsThirtyBytes) {
  WireValues values(9);
  MapPatch patch = values.map_patch("cam0", RunId(1), 1, 0);
  const auto empty = sample_bytes(encode(patch));
  for (std::uint32_t i = 0; i < 100; ++i) {
    patch.updated.push_back(values.point());
    patch.updated.back().track = TrackId(4000 + 3 * i);
    patch.updated.back().point = PointId(20'000 + 7 * i);
  }
  EXPECT_LE(sample_bytes(encode(patch)) - empty, 3000u);
  // Fast CDR 2 counts on four octets more than it writes.
  EXPECT_LE(empty, 108u) << "the answer to a frame that changed nothing";
}

}  // namespace
}  // namespace coslam::codec_round_trip_test
