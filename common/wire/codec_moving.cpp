// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the server tells everybody who wants to know: MovingState.
#include "common/base/check.h"
#include "common/wire/checks.h"
#include "common/wire/packing.h"

namespace coslam {
namespace {

constexpr std::size_t kPointBytes = 45, kObjectBytes = 42;

template <class Vector>
void put(Packer& packer, const Vector& values) {
  for (const float v : values) packer.put(v);
}

// The octets of the whole vector must be there.
template <class Vector>
void get(Unpacker& in, Vector& values) {
  for (float& v : values) v = *in.get<float>();
}

Problem unpack(Unpacker& in, MovingPointState& p) {
  p.point = PointId(*in.get<std::uint32_t>());
  p.object = ObjectId(*in.get<std::uint32_t>());
  get(in, p.position);
  get(in, p.covariance);
  p.cameras = *in.get<std::uint8_t>();
  return first_of({check_id(p.point), check_position(p.position), check_covariance(p.covariance)});
}

Problem unpack(Unpacker& in, MovingObjectState& o) {
  o.object = ObjectId(*in.get<std::uint32_t>());
  get(in, o.centroid);
  get(in, o.velocity_per_s);
  get(in, o.extent);
  o.points = *in.get<std::uint16_t>();
  if (const Problem p = first_of(
          {check_id(o.object), check_position(o.centroid), check_position(o.velocity_per_s), check_position(o.extent)}))
    return p;
  return o.extent.minCoeff() >= 0 ? std::nullopt : Problem(Rejection::kOutOfRange);
}

template <class Item>
Problem unpack_list(const std::vector<std::uint8_t>& octets, std::size_t item_bytes, std::size_t most,
                    std::vector<Item>& items) {
  if (octets.size() % item_bytes != 0) return Rejection::kSizeMismatch;
  if (const Problem p = check_count(octets.size() / item_bytes, most)) return p;
  items.resize(octets.size() / item_bytes);
  Unpacker in(octets);
  for (Item& item : items) {
    if (const Problem p = unpack(in, item)) return p;
  }
  return std::nullopt;
}

}  // namespace

idl::MovingState encode(const MovingState& s) {
  COSLAM_CHECK(s.objects.size() <= kMostMovingObjects, "more objects than a moving state may carry");
  COSLAM_CHECK(s.points.size() <= most_moving_points(s.objects.size()), "more points than a moving state may carry");
  idl::MovingState m;
  m.server_run(s.server_run.value);
  m.map_id(s.map.value);
  m.epoch(s.epoch.value);
  m.t_ns(s.t_ns);
  m.scale_known(s.scale_known);
  m.left_out(s.left_out);
  Packer objects(m.objects());
  for (const MovingObjectState& o : s.objects) {
    objects.put(o.object.value);
    put(objects, o.centroid);
    put(objects, o.velocity_per_s);
    put(objects, o.extent);
    objects.put(o.points);
  }
  Packer points(m.points());
  for (const MovingPointState& p : s.points) {
    points.put(p.point.value);
    points.put(p.object.value);
    put(points, p.position);
    put(points, p.covariance);
    points.put(p.cameras);
  }
  return m;
}

Decoded<MovingState> decode(const idl::MovingState& m) {
  MovingState s;
  s.server_run = RunId(m.server_run());
  s.map = MapId(m.map_id());
  s.epoch = MapEpoch(m.epoch());
  s.t_ns = m.t_ns();
  s.scale_known = m.scale_known();
  s.left_out = m.left_out();
  const Problem problem = first_of(
      {check_id(s.server_run), check_id(s.map), unpack_list(m.objects(), kObjectBytes, kMostMovingObjects, s.objects)});
  if (problem) return *problem;
  if (const Problem p = unpack_list(m.points(), kPointBytes, most_moving_points(s.objects.size()), s.points)) return *p;
  return s;
}

}  // namespace coslam
