// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/base/ids.h"
#include "idl/coslam.h"

namespace coslam {

// idl/README.md has the same table in words.
enum class Topic : std::uint8_t { kHello, kTracks, kPatches, kDescriptors, kAgentStatus, kMap, kMoving, kServerStatus };
constexpr std::size_t kTopicCount = 8;
constexpr std::array<const char*, kTopicCount> kTopicNames = {"coslam/hello",       "coslam/tracks", "coslam/patches",
                                                              "coslam/descriptors", "coslam/agent",  "coslam/map",
                                                              "coslam/moving",      "coslam/server"};

constexpr const char* name_of(Topic topic) { return kTopicNames[static_cast<std::size_t>(topic)]; }

// Map patches for one agent run travel in a DDS partition of their own, so that the others do not get them.
std::string partition_of(RunId agent_run);  // "run-" and 16 hex digits

// Each type of the IDL has one topic.
template <class Message>
inline constexpr Topic kTopicOf = static_cast<Topic>(kTopicCount);
template <>
inline constexpr Topic kTopicOf<idl::Hello> = Topic::kHello;
template <>
inline constexpr Topic kTopicOf<idl::TrackFrame> = Topic::kTracks;
template <>
inline constexpr Topic kTopicOf<idl::PatchReply> = Topic::kPatches;
template <>
inline constexpr Topic kTopicOf<idl::DescriptorReply> = Topic::kDescriptors;
template <>
inline constexpr Topic kTopicOf<idl::AgentStatus> = Topic::kAgentStatus;
template <>
inline constexpr Topic kTopicOf<idl::MapPatch> = Topic::kMap;
template <>
inline constexpr Topic kTopicOf<idl::MovingState> = Topic::kMoving;
template <>
inline constexpr Topic kTopicOf<idl::ServerStatus> = Topic::kServerStatus;

}  // namespace coslam
