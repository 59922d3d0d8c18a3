// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/hearing.h"

#include <algorithm>
#include <cerrno>
#include <chrono>

namespace coslam::doctor {
namespace {

// Of a host with many addresses (containers, VPNs) some are asked.
constexpr std::size_t kMostRoads = 8;

double seconds(Instant from, Instant to) { return std::chrono::duration<double>(to - from).count(); }

}  // namespace

std::uint64_t Hearing::ask(Way way, const Ipv4Endpoint& to, Instant now) {
  const std::uint64_t number = questions_.size() + 1;
  questions_[number] = {way, to, now};
  if (way == Way::kMulticast) return number;
  Road* road = road_to(to);
  if (road == nullptr) road = &called_[to];
  ++(way == Way::kBack ? road->asked : road->asked_for_port);
  return number;
}

void Hearing::announced(const Announcement& announcement, std::uint32_t from, Seal seal, bool by_multicast) {
  Voice& voice = voice_of(announcement);
  voice.announced = true;
  voice.by_multicast |= by_multicast;
  voice.name = announcement.name;
  voice.address = from;
  voice.seal = seal;
  for (const Ipv4Endpoint& endpoint : announcement.endpoints) {
    if (voice.roads.size() == kMostRoads) break;
    if (std::ranges::find(voice.roads, endpoint, &Road::to) != voice.roads.end()) continue;
    const auto called = called_.find(endpoint);
    voice.roads.push_back(called == called_.end() ? Road{.to = endpoint} : called->second);
    voice.roads.back().to = endpoint;
    if (called != called_.end()) called_.erase(called);
  }
}

void Hearing::answered(const EchoAnswer& answer, std::uint32_t from, Seal seal, Instant now, TimeNs utc_ns) {
  const auto found = questions_.find(answer.number);
  if (found == questions_.end()) return;
  const Question& question = found->second;
  note_error(from, std::nullopt);
  if (question.way == Way::kMulticast) {
    for (Voice& voice : facts_.voices) {
      if (voice.address != from || voice.name != answer.name) continue;
      voice.heard_ours = true;
      voice.protocol = answer.protocol;
    }
    return;
  }
  Voice& voice = voice_at(question.to, answer.name, from);
  voice.protocol = answer.protocol;
  voice.seal = seal;
  Road& road = *road_to(question.to);
  ++(question.way == Way::kBack ? road.answered : road.answered_at_port);
  const double took_s = seconds(question.sent, now);
  if (road.all_answered() > 1 && 1e3 * took_s >= road.least_ms) return;
  road.least_ms = 1e3 * took_s;
  road.clock_ahead_s = to_seconds(answer.answered_ns - utc_ns) + took_s / 2;
}

void Hearing::call(const Ipv4Endpoint& endpoint) {
  if (road_to(endpoint) == nullptr) called_[endpoint].to = endpoint;
}

void Hearing::undelivered(const Ipv4Endpoint& to, int error) {
  const bool anybody =
      std::ranges::any_of(facts_.voices, [&](const Voice& voice) { return voice.address == to.address; });
  // Whoever runs alone on a host has the lowest port: that a higher one is closed tells nothing.
  const auto lowest = called_.lower_bound({to.address, 0});
  const bool tells = error != ECONNREFUSED || (lowest != called_.end() && lowest->first == to);
  if (!anybody && tells) note_error(to.address, error);
}

std::vector<Ipv4Endpoint> Hearing::endpoints() const {
  std::vector<Ipv4Endpoint> all;
  for (const Voice& voice : facts_.voices) {
    for (const Road& road : voice.roads) all.push_back(road.to);
  }
  for (const auto& [endpoint, road] : called_) all.push_back(endpoint);
  return all;
}

bool Hearing::is_silent(const Ipv4Endpoint& endpoint) const {
  for (const Voice& voice : facts_.voices) {
    for (const Road& road : voice.roads) {
      if (road.to == endpoint) return road.all_answered() == 0;
    }
  }
  return true;
}

// One that answered before it was heard has no key yet.
Voice& Hearing::voice_of(const Announcement& announcement) {
  const auto known = voice_of_.find(announcement.key);
  if (known != voice_of_.end()) return facts_.voices[known->second];
  const auto is_its = [&](const Road& road) {
    return std::ranges::find(announcement.endpoints, road.to) != announcement.endpoints.end();
  };
  auto at = std::ranges::find_if(facts_.voices, [&](const Voice& v) { return std::ranges::any_of(v.roads, is_its); });
  if (at == facts_.voices.end()) at = facts_.voices.insert(at, Voice());
  voice_of_[announcement.key] = static_cast<std::size_t>(at - facts_.voices.begin());
  return *at;
}

Road* Hearing::road_to(const Ipv4Endpoint& endpoint) {
  for (Voice& voice : facts_.voices) {
    const auto road = std::ranges::find(voice.roads, endpoint, &Road::to);
    if (road != voice.roads.end()) return &*road;
  }
  return nullptr;
}

// The participant that answered there: one that was called, if nobody is known there.
Voice& Hearing::voice_at(const Ipv4Endpoint& endpoint, const std::string& name, std::uint32_t from) {
  for (Voice& voice : facts_.voices) {
    if (std::ranges::find(voice.roads, endpoint, &Road::to) != voice.roads.end()) return voice;
  }
  Voice voice{.name = name, .address = from};
  voice.roads.push_back(called_[endpoint]);
  voice.roads.back().to = endpoint;
  called_.erase(endpoint);
  return facts_.voices.emplace_back(std::move(voice));
}

// None: somebody of the fleet answered.
void Hearing::note_error(std::uint32_t address, std::optional<int> error) {
  for (Called& called : facts_.called) {
    if (std::ranges::find(called.addresses, address) == called.addresses.end()) continue;
    if (error) {
      called.error = error;
    } else {
      called.heard = true;
    }
  }
}

}  // namespace coslam::doctor
