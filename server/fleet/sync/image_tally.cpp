// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/image_tally.h"

#include <algorithm>
#include <utility>

namespace coslam {
namespace {

std::uint64_t less(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : 0; }

}  // namespace

ImageTally::Said ImageTally::total() const {
  return {before_.sent + less(newest_.sent, base_.sent), before_.not_sent + less(newest_.not_sent, base_.not_sent),
          before_.left_out + less(newest_.left_out, base_.left_out)};
}

void ImageTally::begin(bool heard_of) {
  before_ = total();
  newest_ = base_ = {};
  base_open_ = heard_of;
}

void ImageTally::heard(const AgentStatus& status) {
  newest_ = {status.frames, status.dropped, status.left_out};
  if (std::exchange(base_open_, false)) base_ = newest_;
  arrived_then_ = arrived_;
}

std::uint64_t ImageTally::undecided() const {
  return less(arrived_, late_ + out_of_time_ + set_left_out_ + frames_used());
}

ImageAccount ImageTally::without_used(std::uint64_t arrived) const {
  const Said all = total();
  ImageAccount out;
  out[ImageFate::kLeftOut] = all.left_out;
  out[ImageFate::kNotSent] = all.not_sent;
  out[ImageFate::kLost] = less(all.sent, arrived);
  out[ImageFate::kLate] = late_;
  out[ImageFate::kOutOfTime] = out_of_time_;
  out[ImageFate::kSetLeftOut] = set_left_out_;
  return out;
}

ImageAccount ImageTally::so_far() const {
  ImageAccount out = without_used(arrived_then_);
  out[ImageFate::kTracked] = posed_;
  out[ImageFate::kWithoutPose] = unposed_;
  return out;
}

ImageAccount ImageTally::at_end(std::uint64_t tracked, std::uint64_t in_other_maps) const {
  ImageAccount out = without_used(arrived_);
  out[ImageFate::kTracked] = std::min(tracked, frames_used());
  out[ImageFate::kInOtherMaps] = std::min(in_other_maps, frames_used() - out[ImageFate::kTracked]);
  out[ImageFate::kWithoutPose] = frames_used() - out[ImageFate::kTracked] - out[ImageFate::kInOtherMaps];
  out[ImageFate::kSetLeftOut] += undecided();
  return out;
}

}  // namespace coslam
