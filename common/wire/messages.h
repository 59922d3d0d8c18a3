// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>

#include "common/base/ids.h"
#include "common/model/agent_images.h"
#include "common/model/agent_pose.h"
#include "common/model/map_patch.h"
#include "common/model/moving_state.h"
#include "common/model/public_sample.h"
#include "common/model/session.h"
#include "common/model/thumbnail.h"
#include "common/model/track_frame.h"
#include "idl/coslam.h"

// Every type of message, once. Topics, QoS, writers, readers, counters, what links carry and the tests that hold for
// every type follow from this list; idl/README.md tells what else a further type needs. Topics are read in this order:
// frames first, so that what an agent says about its frames does not overtake them.
namespace coslam {

enum class Way : std::uint8_t { kUp, kDown };  // up: from an agent to the server; down: from the server

// Delay until a lost sample of a reliable topic is sent again. kSoon costs two small datagrams each time, and where a
// sample that seems lost is still in a queue it makes the queue longer. The middleware cannot change it for a writer.
enum class Repeat : std::uint8_t { kUsual, kSoon };

// A topic and what it differs in from the others; qos.cpp has what they share. idl/README.md has the same in words.
struct Topic {
  const char* name = nullptr;
  Way way = Way::kUp;
  bool reliable = true;       // lost samples are sent again
  bool late_joiners = false;  // the writer keeps the newest sample for readers that come later (transient local)
  int writer_depth = 1;       // samples kept per key until sent and acknowledged; the oldest makes room
  int reader_depth = 1;       // samples kept per key until taken
  bool paced = false;         // sent no faster than WireConfig::bulk_bytes_per_s
  bool sign_of_life = false;  // the reader is told when the writer falls silent
  bool by_run = false;        // one partition an agent run, see partition_of()
};

// An entry of the list: the type of the IDL, its generated serialiser, and the value that the programs compute with.
template <class Message_, class Serialiser_, class Value_>
struct MessageType {
  using Message = Message_;
  using Serialiser = Serialiser_;
  using Value = Value_;
  Topic topic;
};

}  // namespace coslam

// In the namespace of the generated types: here `class X` declares a serialiser, whose header is heavy.
namespace coslam::idl {

inline constexpr std::tuple kMessageTypes{
    // The newest frame matters, a lost one is not missed.
    MessageType<TrackFrame, class TrackFramePubSubType, coslam::TrackFrame>{
        {.name = "coslam/tracks", .way = Way::kUp, .reliable = false, .writer_depth = 4, .reader_depth = 8}},
    // Must arrive, must not crowd out the tracks.
    MessageType<PatchReply, class PatchReplyPubSubType, coslam::PatchReply>{
        {.name = "coslam/patches", .way = Way::kUp, .writer_depth = 128, .reader_depth = 128, .paced = true}},
    // Likewise, 64 parts each at most.
    MessageType<DescriptorReply, class DescriptorReplyPubSubType, coslam::DescriptorReply>{
        {.name = "coslam/descriptors", .way = Way::kUp, .writer_depth = 256, .reader_depth = 256, .paced = true}},
    // The newest state.
    MessageType<AgentStatus, class AgentStatusPubSubType, coslam::AgentStatus>{
        {.name = "coslam/agent", .way = Way::kUp, .late_joiners = true, .reader_depth = 2}},
    // The liveliness of the writer of Hello is the agent's sign of life.
    MessageType<Hello, class HelloPubSubType, coslam::Hello>{
        {.name = "coslam/hello", .way = Way::kUp, .late_joiners = true, .reader_depth = 4, .sign_of_life = true}},
    // Every patch, in order. Not kept for late joiners: an agent that missed some asks for a snapshot. The depth is
    // about 8 s at 30 Hz; an agent that far behind needs the snapshot anyway.
    MessageType<MapPatch, class MapPatchPubSubType, coslam::MapPatch>{
        {.name = "coslam/map", .way = Way::kDown, .writer_depth = 256, .reader_depth = 256, .by_run = true}},
    // The newest state.
    MessageType<MovingState, class MovingStatePubSubType, coslam::MovingState>{
        {.name = "coslam/moving", .way = Way::kDown, .reliable = false}},
    // The newest pose.
    MessageType<AgentPose, class AgentPosePubSubType, coslam::AgentPose>{
        {.name = "coslam/pose", .way = Way::kDown, .reliable = false}},
    // The newest account.
    MessageType<AgentImages, class AgentImagesPubSubType, coslam::AgentImages>{
        {.name = "coslam/images", .way = Way::kDown, .late_joiners = true, .by_run = true}},
    // Lost ones stay lost: it is said again while somebody looks.
    MessageType<ThumbnailRequest, class ThumbnailRequestPubSubType, coslam::ThumbnailRequest>{
        {.name = "coslam/thumbnail_request", .way = Way::kDown, .reliable = false, .by_run = true}},
    // The newest image.
    MessageType<Thumbnail, class ThumbnailPubSubType, coslam::Thumbnail>{
        {.name = "coslam/thumbnail", .way = Way::kUp, .reliable = false}},
    // A few of each topic, so that none is crowded out by another.
    MessageType<PublicSample, class PublicSamplePubSubType, coslam::PublicSample>{
        {.name = "coslam/public", .way = Way::kDown, .writer_depth = 8, .reader_depth = 8}},
    // The newest state, and the server's sign of life.
    MessageType<ServerStatus, class ServerStatusPubSubType, coslam::ServerStatus>{
        {.name = "coslam/server", .way = Way::kDown, .late_joiners = true, .reader_depth = 4, .sign_of_life = true}},
};

}  // namespace coslam::idl

namespace coslam {

using idl::kMessageTypes;
constexpr std::size_t kTopicCount = std::tuple_size_v<decltype(kMessageTypes)>;

// The topics in the order of kMessageTypes.
inline constexpr std::array<Topic, kTopicCount> kTopics =
    std::apply([](const auto&... type) { return std::array{type.topic...}; }, kMessageTypes);

template <class Message, class... Types>
constexpr std::size_t index_in(const std::tuple<Types...>&) {
  std::size_t index = 0, found = sizeof...(Types);
  ((std::is_same_v<typename Types::Message, Message> ? found = index++ : index++), ...);
  return found;
}

// The topic of a message, as a place in kTopics and in whatever is counted by topic.
template <class Message>
constexpr std::size_t topic_index() {
  constexpr std::size_t kIndex = index_in<Message>(kMessageTypes);
  static_assert(kIndex < kTopicCount, "not a message: the list above lacks it");
  return kIndex;
}
template <class Message>
constexpr const Topic& topic_of() {
  return kTopics[topic_index<Message>()];
}

// Calls visit(type) with each entry of the list, in order.
template <class Visit>
constexpr void for_each_message_type(Visit visit) {
  std::apply([&](const auto&... type) { (visit(type), ...); }, kMessageTypes);
}

template <class Type, class... Types>
constexpr bool kIsOneOf = (std::is_same_v<Type, Types> || ...);

// Conditions of a topic, for SelectedTypes.
constexpr bool goes_up(const Topic& topic) { return topic.way == Way::kUp; }
constexpr bool goes_down(const Topic& topic) { return topic.way == Way::kDown; }
constexpr bool goes_to_run(const Topic& topic) { return goes_down(topic) && topic.by_run; }
constexpr bool goes_to_all(const Topic& topic) { return goes_down(topic) && !topic.by_run; }

template <bool (*kCondition)(const Topic&), class... Excluded, class... Types>
constexpr auto selected(const std::tuple<Types...>&) {
  return std::tuple_cat(std::conditional_t < kCondition(topic_of<typename Types::Message>()) &&
                            !kIsOneOf<typename Types::Value, Excluded...>,
                        std::tuple<Types>, std::tuple < >> {}...);
}
// The entries of the list whose topic meets the condition, without those of the excluded values, in order: a tuple.
template <bool (*kCondition)(const Topic&), class... Excluded>
using SelectedTypes = decltype(selected<kCondition, Excluded...>(kMessageTypes));

// Map patches for one agent run travel in a DDS partition of their own, so that the others do not get them.
std::string partition_of(RunId agent_run);  // "run-" and 16 hex digits
constexpr const char* kAllRuns = "run-*";   // for readers: the partitions of all

// Size of the serialized sample, encapsulation header included. Message: one of the list.
template <class Message>
std::size_t sample_bytes(const Message& message);

}  // namespace coslam
