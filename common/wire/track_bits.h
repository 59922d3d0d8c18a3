// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/wire/checks.h"
#include "common/wire/coded_tracks.h"

// The list of tracks of a frame as bits, against those of an earlier frame or alone. Exact. For the codec only.
namespace coslam {

// Both ends must hold the same `reference`; empty: none. In this order, each list in a Rice code of its own:
//   which tracks of the reference are missing: their number (12 bits), then the steps between them
//   of the new ones: whether the first is above the reference (1 bit), the steps between them
//   where any are kept: eight parameters of the motion (16 bits each), what is left of x, and of y
//   where any are new: least x and y, width and height of their box (16 bits each), places in the box
std::vector<std::uint8_t> pack_tracks(const CodedTracks& tracks, const CodedTracks& reference);

// `count`: how many there are, at most idl::MAX_TRACKS.
Problem unpack_tracks(std::span<const std::uint8_t> octets, std::size_t count, const CodedTracks& reference,
                      CodedTracks& tracks);

}  // namespace coslam
