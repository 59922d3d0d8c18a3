// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the server tells everybody who wants to know: MovingState.
#include <algorithm>
#include <array>

#include "common/base/check.h"
#include "common/wire/checks.h"

namespace coslam {
namespace {

template <int N>
std::array<float, N> plain(const Eigen::Matrix<float, N, 1>& values) {
  std::array<float, N> out{};
  std::ranges::copy(values, out.begin());
  return out;
}

template <std::size_t N>
Eigen::Matrix<float, static_cast<int>(N), 1> vector(const std::array<float, N>& values) {
  return Eigen::Map<const Eigen::Matrix<float, static_cast<int>(N), 1>>(values.data());
}

idl::MovingObject encode_item(const MovingObjectState& o) {
  idl::MovingObject m;
  m.object(o.object.value);
  m.centroid(plain(o.centroid));
  m.velocity_per_s(plain(o.velocity_per_s));
  m.extent(plain(o.extent));
  m.points(o.points);
  return m;
}

idl::MovingPoint encode_item(const MovingPointState& p) {
  idl::MovingPoint m;
  m.point(p.point.value);
  m.object(p.object.value);
  m.position(plain(p.position));
  m.covariance(plain(p.covariance));
  m.cameras(p.cameras);
  return m;
}

Problem decode_item(const idl::MovingObject& m, MovingObjectState& o) {
  o.object = ObjectId(m.object());
  o.centroid = vector(m.centroid());
  o.velocity_per_s = vector(m.velocity_per_s());
  o.extent = vector(m.extent());
  o.points = m.points();
  if (const Problem p = first_of(
          {check_id(o.object), check_position(o.centroid), check_position(o.velocity_per_s), check_position(o.extent)}))
    return p;
  return o.extent.minCoeff() >= 0 ? std::nullopt : Problem(Rejection::kOutOfRange);
}

Problem decode_item(const idl::MovingPoint& m, MovingPointState& p) {
  p.point = PointId(m.point());
  p.object = ObjectId(m.object());
  p.position = vector(m.position());
  p.covariance = vector(m.covariance());
  p.cameras = m.cameras();
  return first_of({check_id(p.point), check_position(p.position), check_covariance(p.covariance)});
}

template <class Message, class Item>
Problem decode_list(const std::vector<Message>& messages, std::size_t most, std::vector<Item>& items) {
  if (const Problem p = check_count(messages.size(), most)) return p;
  items.resize(messages.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (const Problem p = decode_item(messages[i], items[i])) return p;
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
  for (const MovingObjectState& o : s.objects) m.objects().push_back(encode_item(o));
  for (const MovingPointState& p : s.points) m.points().push_back(encode_item(p));
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
  if (const Problem p = first_of({check_id(s.server_run), check_id(s.map)})) return *p;
  if (const Problem p = decode_list(m.objects(), kMostMovingObjects, s.objects)) return *p;
  if (const Problem p = decode_list(m.points(), most_moving_points(s.objects.size()), s.points)) return *p;
  return s;
}

}  // namespace coslam
