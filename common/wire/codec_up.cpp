// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What agents send with and after a frame: TrackFrame, PatchReply, DescriptorReply.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/check.h"
#include "common/model/pose_covariance.h"
#include "common/wire/checks.h"
#include "common/wire/packing.h"
#include "common/wire/track_bits.h"

namespace coslam {
namespace {

// Of pixel_scale() for images of 16 to 16384 pixels a side.
constexpr int kMinPxBits = -1;
constexpr int kMaxPxBits = 10;

std::int16_t px_bits(double px_scale) { return static_cast<std::int16_t>(std::ilogb(px_scale)); }

std::int16_t quantise(float px, double px_scale) {
  COSLAM_CHECK(std::isfinite(px), "coordinates must be finite");
  const double limit = kMostUnits;  // -32768 is never sent, see quantised_px()
  return static_cast<std::int16_t>(std::lround(std::clamp(static_cast<double>(px) * px_scale, -limit, limit)));
}

float dequantise(std::int32_t units, int bits) { return std::ldexp(static_cast<float>(units), -bits); }

Problem check_units(std::int16_t x, std::int16_t y) {
  return std::min(x, y) >= -kMostUnits ? std::nullopt : Problem(Rejection::kOutOfRange);
}

Problem unpack_tracks(const idl::TrackFrame& m, const TrackReference& reference,
                      std::vector<TrackObservation>& tracks) {
  if (const Problem p = check_count(m.track_count(), idl::MAX_TRACKS)) return p;
  if (const Problem p = check_number(m.px_bits(), kMinPxBits, kMaxPxBits)) return p;
  const bool needs_one = m.reference_age() > 0;
  if (needs_one && (reference.tracks == nullptr || m.frame() - m.reference_age() != reference.frame.value)) {
    return Rejection::kMissingReference;
  }
  CodedTracks coded;
  if (const Problem p =
          unpack_tracks(m.tracks(), m.track_count(), needs_one ? *reference.tracks : CodedTracks(), coded)) {
    return p;
  }
  tracks.reserve(coded.size());
  for (const CodedTrack& t : coded) {
    tracks.push_back({TrackId(t.track), {dequantise(t.at.x, m.px_bits()), dequantise(t.at.y, m.px_bits())}});
  }
  return std::nullopt;
}

static_assert(idl::MAX_TRACKS == kMaxTracks);
constexpr std::size_t kTagBytes = 18;
static_assert(idl::MAX_TAG_BYTES == kTagBytes * kMaxTags);

std::vector<std::uint8_t> pack_tags(const std::vector<TagObservation>& tags, double px_scale) {
  std::vector<std::uint8_t> octets;
  Packer packer(octets);
  for (const TagObservation& t : tags) {
    packer.put(t.tag.value);
    for (const Eigen::Vector2f& px : t.undistorted_px) {
      packer.put(quantise(px.x(), px_scale));
      packer.put(quantise(px.y(), px_scale));
    }
  }
  return octets;
}

Problem unpack_tags(const idl::TrackFrame& m, std::vector<TagObservation>& tags) {
  if (const Problem p = check_count(m.tags().size(), idl::MAX_TAG_BYTES)) return p;
  if (m.tags().size() % kTagBytes != 0) return Rejection::kSizeMismatch;
  Unpacker in(m.tags());
  while (in.left() > 0) {
    TagObservation& t = tags.emplace_back();
    t.tag = TagId(*in.get<std::uint16_t>());
    if (tags.size() > 1 && t.tag < tags[tags.size() - 2].tag) return Rejection::kIdsNotAscending;
    for (Eigen::Vector2f& px : t.undistorted_px) {
      const std::int16_t x = *in.get<std::int16_t>(), y = *in.get<std::int16_t>();
      if (const Problem p = check_units(x, y)) return p;
      px = {dequantise(x, m.px_bits()), dequantise(y, m.px_bits())};
    }
  }
  return std::nullopt;
}

Problem unpack_pose_covariance(const std::array<std::uint8_t, 21>& code, Eigen::Matrix<float, 6, 6>& m) {
  if (!is_valid(code)) return Rejection::kOutOfRange;
  m = decoded_pose_covariance(code);
  return std::nullopt;
}

// Two patch pixels an octet, the first in the low half.
constexpr std::size_t kPatchRecordBytes = 2 + (kPatchBytes + 1) / 2;
static_assert(idl::MAX_PATCH_BYTES == kPatchRecordBytes * idl::MAX_PART);
static_assert(idl::MAX_DESCRIPTOR_BYTES == kDescriptorBytes / 2 * idl::MAX_PART);

template <class Message>
Problem check_part(const Message& m, std::uint32_t most_parts) {
  if (m.parts() < 1 || m.parts() > most_parts || m.part() >= m.parts()) return Rejection::kOutOfRange;
  return check_count(m.tracks().size(), idl::MAX_PART);
}

void pack_patch(const PatchGrey& grey, Packer& out) {
  const int shift = patch_shift(grey);
  const int lowest = *std::min_element(grey.begin(), grey.end()) >> shift;
  out.put(static_cast<std::uint8_t>(shift));
  out.put(static_cast<std::uint8_t>(lowest));
  for (std::size_t i = 0; i < grey.size(); i += 2) {
    const int first = (grey[i] >> shift) - lowest;
    const int second = i + 1 < grey.size() ? (grey[i + 1] >> shift) - lowest : 0;
    out.put(static_cast<std::uint8_t>(first | second << 4));
  }
}

Problem unpack_patch(Unpacker& in, PatchGrey& grey) {
  const int shift = *in.get<std::uint8_t>(), lowest = *in.get<std::uint8_t>();
  if (shift > 4) return Rejection::kOutOfRange;
  const int half = (1 << shift) >> 1;
  std::uint8_t pair = 0;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    pair = i % 2 == 0 ? *in.get<std::uint8_t>() : static_cast<std::uint8_t>(pair >> 4);
    const int value = ((lowest + (pair & 15)) << shift) | half;
    if (value > 255) return Rejection::kOutOfRange;
    grey[i] = static_cast<std::uint8_t>(value);
  }
  return std::nullopt;
}

}  // namespace

CodedTracks coded_tracks(const TrackFrame& frame, double px_scale) {
  CodedTracks tracks;
  tracks.reserve(frame.tracks.size());
  TrackId before;
  for (const TrackObservation& t : frame.tracks) {
    COSLAM_CHECK(t.track > before, "track ids must ascend");
    before = t.track;
    tracks.push_back(
        {t.track.value, {quantise(t.undistorted_px.x(), px_scale), quantise(t.undistorted_px.y(), px_scale)}});
  }
  return tracks;
}

idl::TrackFrame encode(const TrackFrame& f, double px_scale, const TrackReference& reference) {
  COSLAM_CHECK(f.tracks.size() <= idl::MAX_TRACKS, "more tracks than a frame may carry");
  COSLAM_CHECK(f.tags.size() <= kMaxTags, "more tags than a frame may carry");
  const Eigen::Quaterniond& q = f.cam_from_world.rotation;
  const Eigen::Vector3d& t = f.cam_from_world.translation;
  idl::TrackFrame m;
  m.agent_run(f.agent_run.value);
  m.server_run(f.server_run.value);
  m.capture_ns(f.capture_ns);
  m.clock_set_ns(f.clock_set_ns);
  m.rotation({q.w(), q.x(), q.y(), q.z()});
  m.translation({t.x(), t.y(), t.z()});
  m.covariance(code_of_pose_covariance(f.pose_covariance));
  m.hull_fraction(f.hull_fraction);
  m.frame(f.frame.value);
  m.epoch(f.epoch.value);
  m.applied_patch(f.applied_patch);
  m.pose_inliers(f.pose_inliers);
  m.patches_sent(f.patches_sent);
  m.track_count(static_cast<std::uint16_t>(f.tracks.size()));
  m.px_bits(px_bits(px_scale));
  m.pose_state(static_cast<std::uint8_t>(f.pose_state));
  m.wants_snapshot(f.wants_snapshot);
  m.descriptors_sent(static_cast<std::uint8_t>(f.descriptors_sent));
  m.on_own_points(f.on_own_points);
  m.narrow_link(f.narrow_link);
  m.images_doubted(f.images_doubted);
  m.agent(f.agent);
  const bool has_one = reference.tracks != nullptr;
  m.reference_age(static_cast<std::uint16_t>(has_one ? f.frame.value - reference.frame.value : 0));
  m.tracks(pack_tracks(coded_tracks(f, px_scale), has_one ? *reference.tracks : CodedTracks()));
  m.tags(pack_tags(f.tags, px_scale));
  return m;
}

namespace {
// A board without a clock of its own begins in 1970.
constexpr double kMostClockSet_s = 2.5e9;
}  // namespace

Decoded<TrackFrame> decode_header(const idl::TrackFrame& m) {
  TrackFrame f;
  f.agent = m.agent().to_string();
  f.agent_run = RunId(m.agent_run());
  f.frame = FrameId(m.frame());
  f.capture_ns = m.capture_ns();
  f.clock_set_ns = m.clock_set_ns();
  f.server_run = RunId(m.server_run());
  f.epoch = MapEpoch(m.epoch());
  f.cam_from_world.rotation = {m.rotation()[0], m.rotation()[1], m.rotation()[2], m.rotation()[3]};
  f.cam_from_world.translation = {m.translation()[0], m.translation()[1], m.translation()[2]};
  f.pose_inliers = m.pose_inliers();
  f.hull_fraction = m.hull_fraction();
  f.applied_patch = m.applied_patch();
  f.wants_snapshot = m.wants_snapshot();
  f.patches_sent = m.patches_sent();
  f.descriptors_sent = static_cast<DescriptorsSent>(m.descriptors_sent());
  f.on_own_points = m.on_own_points();
  f.narrow_link = m.narrow_link();
  f.images_doubted = m.images_doubted();
  f.pose_state = static_cast<PoseState>(m.pose_state());
  // Undistorted pixels of a hull may lie outside the image, hence fractions above 1.
  const Problem problem =
      first_of({check_sender(f.agent, f.agent_run), check_enum(m.pose_state(), PoseState::kLost),
                check_enum(m.descriptors_sent(), DescriptorsSent::kLater), check_pose(f.cam_from_world),
                check_number(to_seconds(f.clock_set_ns), -kMostClockSet_s, kMostClockSet_s),
                unpack_pose_covariance(m.covariance(), f.pose_covariance), check_number(f.hull_fraction, 0, 100),
                check_count(f.pose_inliers, idl::MAX_TRACKS), check_count(f.patches_sent, idl::MAX_TRACKS)});
  if (problem) return *problem;
  return f;
}

Decoded<TrackFrame> decode(const idl::TrackFrame& m, const TrackReference& reference) {
  auto frame = decode_header(m);
  if (!frame) return frame;
  if (const Problem p = unpack_tracks(m, reference, frame->tracks)) return *p;
  if (const Problem p = unpack_tags(m, frame->tags)) return *p;
  return frame;
}

idl::PatchReply encode(const PatchReply& r) {
  COSLAM_CHECK(r.patches.size() <= idl::MAX_PART, "more patches than a part may carry");
  idl::PatchReply m;
  m.part(r.part.number);
  m.parts(r.part.count);
  m.agent_run(r.agent_run.value);
  m.frame(r.frame.value);
  m.agent(r.agent);
  m.grey().reserve(r.patches.size() * kPatchRecordBytes);
  Packer packer(m.grey());
  for (const ImagePatch& p : r.patches) {
    m.tracks().push_back(p.track.value);
    pack_patch(p.grey, packer);
  }
  return m;
}

Decoded<PatchReply> decode(const idl::PatchReply& m) {
  PatchReply r{m.agent().to_string(), RunId(m.agent_run()), FrameId(m.frame()), {}, {m.part(), m.parts()}};
  if (const Problem p = first_of({check_sender(r.agent, r.agent_run), check_part(m, idl::MAX_TRACKS / idl::MAX_PART)}))
    return *p;
  if (m.grey().size() != m.tracks().size() * kPatchRecordBytes) return Rejection::kSizeMismatch;
  Unpacker in(m.grey());
  for (const std::uint32_t id : m.tracks()) {
    if (id == 0) return Rejection::kBadId;
    ImagePatch& patch = r.patches.emplace_back();
    patch.track = TrackId(id);
    if (const Problem p = unpack_patch(in, patch.grey)) return *p;
  }
  return r;
}

idl::DescriptorReply encode(const DescriptorReply& r) {
  COSLAM_CHECK(r.tracks.size() <= idl::MAX_PART, "more descriptors than a part may carry");
  COSLAM_CHECK(r.descriptors.size() == r.tracks.size() * kDescriptorBytes, "one descriptor a track");
  idl::DescriptorReply m;
  m.part(r.part.number);
  m.parts(r.part.count);
  m.agent_run(r.agent_run.value);
  m.frame(r.frame.value);
  m.agent(r.agent);
  m.tracks().reserve(r.tracks.size());
  for (const TrackId id : r.tracks) m.tracks().push_back(id.value);
  m.descriptors().reserve(r.descriptors.size() / 2);
  for (std::size_t i = 0; i < r.descriptors.size(); i += 2) {
    m.descriptors().push_back(
        static_cast<std::uint8_t>(descriptor_step(r.descriptors[i]) | (descriptor_step(r.descriptors[i + 1]) << 4U)));
  }
  return m;
}

Decoded<DescriptorReply> decode(const idl::DescriptorReply& m) {
  DescriptorReply r{m.agent().to_string(), RunId(m.agent_run()), FrameId(m.frame()), {}, {}, {m.part(), m.parts()}};
  if (const Problem p = first_of({check_sender(r.agent, r.agent_run), check_part(m, idl::MAX_PARTS)})) return *p;
  if (m.descriptors().size() != m.tracks().size() * kDescriptorBytes / 2) return Rejection::kSizeMismatch;
  for (const std::uint32_t id : m.tracks()) {
    if (id == 0) return Rejection::kBadId;
    if (!r.tracks.empty() && r.tracks.back().value >= id) return Rejection::kIdsNotAscending;
    r.tracks.emplace_back(id);
  }
  const auto value = [](int step) { return static_cast<std::uint8_t>(step * step); };
  r.descriptors.reserve(m.descriptors().size() * 2);
  for (const std::uint8_t both : m.descriptors()) {
    r.descriptors.push_back(value(both & 15U));
    r.descriptors.push_back(value(both >> 4U));
  }
  return r;
}

}  // namespace coslam
