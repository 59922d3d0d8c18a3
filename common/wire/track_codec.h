// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "common/wire/codec.h"
#include "common/wire/track_bits.h"

// Frames of one agent run, coded against earlier ones that both ends hold. What arrives is equal to the bit with and
// without a reference, so only the number of bytes depends on what was acknowledged.
namespace coslam {

// The tracks of the last frames, which later ones are coded against. Thread-compatible.
class FrameMemory {
 public:
  static constexpr std::size_t kFrames = 64;

  struct Entry {
    FrameId frame;
    TimeNs capture_ns = 0;
    CodedTracks tracks;
  };

  void add(const TrackFrame& frame, double px_scale);
  const Entry* find(FrameId frame) const;

 private:
  std::deque<Entry> entries_;  // in the order they were added
};

// The agent's end. Thread-compatible.
class TrackEncoder {
 public:
  // Ages of the reference frame, reached on a link where much waits. Above the first, one frame in eight is coded
  // alone, because the server may have lost its references without anybody knowing; above the second every frame is.
  static constexpr TimeNs kOldReference_ns = 1'000'000'000, kOldestReference_ns = 4'000'000'000;

  explicit TrackEncoder(double px_scale) : px_scale_(px_scale) {}

  // `acknowledged`: the newest frame that the present server has answered, if any.
  idl::TrackFrame encode(const TrackFrame& frame, std::optional<FrameId> acknowledged);
  // Encodes the frame once more without a reference.
  idl::TrackFrame encode_alone(const TrackFrame& frame) const { return coslam::encode(frame, px_scale_); }

 private:
  const FrameMemory::Entry* reference_for(const TrackFrame& frame, std::optional<FrameId> acknowledged) const;

  const double px_scale_;
  FrameMemory sent_;
  int since_alone_ = 0;  // frames
};

// The server's end, for one agent run. A frame that an encoder may refer to is always in reach: of those that were sent
// since, the server decoded no more. Thread-compatible.
class TrackDecoder {
 public:
  Decoded<TrackFrame> decode(const idl::TrackFrame& message);

 private:
  FrameMemory decoded_;
};

}  // namespace coslam
