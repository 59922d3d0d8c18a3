// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "common/wire/coded_tracks.h"
#include "common/wire/counters.h"
#include "common/wire/messages.h"

// Converts between the values of common/model and those of idl/coslam.idl. Pure functions. decode(encode(x)) == x bit
// for bit when x is what the model says it is (coordinates on the grid, ids ascending, sizes within the bounds of the
// IDL; anything else is a bug and stops the program). Decoders trust nothing: each returns a value that is safe to
// compute with, or the reason why there is none.
namespace coslam {

template <class T>
class Decoded {
 public:
  Decoded(T value) : content_(std::move(value)) {}  // NOLINT: converts by intent
  Decoded(Rejection reason) : content_(reason) {}   // NOLINT
  explicit operator bool() const { return content_.index() == 0; }
  T& operator*() { return std::get<0>(content_); }
  T* operator->() { return &std::get<0>(content_); }
  Rejection rejection() const { return std::get<1>(content_); }

 private:
  std::variant<T, Rejection> content_;
};

// px_scale: pixel_scale(camera) of the agent; it travels with the frame. Without a reference the message can be
// understood alone; see TrackEncoder for which reference to take.
idl::TrackFrame encode(const TrackFrame& frame, double px_scale, const TrackReference& reference = {});
idl::DescriptorReply encode(const DescriptorReply& reply);
idl::PatchReply encode(const PatchReply& reply);
idl::Hello encode(const Hello& hello);
idl::AgentStatus encode(const AgentStatus& status);
idl::MapPatch encode(const MapPatch& patch);
idl::MovingState encode(const MovingState& state);
idl::AgentPose encode(const AgentPose& pose);
idl::AgentImages encode(const AgentImages& images);
idl::ThumbnailRequest encode(const ThumbnailRequest& request);
idl::Thumbnail encode(const Thumbnail& thumbnail);
idl::PublicSample encode(const PublicSample& sample);
idl::ServerStatus encode(const ServerStatus& status);

// kMissingReference when the message needs another reference than this one.
Decoded<TrackFrame> decode(const idl::TrackFrame& message, const TrackReference& reference = {});
Decoded<TrackFrame> decode_header(const idl::TrackFrame& message);  // without tracks and tags, for passive readers
Decoded<DescriptorReply> decode(const idl::DescriptorReply& message);
Decoded<PatchReply> decode(const idl::PatchReply& message);
Decoded<Hello> decode(const idl::Hello& message);  // accepts any protocol version, see Admission
Decoded<AgentStatus> decode(const idl::AgentStatus& message);
Decoded<MapPatch> decode(const idl::MapPatch& message);
Decoded<MovingState> decode(const idl::MovingState& message);
Decoded<AgentPose> decode(const idl::AgentPose& message);
Decoded<AgentImages> decode(const idl::AgentImages& message);
Decoded<ThumbnailRequest> decode(const idl::ThumbnailRequest& message);
Decoded<Thumbnail> decode(const idl::Thumbnail& message);
Decoded<PublicSample> decode(const idl::PublicSample& message);
Decoded<ServerStatus> decode(const idl::ServerStatus& message);

// 1 to 32 letters, digits, '_', '-', '.', not starting with '.': names of agents are also names of files.
bool valid_agent_name(std::string_view name);

template <class... Types>
constexpr bool each_has_a_decoder(const std::tuple<Types...>&) {
  return (std::is_same_v<decltype(decode(std::declval<const typename Types::Message&>())),
                         Decoded<typename Types::Value>> &&
          ...);
}
static_assert(each_has_a_decoder(kMessageTypes), "a type of message lacks its codec");

}  // namespace coslam
