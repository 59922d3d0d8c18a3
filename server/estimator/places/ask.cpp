// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/ask.h"

#include <algorithm>
#include <vector>

#include "common/geometry/robust.h"

namespace coslam {
namespace {

std::uint32_t sets_since(const Map& map, const std::optional<SetId>& set) {
  return set ? map.now().value - set->value : 1U << 30U;
}

double median_depth(const Map& map, const MapCamera& camera) {
  std::vector<double> depths;
  for (const auto& [id, t] : camera.tracks) {
    const MapPoint* p = map.find(t.point);
    if (p != nullptr && p->rests()) depths.push_back((camera.frames.back().cam_from_world * p->position).z());
  }
  return upper_median(depths);
}

}  // namespace

DescriptorRequest Asking::ask(const Map& map, const MapCamera& camera, const WhyAsk& why) {
  Described& d = cameras_[camera.id];
  DescriptorRequest request = DescriptorRequest::kNone;
  const bool unplaced = camera.map == MapId();
  if (unplaced) {
    if (sets_since(map, d.asked) >= map.sets_in(soon_s(d))) request = DescriptorRequest::kEverywhere;
  } else if (camera.frames.back().valid()) {
    const bool hinted = d.hinted && sets_since(map, d.hinted) < map.sets_in(config_.least_period_s);
    const bool confirm = hinted || why.waiting >= Verification::Waiting::kExpected;
    if (wanted(map, camera, d, why, confirm) && afford(d, map.now_ns(), confirm)) {
      const bool everywhere = why.apart || hinted || why.waiting == Verification::Waiting::kAnywhere;
      request = everywhere ? DescriptorRequest::kEverywhere : DescriptorRequest::kAtTracks;
    }
  }
  if (request != DescriptorRequest::kNone) d.asked = map.now();
  return request;
}

// While an answer is on its way, on a slow link, another question brings nothing sooner.
double Asking::soon_s(const Described& d) const {
  const bool answered = !d.asked || (d.at && *d.at > *d.asked);
  return answered ? config_.soon_s : std::max(config_.soon_s, config_.least_period_s);
}

bool Asking::wanted(const Map& map, const MapCamera& camera, const Described& d, const WhyAsk& why,
                    bool confirm) const {
  const auto due = [&](double period_s) { return sets_since(map, d.asked) >= map.sets_in(period_s); };
  if (confirm || !d.at) return due(soon_s(d));
  const bool more = why.waiting == Verification::Waiting::kMore;
  if ((why.apart && !more && due(0.5 * config_.least_period_s)) || (why.expects && due(soon_s(d)))) return true;
  const double share = why.parted || more ? 0.5 : 1.0;  // of the usual change of the view, and of the usual time
  return due(share * config_.least_period_s) && view_changed(map, camera, *d.at, share);
}

// Whether the uplink has room for an image's descriptors; if so, it is counted. What is about to be confirmed may run
// into debt, as far as others may save, but not again before that is paid: what three images did not confirm, a
// fourth seldom does, and the view may have more to tell later.
bool Asking::afford(Described& d, TimeNs now_ns, bool confirm) const {
  d.images_to_spare =
      d.counted_ns
          ? std::min(config_.image_burst, d.images_to_spare + config_.images_per_s * to_seconds(now_ns - *d.counted_ns))
          : config_.image_burst;
  d.counted_ns = now_ns;
  if (d.images_to_spare >= 1) d.in_debt = false;
  const bool lend = confirm && !d.in_debt;
  if (d.images_to_spare < (lend ? 1 - config_.image_burst : 1)) {
    d.in_debt = d.in_debt || lend;
    return false;
  }
  d.images_to_spare -= 1;
  return true;
}

// By a share of what is configured.
bool Asking::view_changed(const Map& map, const MapCamera& camera, SetId earlier_set, double share) const {
  const FramePose* earlier = camera.frame_at(earlier_set);
  const FramePose& now = camera.frames.back();
  if (earlier == nullptr || earlier->map != now.map) return true;
  const double turned = earlier->cam_from_world.rotation.angularDistance(now.cam_from_world.rotation);
  const double moved = (earlier->cam_from_world.center() - now.cam_from_world.center()).norm();
  return turned > share * config_.turned_rad || moved > share * config_.moved_share * median_depth(map, camera);
}

}  // namespace coslam
