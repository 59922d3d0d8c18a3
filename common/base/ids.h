// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace coslam {

// A strong id: comparable and hashable, never mixed with another kind.
template <class Tag, class Rep>
struct Id {
  Rep value{};

  constexpr Id() = default;
  constexpr explicit Id(Rep v) : value(v) {}
  friend constexpr auto operator<=>(const Id&, const Id&) = default;
};

using CameraId = Id<struct CameraTag, std::uint16_t>;  // index of an agent at the server, given in the order of names
using TrackId = Id<struct TrackTag, std::uint32_t>;    // one KLT feature; unique per agent run, never reused; 0 = none
using PointId = Id<struct PointTag, std::uint32_t>;    // map point; unique per server run; 0 = none
using ObjectId =
    Id<struct ObjectTag, std::uint32_t>;              // moving points that go together; unique per server run; 0 = none
using GroupId = Id<struct GroupTag, std::uint32_t>;   // cameras that see the same place
using MapId = Id<struct MapTag, std::uint32_t>;       // a connected map with a frame and scale of its own; 0 = none
using FrameId = Id<struct FrameTag, std::uint32_t>;   // image counter of one agent run, from 0
using SetId = Id<struct SetTag, std::uint32_t>;       // frame set counter of one server run, from 0
using MapEpoch = Id<struct EpochTag, std::uint32_t>;  // raised whenever the map moves under the agents
using TagId = Id<struct PrintedTag, std::uint16_t>;   // number of a printed tag within its family
using RunId = Id<struct RunTag, std::uint64_t>;       // drawn at random at process start; 0 = none

}  // namespace coslam

template <class Tag, class Rep>
struct std::hash<coslam::Id<Tag, Rep>> {
  std::size_t operator()(const coslam::Id<Tag, Rep>& id) const noexcept { return std::hash<Rep>{}(id.value); }
};
