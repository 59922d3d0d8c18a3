// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the server sends back: MapPatch.
#include "common/base/check.h"
#include "common/wire/checks.h"
#include "common/wire/packing.h"

namespace coslam {
namespace {

constexpr std::size_t kPointBytes = 45;

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

void pack_point(const BoundPoint& b, Packer& packer) {
  packer.put(b.track.value);
  packer.put(b.point.value);
  packer.put(static_cast<std::uint8_t>(b.state));
  for (const float v : b.position) packer.put(v);
  for (const float v : b.covariance) packer.put(v);
}

// The octets of one point must be there.
Problem unpack_point(Unpacker& in, BoundPoint& b) {
  b.track = TrackId(*in.get<std::uint32_t>());
  b.point = PointId(*in.get<std::uint32_t>());
  const auto state = *in.get<std::uint8_t>();
  b.state = static_cast<PointState>(state);
  for (float& v : b.position) v = *in.get<float>();
  for (float& v : b.covariance) v = *in.get<float>();
  const bool direction = b.state == PointState::kUncertain && b.point == PointId();
  return first_of({check_covariance(b.covariance), check_id(b.track), direction ? Problem() : check_id(b.point),
                   check_enum(state, PointState::kDynamic), check_position(b.position)});
}

Problem unpack_points(const std::vector<std::uint8_t>& octets, std::vector<BoundPoint>& points) {
  if (octets.size() % kPointBytes != 0) return Rejection::kSizeMismatch;
  if (const Problem p = check_count(octets.size() / kPointBytes, idl::MAX_TRACKS)) return p;
  points.resize(octets.size() / kPointBytes);
  Unpacker in(octets);
  for (BoundPoint& b : points) {
    if (const Problem p = unpack_point(in, b)) return p;
  }
  return std::nullopt;
}

std::vector<std::uint32_t> pack_ids(const std::vector<TrackId>& ids) {
  COSLAM_CHECK(ids.size() <= idl::MAX_TRACKS, "more tracks than a map patch may name");
  std::vector<std::uint32_t> values;
  values.reserve(ids.size());
  for (const TrackId id : ids) values.push_back(id.value);
  return values;
}

Problem unpack_ids(const std::vector<std::uint32_t>& values, std::vector<TrackId>& ids) {
  if (const Problem p = check_count(values.size(), idl::MAX_TRACKS)) return p;
  ids.reserve(values.size());
  for (const std::uint32_t value : values) {
    if (const Problem p = check_id(ids.emplace_back(value))) return p;
  }
  return std::nullopt;
}

}  // namespace

idl::MapPatch encode(const MapPatch& p) {
  COSLAM_CHECK(p.updated.size() <= idl::MAX_TRACKS, "more points than a map patch may carry");
  idl::MapPatch m;
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
  if (p.placed) {
    m.placed_frame(p.placed->frame.value);
    append(m.placed(), p.placed->cam_from_world.rotation, p.placed->cam_from_world.translation);
  }
  m.updated().reserve(kPointBytes * p.updated.size());
  Packer packer(m.updated());
  for (const BoundPoint& b : p.updated) pack_point(b, packer);
  m.unbound(pack_ids(p.unbound));
  m.patch_requests(pack_ids(p.patch_requests));
  return m;
}

Decoded<MapPatch> decode(const idl::MapPatch& m) {
  MapPatch p;
  p.agent = m.agent().to_string();
  p.server_run = RunId(m.server_run());
  p.agent_run = RunId(m.agent_run());
  p.sequence = m.sequence_number();
  p.after_frame = FrameId(m.after_frame());
  p.snapshot = m.snapshot();
  p.epoch = MapEpoch(m.epoch());
  if (m.descriptor_request() > static_cast<std::uint8_t>(DescriptorRequest::kEverywhere)) return Rejection::kOutOfRange;
  p.descriptor_request = static_cast<DescriptorRequest>(m.descriptor_request());
  p.group = GroupId(m.group());
  p.scale_known = m.scale_known();
  if (p.sequence == 0) return Rejection::kBadId;
  const Problem problem = first_of({check_sender(p.agent, p.agent_run), check_id(p.server_run),
                                    unpack_similarity(m.new_from_old(), p.new_from_old), unpack_placed(m, p.placed),
                                    unpack_points(m.updated(), p.updated), unpack_ids(m.unbound(), p.unbound),
                                    unpack_ids(m.patch_requests(), p.patch_requests)});
  if (problem) return *problem;
  return p;
}

}  // namespace coslam
