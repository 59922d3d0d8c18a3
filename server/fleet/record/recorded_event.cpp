// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recorded_event.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/wire/codec.h"
#include "common/wire/message_octets.h"
#include "common/wire/packing.h"
#include "common/wire/reply_parts.h"

namespace coslam {
namespace {

using Json = nlohmann::ordered_json;
using Octets = std::vector<std::uint8_t>;

// Of both clocks; so sums with the times of records stay in range.
constexpr TimeNs kFarthest_ns = 4'000'000'000'000'000'000;  // the year 2096

// The coarsest grid that all coordinates of a frame are on, as a scale of the wire. It need not be that of the agent's
// camera: what is equal on one grid is equal.
double exact_px_scale(const TrackFrame& frame) {
  double scale = 0.5;
  const auto refine = [&scale](const Eigen::Vector2f& px) {
    for (const double v : {static_cast<double>(px.x()), static_cast<double>(px.y())}) {
      while (scale < 1024 && v * scale != std::nearbyint(v * scale)) scale *= 2;
    }
  };
  for (const TrackObservation& t : frame.tracks) refine(t.undistorted_px);
  for (const TagObservation& t : frame.tags) std::ranges::for_each(t.undistorted_px, refine);
  return scale;
}

template <class Reply>
auto messages_of(const Reply& reply) {
  std::vector<decltype(encode(reply))> messages;
  for (const Reply& part : in_parts(reply)) messages.push_back(encode(part));
  return messages;
}

class PayloadWriter {
 public:
  template <class Message>
  void put_message(const Message& message) {
    const Octets octets = octets_of(message);
    packer_.put(static_cast<std::uint32_t>(octets.size()));
    put(octets);
  }
  // As many messages as it takes, their number before them; none for none.
  template <class Reply>
  void put_reply(const std::optional<Reply>& reply) {
    const auto messages = reply ? messages_of(*reply) : decltype(messages_of(*reply)){};
    packer_.put(static_cast<std::uint16_t>(messages.size()));
    for (const auto& m : messages) put_message(m);
  }
  template <class T>
  void put_number(T value) {
    packer_.put(value);
  }
  void put(std::span<const std::uint8_t> octets) { octets_.insert(octets_.end(), octets.begin(), octets.end()); }
  Octets take() { return std::move(octets_); }

 private:
  Octets octets_;
  Packer packer_{octets_};
};

// Once something was not as it should be, ok() is false and what is read means nothing.
class PayloadReader {
 public:
  explicit PayloadReader(std::span<const std::uint8_t> octets) : octets_(octets) {}

  template <class Message>
  auto message() {
    Message message;
    ok_ = ok_ && read_octets(take(number<std::uint32_t>()), message);
    auto value = decode(message);
    ok_ = ok_ && static_cast<bool>(value);
    return ok_ ? std::move(*value) : std::remove_reference_t<decltype(*value)>{};
  }
  template <class Message>
  auto reply() {
    using Reply = decltype(message<Message>());
    std::optional<Reply> whole;
    std::vector<Reply> parts;
    const auto count = number<std::uint16_t>();
    for (std::uint16_t i = 0; ok_ && i < count; ++i) parts.push_back(message<Message>());
    if (!ok_ || parts.empty()) return whole;
    auto joined = in_one(std::move(parts));
    ok_ = static_cast<bool>(joined);
    if (ok_) whole = std::move(*joined);
    return whole;
  }
  template <class T>
  T number() {
    const auto octets = take(sizeof(T));
    return ok_ ? *Unpacker(octets).get<T>() : T{};
  }
  std::string rest() {
    const auto octets = take(octets_.size());
    return {octets.begin(), octets.end()};
  }
  void require(bool condition) { ok_ = ok_ && condition; }
  bool ok() const { return ok_; }
  bool complete() const { return ok_ && octets_.empty(); }

 private:
  std::span<const std::uint8_t> take(std::size_t size) {
    ok_ = ok_ && octets_.size() >= size;
    if (!ok_) return {};
    const auto taken = octets_.first(size);
    octets_ = octets_.subspan(size);
    return taken;
  }

  std::span<const std::uint8_t> octets_;
  bool ok_ = true;
};

void put(PayloadWriter& out, const Hello& hello) { out.put_message(encode(hello)); }
void put(PayloadWriter& out, const JoinedFrame& joined) {
  out.put_message(encode(joined.frame, exact_px_scale(joined.frame)));
  out.put_reply(joined.patches);
  out.put_reply(joined.descriptors);
}
void put(PayloadWriter& out, const AgentStatus& status) {
  out.put_number(status.exchange.arrived_ns);
  out.put_message(encode(status));
}
template <class SilentOrGone>
void put(PayloadWriter& out, const SilentOrGone& event) {
  out.put_number(event.agent_run.value);
  out.put({reinterpret_cast<const std::uint8_t*>(event.agent.data()), event.agent.size()});
}

Hello get_hello(PayloadReader& in) {
  Hello hello = in.message<idl::Hello>();
  in.require(hello.protocol == kProtocolVersion);
  return hello;
}

// A reply is of this frame, or of one before it.
template <class Reply>
bool belongs(const std::optional<Reply>& reply, const TrackFrame& to) {
  return !reply || (reply->agent == to.agent && reply->agent_run == to.agent_run && reply->frame <= to.frame);
}

JoinedFrame get_frame(PayloadReader& in) {
  JoinedFrame joined;
  joined.frame = in.message<idl::TrackFrame>();
  joined.patches = in.reply<idl::PatchReply>();
  joined.descriptors = in.reply<idl::DescriptorReply>();
  in.require(belongs(joined.patches, joined.frame) && belongs(joined.descriptors, joined.frame));
  return joined;
}

AgentStatus get_status(PayloadReader& in) {
  const auto arrived_ns = in.number<TimeNs>();
  AgentStatus status = in.message<idl::AgentStatus>();
  status.exchange.arrived_ns = arrived_ns;
  in.require(arrived_ns >= 0 && arrived_ns <= kFarthest_ns);
  return status;
}

template <class SilentOrGone>
SilentOrGone get_name(PayloadReader& in) {
  SilentOrGone event;
  event.agent_run = RunId(in.number<std::uint64_t>());
  event.agent = in.rest();
  in.require(event.agent_run.value != 0 && valid_agent_name(event.agent));
  return event;
}

RecordType type_of(const ServerEvent& event) {
  constexpr std::array kTypes{RecordType::kHello, RecordType::kFrame, RecordType::kStatus, RecordType::kSilent,
                              RecordType::kGone};
  static_assert(kTypes.size() == std::variant_size_v<ServerEvent>);
  return kTypes[event.index()];
}

Json parsed_head(const Record& record) {
  constexpr int kDeepest = 12;  // configurations are less deep
  const auto keep = [](int depth, Json::parse_event_t, const Json&) { return depth <= kDeepest; };
  if (record.type != RecordType::kHead) return {};
  return Json::parse(record.payload.begin(), record.payload.end(), keep, false);
}

// The number under a key, 0 without one.
template <class T>
T number_at(const Json& json, const char* key) {
  const auto at = json.find(key);
  return at != json.end() && at->is_number_integer() ? at->template get<T>() : T{};
}

}  // namespace

Record encode_head(const RecordingHead& head) {
  const Json json{{"coslam", head.version}, {"protocol", kProtocolVersion},      {"server_run", head.server_run.value},
                  {"utc_ns", head.utc_ns},  {"monotonic_ns", head.monotonic_ns}, {"configuration", head.configuration}};
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  return {RecordType::kHead, 0, {text.begin(), text.end()}};
}

Record encode_event(const ServerEvent& event, TimeNs t_ns) {
  PayloadWriter out;
  std::visit([&out](const auto& e) { put(out, e); }, event);
  return {type_of(event), t_ns, out.take()};
}

std::optional<std::string> foreign_protocol(const Record& record) {
  const Json json = parsed_head(record);
  if (!json.is_object() || !json.contains("protocol")) return std::nullopt;
  const auto protocol = number_at<std::int64_t>(json, "protocol");
  if (protocol == kProtocolVersion) return std::nullopt;
  return "has messages of protocol " + std::to_string(protocol) + ", and this program reads protocol " +
         std::to_string(kProtocolVersion);
}

std::optional<RecordingHead> decode_head(const Record& record) {
  const Json json = parsed_head(record);
  if (!json.is_object() || !json.contains("configuration") || !json["configuration"].is_object()) return std::nullopt;
  RecordingHead head;
  if (json.contains("coslam") && json["coslam"].is_string()) head.version = json["coslam"].get<std::string>();
  head.server_run = RunId(number_at<std::uint64_t>(json, "server_run"));
  head.utc_ns = number_at<TimeNs>(json, "utc_ns");
  head.monotonic_ns = number_at<TimeNs>(json, "monotonic_ns");
  head.configuration = json["configuration"];
  const auto in_range = [](TimeNs t_ns) { return t_ns >= 0 && t_ns <= kFarthest_ns; };
  if (head.server_run.value == 0 || !in_range(head.utc_ns) || !in_range(head.monotonic_ns)) return std::nullopt;
  return head;
}

std::optional<ServerEvent> decode_event(const Record& record) {
  PayloadReader in(record.payload);
  std::optional<ServerEvent> event;
  if (record.type == RecordType::kHello) event = get_hello(in);
  if (record.type == RecordType::kFrame) event = get_frame(in);
  if (record.type == RecordType::kStatus) event = get_status(in);
  if (record.type == RecordType::kSilent) event = get_name<AgentSilent>(in);
  if (record.type == RecordType::kGone) event = get_name<AgentGone>(in);
  return in.complete() ? event : std::nullopt;
}

}  // namespace coslam
