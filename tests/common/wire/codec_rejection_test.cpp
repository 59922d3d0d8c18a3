// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <type_traits>

#include "common/wire/bits.h"
#include "common/wire/codec.h"
#include "tests/common/wire/every_message.h"
#include "tests/support/wire_values.h"

namespace coslam::codec_rejection_test {
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

template <class Type>
class MessageRejects : public testing::Test {};
TYPED_TEST_SUITE(MessageRejects, test::MessageTypes, test::MessageName);

TYPED_TEST(MessageRejects, SendersThatAreNone) {
  using M = typename TypeParam::Message;
  const M good = test::encoded(WireValues(3).sample<typename TypeParam::Value>());
  if constexpr (requires(M & m) { m.agent("cam0"); }) {
    expect_rejected<M>(good, Rejection::kBadText, [](M& m) { m.agent("../x"); });
    expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.agent_run(0); });
  }
  // A frame may be of an agent that has heard no server yet.
  if constexpr (requires(M & m) { m.server_run(0); } && !std::is_same_v<M, idl::TrackFrame>) {
    expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.server_run(0); });
  }
}

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
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.covariance()[7] = 255; });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) {
    for (std::size_t i = 6; i < 21; ++i) m.covariance()[i] = 0;  // each against each: no such thing
  });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.pose_state(3); });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.hull_fraction(-0.1f); });
  expect_rejected<M>(good_frame(), Rejection::kTooMany, [](M& m) { m.pose_inliers(3000); });
}

TEST(CodecRejects, TracksThatDoNotAddUp) {
  using M = idl::TrackFrame;
  expect_rejected<M>(good_frame(), Rejection::kTooMany, [](M& m) { m.track_count(2049); });
  expect_rejected<M>(good_frame(), Rejection::kMalformed, [](M& m) { m.track_count(0); });
  expect_rejected<M>(good_frame(), Rejection::kMalformed, [](M& m) { m.tracks().push_back(0); });
  expect_rejected<M>(good_frame(), Rejection::kMalformed, [](M& m) { m.tracks().pop_back(); });
  expect_rejected<M>(good_frame(), Rejection::kMalformed, [](M& m) { m.tracks().clear(); });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.px_bits(11); });
  expect_rejected<M>(good_frame(), Rejection::kOutOfRange, [](M& m) { m.px_bits(-2); });
  expect_rejected<M>(good_frame(), Rejection::kMissingReference, [](M& m) { m.reference_age(1); });
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

// One track alone, its id and place written by hand.
struct ByHand {
  std::uint32_t parameter = 0;     // of the Rice code of the ids
  std::uint32_t ones = 0, id = 1;  // what stands before the escaped id; its value less one
  std::int16_t x = 0;
  std::uint16_t width = 0;
  int padding = 0;
};

std::string reason_for(const ByHand& hand) {
  BitWriter out;
  out.put(1, 1);
  out.put(hand.parameter, kRiceParameterBits);
  out.put((1U << hand.ones) - 1, static_cast<int>(hand.ones));
  if (hand.ones < kRiceEscape) {
    out.put(0, 1);
    out.put(hand.id, static_cast<int>(hand.parameter));
  } else {
    out.put(hand.id, 32);
  }
  out.put(static_cast<std::uint16_t>(hand.x), 16);
  out.put(0, 16);
  out.put(hand.width, 16);
  out.put(0, 16);
  if (hand.width > 0) out.put_below(hand.width, hand.width + 1U);
  out.put(static_cast<std::uint64_t>(hand.padding), 1);
  idl::TrackFrame m = good_frame();
  m.track_count(1);
  m.tracks(out.take());
  auto decoded = decode(m);
  return decoded ? "track " + std::to_string(decoded->tracks[0].track.value)
                 : std::string(name_of(decoded.rejection()));
}

TEST(CodecRejects, TracksThatNoWriterMakes) {
  EXPECT_EQ(reason_for({.ones = 3}), "track 4");
  EXPECT_EQ(reason_for({.ones = 15, .id = 70000}), "track 70001");
  EXPECT_EQ(reason_for({.ones = 15, .id = 0xfffffffe}), "track 4294967295") << "the largest id";
  EXPECT_EQ(reason_for({.ones = 15, .id = 0xffffffff}), "ids_not_ascending") << "past it";
  EXPECT_EQ(reason_for({.ones = 15, .id = 14}), "malformed") << "longer than needed";
  EXPECT_EQ(reason_for({.parameter = 31, .ones = 2, .id = 0}), "malformed") << "more than 32 bits";
  EXPECT_EQ(reason_for({.ones = 2, .padding = 1}), "malformed") << "bits left over";
  EXPECT_EQ(reason_for({.ones = 2, .x = -32768}), "out_of_range");
  EXPECT_EQ(reason_for({.ones = 2, .x = 32767, .width = 0}), "track 3");
  EXPECT_EQ(reason_for({.ones = 2, .x = 32767, .width = 1}), "out_of_range");
}

TEST(CodecRejects, TracksThatTheReferenceContradicts) {
  // One track of the reference is 7; what follows is written against it.
  const CodedTracks reference = {{7, {100, 100}}};
  const auto reason = [&](std::uint16_t count, std::uint32_t missing, const std::function<void(BitWriter&)>& rest) {
    BitWriter out;
    out.put(missing, 12);
    rest(out);
    idl::TrackFrame m = good_frame();
    m.reference_age(1);
    m.track_count(count);
    m.tracks(out.take());
    auto decoded = decode(m, {FrameId(m.frame() - 1), &reference});
    return decoded ? "accepted" : name_of(decoded.rejection());
  };
  const auto list = [](BitWriter& out, std::uint32_t value, int raw_bits) {
    out.put_list(std::array<std::uint32_t, 1>{value}, raw_bits);
  };
  const auto stays_at = [&](BitWriter& out, std::uint32_t x) {
    for (int i = 0; i < 8; ++i) out.put(0, 16);
    list(out, x, 17);
    list(out, 0, 17);
  };
  EXPECT_EQ(reason(1, 0, [&](BitWriter& out) { stays_at(out, 0); }), "accepted");
  EXPECT_EQ(reason(1, 0, [&](BitWriter& out) { stays_at(out, 2 * 32668); }), "out_of_range") << "100 + 32668";
  EXPECT_EQ(reason(0, 0, [&](BitWriter&) {}), "size_mismatch");
  EXPECT_EQ(reason(0, 2, [&](BitWriter&) {}), "too_many");
  EXPECT_EQ(reason(0, 1, [&](BitWriter& out) { list(out, 0, 12); }), "accepted");
  EXPECT_EQ(reason(0, 1, [&](BitWriter& out) { list(out, 1, 12); }), "malformed") << "there is no second";
  EXPECT_EQ(reason(2, 0,
                   [&](BitWriter& out) {
                     out.put(0, 1);
                     list(out, 6, 32);  // 7 again
                     stays_at(out, 0);
                     for (int i = 0; i < 4; ++i) out.put(0, 16);
                   }),
            "ids_not_ascending");
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
  expect_rejected<P>(patches, Rejection::kTooMany, [](P& m) { m.tracks().resize(17); });
  expect_rejected<P>(patches, Rejection::kOutOfRange, [](P& m) { m.parts(0); });
  expect_rejected<P>(patches, Rejection::kOutOfRange, [](P& m) { m.parts(129); });
  expect_rejected<P>(patches, Rejection::kOutOfRange, [](P& m) { m.part(m.parts()); });
  const D descriptors = encode(values.descriptors(frame, 3));
  expect_rejected<D>(descriptors, Rejection::kOutOfRange, [](D& m) { m.parts(257); });
  expect_rejected<D>(descriptors, Rejection::kSizeMismatch, [](D& m) { m.tracks().pop_back(); });
  expect_rejected<D>(descriptors, Rejection::kSizeMismatch, [](D& m) { m.descriptors().resize(2 * 64); });
  expect_rejected<D>(descriptors, Rejection::kTooMany, [](D& m) { m.tracks().resize(17); });
  expect_rejected<D>(descriptors, Rejection::kIdsNotAscending, [](D& m) { m.tracks()[1] = m.tracks()[0]; });
}

TEST(CodecRejects, Hellos) {
  using M = idl::Hello;
  const M hello = encode(WireValues(4).hello("cam0", RunId(1)));
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.width_px(0xffffffff); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.height_px(3); });
  expect_rejected<M>(hello, Rejection::kNotFinite, [](M& m) { m.fx(kNan); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.fx(-500); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.cx(1281); });
  expect_rejected<M>(hello, Rejection::kNotFinite, [](M& m) { m.coefficients()[7] = kInf; });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.distortion(static_cast<std::uint8_t>(kLensModels)); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.pacing(2); });
  expect_rejected<M>(hello, Rejection::kOutOfRange, [](M& m) { m.rate_hz(0); });
}

TEST(CodecRejects, MapPatches) {
  using M = idl::MapPatch;
  const auto put_float = [](M& m, std::size_t at, float v) { std::memcpy(m.updated().data() + at, &v, sizeof(v)); };
  MapPatch one_point = WireValues(3).map_patch("cam0", RunId(1), 5, 1);
  one_point.updated.resize(1);
  one_point.updated[0].track = TrackId(1);
  one_point.updated[0].point = PointId(1);
  one_point.updated[0].state = PointState::kStatic;
  const M small = encode(one_point);  // an octet each for track, point and state, then x y z, then the covariance
  expect_rejected<M>(good_patch(), Rejection::kBadId, [](M& m) { m.sequence_number(0); });
  expect_rejected<M>(good_patch(), Rejection::kBadId, [](M& m) { m.server_run(0); });
  expect_rejected<M>(good_patch(), Rejection::kBadId, [](M& m) { m.unbound()[0] = 0; });
  expect_rejected<M>(good_patch(), Rejection::kTooMany, [](M& m) { m.patch_requests().assign(2049, 2); });
  expect_rejected<M>(good_patch(), Rejection::kMalformed, [](M& m) { m.patch_requests().push_back(0x80); });
  expect_rejected<M>(small, Rejection::kMalformed, [](M& m) { m.updated().push_back(2); });
  expect_rejected<M>(small, Rejection::kMalformed, [](M& m) { m.updated().pop_back(); });
  expect_rejected<M>(small, Rejection::kTooMany, [](M& m) {
    const auto point = m.updated();
    for (int i = 0; i < 2048; ++i) m.updated().insert(m.updated().end(), point.begin(), point.end());
  });
  expect_rejected<M>(small, Rejection::kOutOfRange, [](M& m) { m.updated()[2] = 3; });
  expect_rejected<M>(small, Rejection::kNotFinite, [&](M& m) { put_float(m, 3, NAN); });
  expect_rejected<M>(small, Rejection::kOutOfRange, [&](M& m) { put_float(m, 3, 2e9f); });
  expect_rejected<M>(small, Rejection::kNotFinite, [](M& m) { m.updated()[16] = 0x7c; });  // infinity
  expect_rejected<M>(good_patch(), Rejection::kSizeMismatch, [](M& m) { m.placed({1, 0, 0}); });
  expect_rejected<M>(good_patch(), Rejection::kSizeMismatch, [](M& m) { m.lens({0, 1, 2}); });
  expect_rejected<M>(good_patch(), Rejection::kOutOfRange, [](M& m) { m.lens(std::vector<float>(12, 4)); });
  expect_rejected<M>(good_patch(), Rejection::kNotFinite, [](M& m) { m.lens(std::vector<float>(12, NAN)); });
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
  const A last = encode(WireValues(5).agent_status("cam0", RunId(1), AgentState::kFinished));
  ASSERT_GT(last.last_image().size(), 2U);
  expect_rejected<A>(last, Rejection::kSizeMismatch, [](A& m) { m.last_image().pop_back(); });
  expect_rejected<A>(last, Rejection::kOverflow, [](A& m) { m.last_image().back().frame(18); });
  expect_rejected<A>(last, Rejection::kWrongRun, [](A& m) { m.last_image().back().agent_run(2); });
  expect_rejected<A>(last, Rejection::kWrongRun, [](A& m) { m.last_image().back().agent("cam1"); });
  expect_rejected<A>(last, Rejection::kDuplicate, [](A& m) { m.last_image().push_back(m.last_image().back()); });
  expect_rejected<A>(last, Rejection::kBadId, [](A& m) { m.last_image().front().tracks().front() = 0; });
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

TEST(CodecRejects, AgentPosesThatAreNone) {
  using M = idl::AgentPose;
  const auto good = encode(WireValues(3).agent_pose("cam0", RunId(9)));
  expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.map_id(0); });
  expect_rejected<M>(good, Rejection::kOutOfRange, [](M& m) { m.pose_state(3); });
  expect_rejected<M>(good, Rejection::kBadRotation, [](M& m) { m.rotation()[0] += 1; });
  expect_rejected<M>(good, Rejection::kNotFinite, [](M& m) { m.translation()[2] = NAN; });
  expect_rejected<M>(good, Rejection::kNotFinite, [](M& m) { m.covariance()[1] = INFINITY; });
  expect_rejected<M>(good, Rejection::kOutOfRange, [](M& m) { m.covariance()[35] = -1; });
}

TEST(CodecRejects, AgentImagesThatAreNone) {
  using M = idl::AgentImages;
  const auto good = encode(WireValues(3).agent_images("cam0", RunId(9)));
  expect_rejected<M>(good, Rejection::kBadText, [](M& m) { m.problem("a\nb"); });
}

TEST(CodecRejects, ThumbnailsThatAreNoJpeg) {
  using M = idl::Thumbnail;
  const auto good = encode(WireValues(3).thumbnail("cam0", RunId(9)));
  expect_rejected<M>(good, Rejection::kOutOfRange, [](M& m) { m.jpeg()[0] = '<'; });
  expect_rejected<M>(good, Rejection::kOutOfRange, [](M& m) { m.jpeg().back() = '>'; });
  expect_rejected<M>(good, Rejection::kOutOfRange, [](M& m) { m.jpeg().resize(3); });
  expect_rejected<M>(good, Rejection::kTooMany, [](M& m) { m.jpeg().resize(kMostThumbnailBytes + 1); });
}

TEST(CodecRejects, PublicSamplesThatAreNone) {
  using M = idl::PublicSample;
  const auto good = encode(WireValues(3).public_sample());
  expect_rejected<M>(good, Rejection::kBadText, [](M& m) { m.topic(""); });
  expect_rejected<M>(good, Rejection::kBadText, [](M& m) { m.topic("coslam"); });
  expect_rejected<M>(good, Rejection::kBadText, [](M& m) { m.topic("/a\nb"); });
  expect_rejected<M>(good, Rejection::kBadText, [](M& m) { m.type(""); });
  expect_rejected<M>(good, Rejection::kTooMany, [](M& m) { m.octets().resize(idl::MAX_PUBLIC_BYTES + 1); });
}

TEST(CodecRejects, MovingStatesThatAreNone) {
  using M = idl::MovingState;
  const auto good = encode(WireValues(3).moving_state(2, 5));
  expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.server_run(0); });
  expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.map_id(0); });
  expect_rejected<M>(good, Rejection::kTooMany, [](M& m) { m.objects().resize(13, m.objects()[0]); });
  expect_rejected<M>(good, Rejection::kTooMany, [](M& m) { m.points().resize(25, m.points()[0]); });
  expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.objects()[0].object(0); });
  expect_rejected<M>(good, Rejection::kNotFinite, [](M& m) { m.objects()[1].centroid()[0] = NAN; });
  expect_rejected<M>(good, Rejection::kNotFinite, [](M& m) { m.objects()[0].velocity_per_s()[2] = INFINITY; });
  expect_rejected<M>(good, Rejection::kOutOfRange, [](M& m) { m.objects()[0].extent()[1] = -1; });
  expect_rejected<M>(good, Rejection::kBadId, [](M& m) { m.points()[0].point(0); });
  expect_rejected<M>(good, Rejection::kOutOfRange, [](M& m) { m.points()[4].position()[0] = 1e10F; });
  expect_rejected<M>(good, Rejection::kOutOfRange, [](M& m) { m.points()[0].covariance()[0] = -1; });
  expect_rejected<M>(good, Rejection::kNotFinite, [](M& m) { m.points()[0].covariance()[1] = NAN; });
}

}  // namespace
}  // namespace coslam::codec_rejection_test
