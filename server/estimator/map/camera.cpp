// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace coslam {
namespace {

// Of the time between two frames at an instant: 0 at the one before, 1 at the newer one.
double share_at(const CameraFrames& camera, const FramePose& before, const FramePose& now, TimeNs t_ns) {
  return static_cast<double>(t_ns - camera.taken_ns(before)) / static_cast<double>(now.capture_ns - before.capture_ns);
}

}  // namespace

std::optional<std::size_t> ServerTrack::index_at(SetId set) const {
  const auto at =
      std::lower_bound(seen.begin(), seen.end(), set, [](const TrackPoint& s, SetId want) { return s.set < want; });
  if (at == seen.end() || at->set != set) return std::nullopt;
  return static_cast<std::size_t>(at - seen.begin());
}

int CameraFrames::frames_in(double time_s, int least) const {
  return std::max(least, static_cast<int>(std::lround(time_s / frame_interval_s)));
}

const FramePose* CameraFrames::frame_at(SetId set) const {
  if (frames.empty() || set > frames.back().set) return nullptr;
  // Mostly it has one in every set.
  const std::uint32_t before_newest = frames.back().set.value - set.value;
  if (before_newest < frames.size()) {
    const FramePose& f = frames[frames.size() - 1 - before_newest];
    if (f.set == set) return &f;
  }
  const auto at =
      std::lower_bound(frames.begin(), frames.end(), set, [](const FramePose& f, SetId s) { return f.set < s; });
  return at == frames.end() || at->set != set ? nullptr : &*at;
}

std::optional<Similarity3> CameraLocalisation::moved_since(MapEpoch epoch) const {
  const auto at = std::ranges::find(announced, epoch, &AnnouncedEpoch::epoch);
  return at == announced.end() ? std::nullopt : std::optional(at->moved);
}

std::span<const FramePose> CameraFrames::present_frames() const {
  const auto first =
      std::lower_bound(frames.begin(), frames.end(), past.until, [](const FramePose& f, SetId s) { return f.set < s; });
  return {first, frames.end()};
}

int CameraFrames::frames_in_map(MapId in) const {
  const auto before = past.placed.find(in);
  const auto present = std::ranges::count(present_frames(), in, &FramePose::map);
  return static_cast<int>(present) + (before == past.placed.end() ? 0 : before->second);
}

std::optional<Rigid3> CameraFrames::pose_at(SetId set, TimeNs t_ns) const {
  constexpr TimeNs kSameInstantNs = 1'000'000;
  const FramePose* f = frame_at(set);
  if (f == nullptr || !f->valid()) return std::nullopt;
  const FramePose* before = f == frames.data() ? nullptr : f - 1;
  if (std::abs(t_ns - taken_ns(*f)) < kSameInstantNs || before == nullptr || before->map != f->map)
    return f->cam_from_world;
  const double share = share_at(*this, *before, *f, t_ns);
  return share >= 0 && share <= 2 ? interpolate(before->cam_from_world, f->cam_from_world, share) : f->cam_from_world;
}

std::optional<View> MapCamera::view_at(MapId in, SetId set, const Sighting& seen, TimeNs t_ns) const {
  const FramePose* f = frame_at(set);
  const auto pose = pose_at(set, t_ns);
  if (!pose || f->map != in) return std::nullopt;
  View view{&model, *pose, seen.undistorted_px.cast<double>()};
  if (f == frames.data()) return view;
  const double share = share_at(*this, *(f - 1), *f, t_ns);
  if (share >= 0 && share <= 2) view.undistorted_px += (share - 1) * seen.step_px.cast<double>();
  return view;
}

}  // namespace coslam
