// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/track_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/support/moving_tracks.h"
#include "tests/support/wire_equal.h"

namespace coslam::track_codec_test {
namespace {

using test::expect_same;
using test::hd_camera;
using test::MovingTracks;
using test::vga_camera;

// Mean and largest size of the samples when each frame refers to the one `age` before; 0: to none.
struct Sizes {
  std::size_t mean = 0, most = 0;
};

Sizes round_trips(const CameraModel& camera, double rate_hz, int tracks, int age) {
  TrackEncoder encoder(pixel_scale(camera));
  TrackDecoder decoder;
  MovingTracks moving(camera, rate_hz, tracks);
  Sizes sizes;
  int counted = 0;
  for (int i = 0; i < 60; ++i) {
    const TrackFrame frame = moving.next();
    const bool refers = age > 0 && i >= age;
    const auto message = encoder.encode(
        frame, refers ? std::optional(FrameId(frame.frame.value - static_cast<std::uint32_t>(age))) : std::nullopt);
    auto decoded = decoder.decode(message);
    if (!decoded) {
      ADD_FAILURE() << name_of(decoded.rejection()) << " in frame " << i;
      break;
    }
    expect_same(*decoded, frame);
    EXPECT_EQ(message.reference_age(), refers ? age : 0);
    if (i < age) continue;
    sizes.mean += sample_bytes(message);
    sizes.most = std::max(sizes.most, sample_bytes(message));
    ++counted;
  }
  sizes.mean /= static_cast<std::size_t>(counted);
  std::printf("%4d x %4d px, %2.0f Hz, %4d tracks, reference %2d back: sample %zu B on average, %zu at most\n",
              camera.width_px, camera.height_px, rate_hz, tracks, age, sizes.mean, sizes.most);
  return sizes;
}

TEST(TrackCodec, WhatArrivesIsEqualToTheBitWhateverItRefersTo) {
  for (const CameraModel& camera : {vga_camera(), hd_camera()}) {
    for (const double rate_hz : {30.0, 10.0}) {
      for (const int tracks : {300, 1000}) {
        for (const int age : {0, 1, 3, 10}) round_trips(camera, rate_hz, tracks, age);
      }
    }
  }
}

TEST(TrackCodec, AFrameOf300TracksIsOneDatagramOf1200Bytes) {
  for (const CameraModel& camera : {vga_camera(), hd_camera()}) {
    for (const int age : {1, 2, 3}) EXPECT_LE(round_trips(camera, 30, 300, age).most, 1040U);
    EXPECT_LE(round_trips(camera, 30, 300, 0).most, 1350U) << "alone it is two";
  }
}

class TrackLink : public testing::Test {
 protected:
  // Sends the next frame; the server answers it when it could be used and the answer is not lost.
  std::optional<Rejection> step(bool arrives = true, bool answered = true) {
    const TrackFrame frame = moving_.next();
    message_ = encoder_.encode(frame, acknowledged_);
    if (!arrives) return std::nullopt;
    auto decoded = decoder_.decode(message_);
    if (!decoded) return decoded.rejection();
    expect_same(*decoded, frame);
    if (answered) acknowledged_ = frame.frame;
    return std::nullopt;
  }

  static constexpr int kRate_hz = 30;
  MovingTracks moving_{vga_camera(), kRate_hz, 100};
  TrackEncoder encoder_{pixel_scale(vga_camera())};
  TrackDecoder decoder_;
  std::optional<FrameId> acknowledged_;
  idl::TrackFrame message_;
};

TEST_F(TrackLink, LostFramesAndAnswersAreNotMissed) {
  test::WireValues chance(3);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(step(chance.below(3) > 0, chance.below(3) > 0), std::nullopt) << i;
}

TEST_F(TrackLink, AServerWithoutTheReferenceIsUnderstoodAgainWithinASecond) {
  for (int i = 0; i < 10; ++i) EXPECT_EQ(step(), std::nullopt);
  decoder_ = {};
  int lost = 0;
  while (step() == Rejection::kMissingReference) ++lost;
  EXPECT_GT(lost, 0);
  EXPECT_LE(lost, kRate_hz);
  EXPECT_EQ(message_.reference_age(), 0) << "it stands alone";
  for (int i = 0; i < 10; ++i) EXPECT_EQ(step(), std::nullopt);
  EXPECT_EQ(message_.reference_age(), 1);
}

TEST_F(TrackLink, WithoutAcknowledgementFramesStandAlone) {
  step();
  acknowledged_.reset();  // as by another server
  decoder_ = {};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(step(true, false), std::nullopt);
    EXPECT_EQ(message_.reference_age(), 0);
  }
  acknowledged_ = FrameId(1000);  // never sent
  EXPECT_EQ(step(true, false), std::nullopt);
  EXPECT_EQ(message_.reference_age(), 0);
}

TEST_F(TrackLink, AnOldAcknowledgementIsOfNoUse) {
  step();
  for (int i = 1; i <= kRate_hz; ++i) {
    EXPECT_EQ(step(true, false), std::nullopt);
    EXPECT_EQ(message_.reference_age(), i);
  }
  EXPECT_EQ(step(true, false), std::nullopt);
  EXPECT_EQ(message_.reference_age(), 0) << "more than a second";
}

TEST(TrackDecoder, AReferenceBeforeTheFirstFrame) {
  TrackDecoder decoder;
  idl::TrackFrame message = encode(MovingTracks(vga_camera(), 30, 5).next(), pixel_scale(vga_camera()));
  message.reference_age(1);
  EXPECT_EQ(decoder.decode(message).rejection(), Rejection::kOutOfRange);
}

TEST(TrackEncoder, RefersToTheLast64FramesOnly) {
  TrackEncoder encoder(pixel_scale(vga_camera()));
  TrackDecoder decoder;
  MovingTracks moving(vga_camera(), 200, 20);
  for (std::uint32_t i = 0; i <= FrameMemory::kFrames + 1; ++i) {
    const TrackFrame frame = moving.next();
    const auto message = encoder.encode(frame, FrameId(0));
    EXPECT_EQ(message.reference_age(), i <= FrameMemory::kFrames ? i : 0);
    EXPECT_TRUE(decoder.decode(message));
  }
}

TEST(TrackEncoder, AFrameSentAgainNeedsNoReference) {
  TrackEncoder encoder(pixel_scale(vga_camera()));
  MovingTracks moving(vga_camera(), 30, 50);
  encoder.encode(moving.next(), {});
  const TrackFrame frame = moving.next();
  EXPECT_EQ(encoder.encode(frame, FrameId(0)).reference_age(), 1);
  auto decoded = decode(encoder.encode_alone(frame));
  ASSERT_TRUE(decoded);
  expect_same(*decoded, frame);
}

TEST(TrackEncoder, ReferencesThatHaveLittleInCommon) {
  const double scale = pixel_scale(vga_camera());
  test::WireValues values(5);
  for (const int before : {0, 1, 5, 2000}) {
    for (const int now : {0, 1, 5, 2000}) {
      const TrackFrame first = values.frame("cam0", RunId(9), 0, before),
                       second = values.frame("cam0", RunId(9), 1, now);
      TrackEncoder encoder(scale);
      TrackDecoder decoder;
      ASSERT_TRUE(decoder.decode(encoder.encode(first, {})));
      auto decoded = decoder.decode(encoder.encode(second, FrameId(0)));
      ASSERT_TRUE(decoded) << before << " " << now;
      expect_same(*decoded, second);
    }
  }
}

TEST(TrackEncoder, TheWorstFramesFitTheirBound) {
  const double scale = pixel_scale(vga_camera());
  test::WireValues values(6);
  const auto wild = [&](std::uint32_t number) {
    TrackFrame frame = values.frame("cam0", RunId(9), number, 0);
    for (std::uint32_t i = 0; i < idl::MAX_TRACKS; ++i) {
      const std::uint32_t id = 1 + i * 2'000'000 + (number % 2 == 0 || i % 2 == 0 ? 0 : values.below(1'999'999));
      const Eigen::Vector2d px(values.uniform(-3000, 3000), values.uniform(-3000, 3000));
      frame.tracks.push_back({TrackId(id), quantised_px(px, scale)});
    }
    return frame;
  };
  TrackEncoder encoder(scale);
  TrackDecoder decoder;
  for (std::uint32_t i = 0; i < 6; ++i) {
    const TrackFrame frame = wild(i);
    const auto message = encoder.encode(frame, i == 0 ? std::nullopt : std::optional(FrameId(i - 1)));
    EXPECT_LE(message.tracks().size(), idl::MAX_TRACK_BYTES);
    auto decoded = decoder.decode(message);
    ASSERT_TRUE(decoded) << name_of(decoded.rejection());
    expect_same(*decoded, frame);
  }
}

}  // namespace
}  // namespace coslam::track_codec_test
