// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the server sends back: MapPatch.
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "common/base/check.h"
#include "common/wire/checks.h"
#include "common/wire/packing.h"

namespace coslam {
namespace {

constexpr std::size_t kUsualPointBytes = 32;

bool is_identity(const Similarity3& s) {
  return s.scale == 1.0 && s.rotation.coeffs() == Eigen::Quaterniond::Identity().coeffs() && s.translation.isZero(0);
}

void append(std::vector<double>& out, const Eigen::Quaterniond& q, const Eigen::Vector3d& t) {
  out.insert(out.end(), {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()});
}

// From 7 numbers.
Rigid3 pose_from(const double* v) { return {Eigen::Quaterniond(v[0], v[1], v[2], v[3]), {v[4], v[5], v[6]}}; }

Problem unpack_similarity(const std::vector<double>& packed, Similarity3& s) {
  if (packed.empty()) return std::nullopt;  // identity
  if (packed.size() != 8) return Rejection::kSizeMismatch;
  const Rigid3 rigid = pose_from(packed.data() + 1);
  s = {packed[0], rigid.rotation, rigid.translation};
  return first_of({check_number(s.scale, 1e-9, 1e9), check_pose(rigid)});
}

Problem unpack_placed(const idl::MapPatch& m, std::optional<PlacedPose>& placed) {
  if (m.placed().empty()) return std::nullopt;
  if (m.placed().size() != 7) return Rejection::kSizeMismatch;
  placed = {FrameId(m.placed_frame()), pose_from(m.placed().data())};
  return check_pose(placed->cam_from_world);
}

Problem unpack_lens(const std::vector<float>& packed, std::optional<LensCorrection>& lens) {
  constexpr double kMostShift_px = 1e5;
  constexpr auto kSize = static_cast<std::size_t>(LensCorrection::kTerms);
  if (packed.empty()) return std::nullopt;
  if (packed.size() != kSize) return Rejection::kSizeMismatch;
  lens.emplace();
  for (std::size_t i = 0; i < kSize; ++i) {
    const double most = i == 1 || i == 2 ? kMostShift_px : LensCorrection::kMost;
    if (const Problem problem = check_number(packed[i], -most, most)) return problem;
    lens->values[static_cast<Eigen::Index>(i)] = packed[i];
  }
  return std::nullopt;
}

// Lower triangle by rows of L, where the covariance is L L^T: of half the precision, and still exact across the ray of
// a point whose distance is badly known.
using Factor = std::array<Eigen::half, 6>;

Factor factor_of(const Eigen::Matrix<float, 6, 1>& packed) {
  const Eigen::Matrix3d covariance = unpack_covariance(packed);
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  Eigen::Matrix3d l = llt.matrixL();
  if (llt.info() != Eigen::Success) l = covariance.diagonal().cwiseMax(0).cwiseSqrt().asDiagonal();
  Factor out;
  auto at = out.begin();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col <= row; ++col) *at++ = Eigen::half(static_cast<float>(std::clamp(l(row, col), -6e4, 6e4)));
  }
  return out;
}

std::optional<Eigen::Matrix<float, 6, 1>> covariance_from(const Factor& factor) {
  Eigen::Matrix3d l = Eigen::Matrix3d::Zero();
  auto at = factor.begin();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col <= row; ++col) l(row, col) = static_cast<float>(*at++);
  }
  if (!l.allFinite()) return std::nullopt;
  return pack_covariance(l * l.transpose());
}

// Track as the step from the one before, in either direction.
std::uint32_t zigzag(std::uint32_t step) { return (step << 1U) ^ (0U - (step >> 31U)); }
std::uint32_t from_zigzag(std::uint32_t code) { return (code >> 1U) ^ (0U - (code & 1U)); }

void pack_point(const BoundPoint& b, TrackId before, Packer& packer) {
  packer.put_varint(zigzag(b.track.value - before.value));
  packer.put_varint(b.point.value);
  packer.put(static_cast<std::uint8_t>(b.state));
  if (!b.has_place()) return;
  for (const float v : b.position) packer.put(v);
  for (const Eigen::half v : factor_of(b.covariance)) packer.put(v);
}

Problem unpack_place(Unpacker& in, BoundPoint& b) {
  if (in.left() < sizeof(float) * 3 + sizeof(Factor)) return Rejection::kMalformed;
  for (float& v : b.position) v = *in.get<float>();
  const auto covariance = covariance_from(*in.get<Factor>());
  if (!covariance) return Rejection::kNotFinite;
  b.covariance = *covariance;
  return first_of({check_covariance(b.covariance), check_position(b.position)});
}

Problem unpack_point(Unpacker& in, TrackId before, BoundPoint& b) {
  const auto step = in.get_varint(), point = in.get_varint();
  const auto state = in.get<std::uint8_t>();
  if (!step || !point || !state) return Rejection::kMalformed;
  b.track = TrackId(before.value + from_zigzag(*step));
  b.point = PointId(*point);
  b.state = static_cast<PointState>(*state);
  if (const Problem p = first_of({check_id(b.track), b.is_direction() ? Problem() : check_id(b.point),
                                  check_enum(*state, PointState::kDynamic)})) {
    return p;
  }
  return b.has_place() ? unpack_place(in, b) : Problem();
}

Problem unpack_points(const std::vector<std::uint8_t>& octets, std::vector<BoundPoint>& points) {
  Unpacker in(octets);
  TrackId before;
  while (in.left() > 0) {
    if (points.size() == idl::MAX_TRACKS) return Rejection::kTooMany;
    BoundPoint& b = points.emplace_back();
    if (const Problem p = unpack_point(in, before, b)) return p;
    before = b.track;
  }
  return std::nullopt;
}

void pack_ids(const std::vector<TrackId>& ids, std::vector<std::uint8_t>& octets) {
  COSLAM_CHECK(ids.size() <= idl::MAX_TRACKS, "more tracks than a map patch may name");
  Packer packer(octets);
  TrackId before;
  for (const TrackId id : ids) {
    packer.put_varint(zigzag(id.value - before.value));
    before = id;
  }
}

Problem unpack_ids(const std::vector<std::uint8_t>& octets, std::vector<TrackId>& ids) {
  Unpacker in(octets);
  TrackId before;
  while (in.left() > 0) {
    const auto step = in.get_varint();
    if (!step) return Rejection::kMalformed;
    if (ids.size() == idl::MAX_TRACKS) return Rejection::kTooMany;
    before = ids.emplace_back(before.value + from_zigzag(*step));
    if (const Problem p = check_id(before)) return p;
  }
  return std::nullopt;
}

}  // namespace

idl::MapPatch encode(const MapPatch& p) {
  COSLAM_CHECK(p.updated.size() <= idl::MAX_TRACKS, "more points than a map patch may carry");
  idl::MapPatch m;
  m.sent_ns(p.sent_ns);
  m.uplink_wait_s(p.uplink_wait_s);
  m.agent_run(p.agent_run.value);
  m.server_run(p.server_run.value);
  m.sequence_number(p.sequence);
  m.after_frame(p.after_frame.value);
  m.epoch(p.epoch.value);
  m.group(p.group.value);
  m.snapshot(p.snapshot);
  m.descriptor_request(static_cast<std::uint8_t>(p.descriptor_request));
  m.scale_known(p.scale_known);
  m.agent(p.agent);
  if (!is_identity(p.new_from_old)) {
    m.new_from_old().push_back(p.new_from_old.scale);
    append(m.new_from_old(), p.new_from_old.rotation, p.new_from_old.translation);
  }
  if (p.continues) {
    m.continued_run(p.continues->server_run.value);
    m.continued_epoch(p.continues->epoch.value);
  }
  if (p.placed) {
    m.placed_frame(p.placed->frame.value);
    append(m.placed(), p.placed->cam_from_world.rotation, p.placed->cam_from_world.translation);
  }
  if (p.lens) {
    for (const double v : p.lens->values) m.lens().push_back(static_cast<float>(v));
  }
  m.updated().reserve(kUsualPointBytes * p.updated.size());
  Packer packer(m.updated());
  TrackId before;
  for (const BoundPoint& b : p.updated) {
    pack_point(b, before, packer);
    before = b.track;
  }
  pack_ids(p.unbound, m.unbound());
  pack_ids(p.patch_requests, m.patch_requests());
  return m;
}

Decoded<MapPatch> decode(const idl::MapPatch& m) {
  MapPatch p;
  p.sent_ns = m.sent_ns();
  p.uplink_wait_s = m.uplink_wait_s();
  p.agent = m.agent().to_string();
  p.server_run = RunId(m.server_run());
  p.agent_run = RunId(m.agent_run());
  p.sequence = m.sequence_number();
  p.after_frame = FrameId(m.after_frame());
  p.snapshot = m.snapshot();
  p.epoch = MapEpoch(m.epoch());
  if (m.descriptor_request() > static_cast<std::uint8_t>(DescriptorRequest::kEverywhere)) return Rejection::kOutOfRange;
  p.descriptor_request = static_cast<DescriptorRequest>(m.descriptor_request());
  if (m.continued_run() != 0) p.continues = {RunId(m.continued_run()), MapEpoch(m.continued_epoch())};
  p.group = GroupId(m.group());
  p.scale_known = m.scale_known();
  if (p.sequence == 0) return Rejection::kBadId;
  const Problem problem =
      first_of({check_sender(p.agent, p.agent_run), check_id(p.server_run), check_number(p.uplink_wait_s, 0, 1e9),
                unpack_similarity(m.new_from_old(), p.new_from_old), unpack_placed(m, p.placed),
                unpack_lens(m.lens(), p.lens), unpack_points(m.updated(), p.updated),
                unpack_ids(m.unbound(), p.unbound), unpack_ids(m.patch_requests(), p.patch_requests)});
  if (problem) return *problem;
  return p;
}

}  // namespace coslam
