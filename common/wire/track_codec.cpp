// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/track_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace coslam {

void FrameMemory::add(const TrackFrame& frame, double px_scale) {
  std::erase_if(entries_, [&](const Entry& e) { return e.frame == frame.frame; });  // sent again
  if (entries_.size() == kFrames) entries_.pop_front();
  entries_.push_back({frame.frame, frame.capture_ns, coded_tracks(frame, px_scale)});
}

const FrameMemory::Entry* FrameMemory::find(FrameId frame) const {
  const auto found = std::ranges::find(entries_, frame, &Entry::frame);
  return found == entries_.end() ? nullptr : &*found;
}

const FrameMemory::Entry* TrackEncoder::reference_for(const TrackFrame& frame,
                                                      std::optional<FrameId> acknowledged) const {
  if (!acknowledged || *acknowledged >= frame.frame) return nullptr;
  if (frame.frame.value - acknowledged->value > std::numeric_limits<std::uint16_t>::max()) return nullptr;
  const FrameMemory::Entry* entry = sent_.find(*acknowledged);
  return entry != nullptr && frame.capture_ns - entry->capture_ns <= kOldestReference_ns ? entry : nullptr;
}

idl::TrackFrame TrackEncoder::encode(const TrackFrame& frame, std::optional<FrameId> acknowledged) {
  constexpr int kAloneOneIn = 8;
  const FrameMemory::Entry* entry = reference_for(frame, acknowledged);
  ++since_alone_;
  const bool old = entry != nullptr && frame.capture_ns - entry->capture_ns > kOldReference_ns;
  if (entry == nullptr || (old && since_alone_ >= kAloneOneIn)) {
    since_alone_ = 0;
    idl::TrackFrame alone = encode_alone(frame);
    sent_.add(frame, px_scale_);
    return alone;
  }
  idl::TrackFrame message = coslam::encode(frame, px_scale_, {entry->frame, &entry->tracks});
  if (old) {
    idl::TrackFrame alone = encode_alone(frame);
    if (alone.tracks().size() <= message.tracks().size()) message = std::move(alone);
  }
  sent_.add(frame, px_scale_);
  return message;
}

Decoded<TrackFrame> TrackDecoder::decode(const idl::TrackFrame& message) {
  TrackReference reference;
  if (message.reference_age() > message.frame()) return Rejection::kOutOfRange;
  if (message.reference_age() > 0) {
    const FrameMemory::Entry* entry = decoded_.find(FrameId(message.frame() - message.reference_age()));
    if (entry != nullptr) reference = {entry->frame, &entry->tracks};
  }
  auto frame = coslam::decode(message, reference);
  if (frame) decoded_.add(*frame, std::ldexp(1.0, message.px_bits()));
  return frame;
}

}  // namespace coslam
