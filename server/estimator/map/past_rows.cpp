// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/past.h"
#include "server/estimator/map/serialise.h"

namespace coslam {
namespace {

constexpr int kSetBits = 32;

std::int64_t key_of(CameraId camera, SetId set) {
  return (static_cast<std::int64_t>(camera.value) << kSetBits) | set.value;
}

}  // namespace

// Without what a frame held: that is not past.
struct BareFrame {
  FramePose& frame;
};
template <class A>
void serialize(A& a, BareFrame& v) {
  a(v.frame.set, v.frame.frame, v.frame.capture_ns, v.frame.map, v.frame.joint);
  if (v.frame.valid()) a(v.frame.cam_from_world);
}

template <class A>
void serialize(A& a, PastFrames& v) {
  auto size = static_cast<std::uint32_t>(v.frames.size());
  a(v.put, v.camera, size);
  for (std::uint32_t i = 0; i < size; ++i) {
    if (i == v.frames.size()) v.frames.emplace_back();
    BareFrame bare{v.frames[i]};
    a(bare);
  }
}

std::string octets_of_past(const PastFrames& block) { return octets_of(block); }
std::string octets_of_past(const PastPlaces& block) { return octets_of(block); }

PastFrames past_frames_of(const std::string& octets) {
  PastFrames block;
  read_octets(octets, block);
  return block;
}

PastPlaces past_places_of(const std::string& octets) {
  PastPlaces block;
  read_octets(octets, block);
  return block;
}

std::vector<Row> rows_of(const PastPart& past) {
  std::vector<Row> rows;
  for (const PastFrames& block : past.frames) {
    rows.push_back({kPastFramesTable, key_of(block.camera, block.frames.front().set), octets_of_past(block)});
  }
  if (past.places) {
    rows.push_back({kPastPlacesTable, past.places->places.front().set.value, octets_of_past(*past.places)});
  }
  return rows;
}

std::pair<std::int64_t, std::int64_t> past_frames_rows_of(CameraId camera) {
  return {key_of(camera, SetId(0)), key_of(camera, SetId(0xffffffff))};
}

}  // namespace coslam
