// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/foxglove.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "common/base/text.h"

namespace coslam::foxglove {
namespace {

using Json = nlohmann::json;

constexpr std::array<std::string_view, 2> kProtocols{"foxglove.sdk.v1", "foxglove.websocket.v1"};
constexpr char kMessageData = 1, kTime = 2;

template <class T>
void put(std::string& out, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) out += static_cast<char>(value >> (8 * i) & 0xff);
}

std::uint64_t stamp(TimeNs t_ns) { return static_cast<std::uint64_t>(std::max<TimeNs>(0, t_ns)); }

std::optional<std::uint32_t> id_of(const Json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto id = value.get<std::uint64_t>();
  return id <= 0xffffffff ? std::optional(static_cast<std::uint32_t>(id)) : std::nullopt;
}

std::optional<std::uint32_t> id_of(const Json& object, const char* key) {
  const auto at = object.find(key);
  return at == object.end() ? std::nullopt : id_of(*at);
}

// The list of that name; null: there is none.
const Json* list_of(const Json& object, const char* key) {
  const auto at = object.find(key);
  return at == object.end() || !at->is_array() ? nullptr : &*at;
}

bool read_subscribe(const Json& json, Request* out) {
  const Json* list = list_of(json, "subscriptions");
  if (list == nullptr) return false;
  for (const Json& item : *list) {
    if (!item.is_object()) return false;
    const auto id = id_of(item, "id"), channel = id_of(item, "channelId");
    if (!id || !channel) return false;
    out->subscribe.emplace_back(*id, *channel);
  }
  return true;
}

bool read_unsubscribe(const Json& json, Request* out) {
  const Json* list = list_of(json, "subscriptionIds");
  if (list == nullptr) return false;
  for (const Json& item : *list) {
    const auto id = id_of(item);
    if (!id) return false;
    out->unsubscribe.push_back(*id);
  }
  return true;
}

}  // namespace

std::string_view chosen_protocol(std::string_view offered) {
  const auto words = split_fields(offered, ", \t");
  for (const std::string_view supported : kProtocols) {
    if (std::ranges::find(words, supported) != words.end()) return supported;
  }
  return {};
}

std::string server_info(std::string_view session) {
  return Json{{"op", "serverInfo"},         {"name", "coslam"},
              {"capabilities", {"time"}},   {"supportedEncodings", Json::array()},
              {"metadata", Json::object()}, {"sessionId", session}}
      .dump();
}

std::string advertise(const std::vector<Advertised>& channels) {
  Json list = Json::array();
  for (const auto& [id, channel] : channels) {
    const bool cdr = channel->encoding == Encoding::kCdr;
    list.push_back({{"id", id},
                    {"topic", channel->topic},
                    {"encoding", cdr ? "cdr" : "json"},
                    {"schemaName", channel->type},
                    {"schema", channel->schema},
                    {"schemaEncoding", cdr ? "ros2msg" : "jsonschema"}});
  }
  return Json{{"op", "advertise"}, {"channels", std::move(list)}}.dump();
}

std::string status(Level level, std::string_view text) {
  return Json{{"op", "status"}, {"level", static_cast<int>(level)}, {"message", text}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

std::string message_head(SubscriptionId subscription, TimeNs t_ns) {
  std::string out(1, kMessageData);
  put(out, subscription);
  put(out, stamp(t_ns));
  return out;
}

std::string time_message(TimeNs t_ns) {
  std::string out(1, kTime);
  put(out, stamp(t_ns));
  return out;
}

std::optional<Request> parse_request(std::string_view text) {
  // Flat: what is nested deeper is none of the protocol, and could take the stack.
  constexpr int kDeepest = 4;
  bool deep = false;
  const auto keep = [&](int depth, Json::parse_event_t, const Json&) { return !(deep |= depth > kDeepest); };
  const Json json = Json::parse(text, keep, false);
  if (deep || !json.is_object()) return std::nullopt;
  const auto op = json.find("op");
  if (op == json.end() || !op->is_string()) return std::nullopt;
  Request out{.op = op->get<std::string>()};
  if (out.op == "subscribe") {
    out.kind = Request::Kind::kSubscribe;
    if (!read_subscribe(json, &out)) return std::nullopt;
  } else if (out.op == "unsubscribe") {
    out.kind = Request::Kind::kUnsubscribe;
    if (!read_unsubscribe(json, &out)) return std::nullopt;
  }
  return out;
}

}  // namespace coslam::foxglove
