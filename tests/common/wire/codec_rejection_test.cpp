// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "common/wire/codec.h"
#include "tests/support/wire_values.h"

namespace coslam {
namespace {

using test::WireValues;

const double kScale = pixel_scale(test::vga_camera());
const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInf = std::numeric_limits<double>::infinity();

// Spoils a good message and expects that the decoder says why it is bad.
template <class Message>
void expect_rejected(Message message, Rejection reason, const std::function<void(Message&)>& spoil) {
  ASSERT_TRUE(decode(message)) << "good before it is spoilt";
  spoil(message);
  auto decoded = decode(message);
  ASSERT_FALSE(decoded) << "wanted " << name_of(reason);
  EXPECT_EQ(name_of(decoded.rejection()), name_of(reason));
}

idl::TrackFrame good_frame() { return encode(WireValues(1).frame("cam0", RunId(1), 5, 20), kScale); }
idl::MapPatch good_patch() { return encode(WireValues(2).map_patch("cam0", RunId(1), 5, 20)); }

TEST(CodecRejects, FramesFromNobody) {
  using M = idl::TrackFrame;
  for (const char* name : {"", ".", "../etc", "a b", "a/b", "caf\xc3\xa9", "a\n"}) {
    expect_rejected<M>(good_frame(), Rejection::kBadText, [&](M& m) { m.agent(name); });
  }
  expect_rejected<M>(good_frame(), Rejection::kBadId, [](M& m) { m.agent_run(0); });
}

TEST(CodecRejects, PosesThatAreNone) {
  using M = idl::TrackFrame;
  expect_rejected<M>(good_frame(), Rejection::kNotFinite, [](M& m) { m.rotation()[2] = kNan; });
  expect_rejected<M>(good_frame(), Rejection::kBadRotation, [](M& m) { m.rotation({0, 0, 0, 0}); });
  expect_rejected<M>(good_frame(), Rejection::kBadRotation, [](M& m) { m.rotation({1, 0.01, 0, 0}); });
  expect_rejected<M>(good_frame(), Rejection::kNotFinite, [](M& m) { m.translation()[0] = kInf; });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.translation()[0] = 1e10; });
  expect_rejected<M>(good_frame(), Rejection::kNotFinite, [](M& m) { m.covariance()[7] = NAN; });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.covariance()[0] = -1; });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.pose_state(3); });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.hull_fraction(-0.1f); });
  expect_rejected<M>(good_frame(), Rejection::kTooMany, [](M& m) { m.pose_inliers(3000); });
}

TEST(CodecRejects, TracksThatDoNotAddUp) {
  using M = idl::TrackFrame;
  expect_rejected<M>(good_frame(), Rejection::kTooMany, [](M& m) { m.track_count(2049); });
  expect_rejected<M>(good_frame(), Rejection::kSizeMismatch, [](M& m) { m.tracks().push_back(0); });
  expect_rejected<M>(good_frame(), Rejection::kSizeMismatch, [](M& m) { m.tracks().pop_back(); });
  expect_rejected<M>(good_frame(), Rejection::kMalformed, [](M& m) { m.tracks().clear(); });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.px_bits(11); });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.px_bits(-2); });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) {
    m.tracks()[m.tracks().size() - 2] = 0x00;  // the last y becomes -32768
    m.tracks()[m.tracks().size() - 1] = 0x80;
  });
}

TEST(CodecRejects, TagsThatDoNotAddUp) {
  using M = idl::TrackFrame;  // with two tags
  expect_rejected<M>(good_frame(), Rejection::kSizeMismatch, [](M& m) { m.tags().pop_back(); });
  expect_rejected<M>(good_frame(), Rejection::kTooMany, [](M& m) { m.tags().resize(17 * 18, 0); });
  expect_rejected<M>(good_frame(), Rejection::kIdsNotAscending, [](M& m) { m.tags()[0] = 200; });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) {
    m.tags()[2] = 0x00;  // the first x becomes -32768
    m.tags()[3] = 0x80;
  });
}

idl::TrackFrame frame_with_ids(const std::vector<std::uint8_t>& ids, std::uint16_t count) {
  idl::TrackFrame m = good_frame();
  m.track_count(count);
  m.tracks(ids);
  m.tracks().resize(ids.size() + 4u * count, 0);
  return m;
}

TEST(CodecRejects, IdsThatRepeatOrWrap) {
  const auto reason = [](const std::vector<std::uint8_t>& ids, std::uint16_t count) {
    auto decoded = decode(frame_with_ids(ids, count));
    return decoded ? "accepted" : name_of(decoded.rejection());
  };
  EXPECT_EQ(reason({1, 1}, 2), "accepted");
  EXPECT_EQ(reason({0, 1}, 2), "ids_not_ascending") << "id 0";
  EXPECT_EQ(reason({1, 0}, 2), "ids_not_ascending") << "the same again";
  EXPECT_EQ(reason({0xff, 0xff, 0xff, 0xff, 0x0f}, 1), "accepted") << "the largest id";
  EXPECT_EQ(reason({0xff, 0xff, 0xff, 0xff, 0x0f, 1}, 2), "ids_not_ascending") << "past the largest id";
  EXPECT_EQ(reason({0xff, 0xff, 0xff, 0xff, 0x1f}, 1), "malformed") << "more than 32 bits";
  EXPECT_EQ(reason({0xff, 0xff, 0xff, 0xff, 0xff, 0x01}, 1), "malformed") << "more than 5 octets";
  EXPECT_EQ(reason({0x81, 0x00}, 1), "malformed") << "longer than needed";
}

TEST(CodecRejects, Replies) {
  using P = idl::PatchReply;
  using D = idl::DescriptorReply;
  WireValues values(3);
  const TrackFrame frame = values.frame("cam0", RunId(1), 5, 20);
  const P patches = encode(values.patches(frame, 3));
  expect_rejected<P>(patches, Rejection::kSizeMismatch, [](P& m) { m.grey().pop_back(); });
  expect_rejected<P>(patches, Rejection::kBadId, [](P& m) { m.tracks()[1] = 0; });
  expect_rejected<P>(patches, Rejection::kOutOfRange, [](P& m) { m.grey()[0] = 5; });
  expect_rejected<P>(patches, Rejection::kOutOfRange, [](P& m) { m.grey()[1] = 255; });
  expect_rejected<P>(patches, Rejection::kTooMany, [](P& m) { m.tracks().resize(2049); });
  const D descriptors = encode(values.descriptors(frame, 3));
  expect_rejected<D>(descriptors, Rejection::kSizeMismatch, [](D& m) { m.tracks().pop_back(); });
  expect_rejected<D>(descriptors, Rejection::kSizeMismatch, [](D& m) { m.descriptors().resize(2 * 64); });
  expect_rejected<D>(descriptors, Rejection::kTooMany, [](D& m) { m.tracks().resize(4097); });
  expect_rejected<D>(descriptors, Rejection::kIdsNotAscending, [](D& m) { m.tracks()[1] = m.tracks()[0]; });
}

TEST(CodecRejects, Hellos) {
  using M = idl::Hello;
  const M hello = encode(WireValues(4).hello("cam0", RunId(1)));
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.width_px(0xffffffff); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.height_px(3); });
  expect_rejected<M>(hello, Rejection::kNotFinite, [](M& m) { m.fx(kNan); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.fx(-500); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.cx(641); });
  expect_rejected<M>(hello, Rejection::kNotFinite, [](M& m) { m.coefficients()[7] = kInf; });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.distortion(3); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.pacing(2); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.rate_hz(0); });
}

TEST(CodecRejects, MapPatches) {
  using M = idl::MapPatch;
  const auto put_float = [](M& m, std::size_t at, float v) { std::memcpy(m.updated().data() + at, &v, sizeof(v)); };
  expect_rejected<M>(good_patch(), Rejection::kBadId, [](M& m) { m.sequence_number(0); });
  expect_rejected<M>(good_patch(), Rejection::kBadId, [](M& m) { m.server_run(0); });
  expect_rejected<M>(good_patch(), Rejection::kBadId, [](M& m) { m.unbound()[0] = 0; });
  expect_rejected<M>(good_patch(), Rejection::kTooMany, [](M& m) { m.patch_requests().resize(2049, 1); });
  expect_rejected<M>(good_patch(), Rejection::kSizeMismatch, [](M& m) { m.updated().push_back(0); });
  expect_rejected<M>(good_patch(), Rejection::kTooMany, [](M& m) { m.updated().resize(45 * 2049); });
  expect_rejected<M>(good_patch(), Rejection::kOutOfRange, [](M& m) { m.updated()[8] = 3; });
  expect_rejected<M>(good_patch(), Rejection::kNotFinite, [&](M& m) { put_float(m, 9, NAN); });
  expect_rejected<M>(good_patch(), Rejection::kOutOfRange, [&](M& m) { put_float(m, 9, 2e9f); });
  expect_rejected<M>(good_patch(), Rejection::kOutOfRange, [&](M& m) { put_float(m, 21, -1.0f); });
  expect_rejected<M>(good_patch(), Rejection::kSizeMismatch, [](M& m) { m.placed({1, 0, 0}); });
  expect_rejected<M>(good_patch(), Rejection::kBadRotation, [](M& m) { m.placed({1, 1, 1, 1, 0, 0, 0}); });
  expect_rejected<M>(good_patch(), Rejection::kOutOfRange, [](M& m) { m.new_from_old({0, 1, 0, 0, 0, 0, 0, 0}); });
  expect_rejected<M>(good_patch(), Rejection::kNotFinite, [](M& m) { m.new_from_old({1, 1, 0, 0, 0, kNan, 0, 0}); });
}

TEST(CodecRejects, Statuses) {
  using A = idl::AgentStatus;
  using S = idl::ServerStatus;
  const A agent = encode(WireValues(5).agent_status("cam0", RunId(1)));
  expect_rejected<A>(agent, Rejection::kOutOfRange, [](A& m) { m.state(3); });
  expect_rejected<A>(agent, Rejection::kNotFinite, [](A& m) { m.frame_ms(NAN); });
  expect_rejected<A>(agent, Rejection::kTooMany, [](A& m) { m.report_json().resize(65537); });
  const S server = encode(WireValues(5).server_status(RunId(1)));
  expect_rejected<S>(server, Rejection::kBadId, [](S& m) { m.server_run(0); });
  expect_rejected<S>(server, Rejection::kTooMany, [](S& m) {
    std::string names;
    for (int i = 0; i < 65; ++i) names += "x ";
    m.agents(names);
  });
  expect_rejected<S>(server, Rejection::kBadText, [](S& m) { m.agents("\x1b[2J "); });
  expect_rejected<S>(server, Rejection::kTooMany, [](S& m) { m.refused().resize(17, 1); });
  expect_rejected<S>(server, Rejection::kSizeMismatch, [](S& m) { m.refused({3}); });
  expect_rejected<S>(server, Rejection::kBadText, [](S& m) {
    m.refused({3});
    m.reasons("\a\n");
  });
}

TEST(RejectionCounts, CountByReason) {
  RejectionCounts counts;
  counts.add(Rejection::kOverflow);
  counts.add(Rejection::kOverflow);
  counts.add(Rejection::kMalformed);
  EXPECT_EQ(counts[Rejection::kOverflow], 2u);
  EXPECT_EQ(counts.total(), 3u);
  EXPECT_EQ(name_of(Rejection::kOverflow), "overflow");
  EXPECT_EQ(name_of(Rejection::kMalformed), "malformed");
}

TEST(CodecRejects, MovingStatesThatAreNone) {
  using M = idl::MovingState;
  const auto good = encode(WireValues(3).moving_state(2, 5));
  const auto put = [](std::vector<std::uint8_t>& octets, std::size_t at, float value) {
    std::memcpy(octets.data() + at, &value, sizeof(value));
  };
  expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.server_run(0); });
  expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.map_id(0); });
  expect_rejected<M>(good, Rejection::kSizeMismatch, [](M& m) { m.points().pop_back(); });
  expect_rejected<M>(good, Rejection::kSizeMismatch, [](M& m) { m.objects().push_back(0); });
  expect_rejected<M>(good, Rejection::kTooMany, [](M& m) { m.objects().resize(13 * 42, 1); });
  expect_rejected<M>(good, Rejection::kTooMany, [](M& m) { m.points().resize(25 * 45, 1); });
  expect_rejected<M>(good, Rejection::kBadId, [&](M& m) { put(m.objects(), 0, 0.0f); });
  expect_rejected<M>(good, Rejection::kNotFinite, [&](M& m) { put(m.objects(), 4, NAN); });
  expect_rejected<M>(good, Rejection::kNotFinite, [&](M& m) { put(m.objects(), 16, INFINITY); });
  expect_rejected<M>(good, Rejection::kOutOfRange, [&](M& m) { put(m.objects(), 28, -1.0f); });
  expect_rejected<M>(good, Rejection::kBadId, [&](M& m) { put(m.points(), 0, 0.0f); });
  expect_rejected<M>(good, Rejection::kOutOfRange, [&](M& m) { put(m.points(), 8, 1e10f); });
  expect_rejected<M>(good, Rejection::kOutOfRange, [&](M& m) { put(m.points(), 20, -1.0f); });
  expect_rejected<M>(good, Rejection::kNotFinite, [&](M& m) { put(m.points(), 24, NAN); });
}

}  // namespace
}  // namespace coslam
