// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>

#include "common/base/time.h"
#include "common/wire/announcement.h"
#include "common/wire/echo.h"
#include "deploy/coslam/doctor/fleet.h"

namespace coslam::doctor {

// Makes facts of what was asked and what was heard. Pure: time is an argument. Thread-compatible.
class Hearing {
 public:
  enum class Way : std::uint8_t { kBack, kToPort, kMulticast };

  explicit Hearing(FleetFacts& facts) : facts_(facts) {}

  // The number of a question that is sent now; it stands for one endpoint, or for all.
  std::uint64_t ask(Way way, const Ipv4Endpoint& to, Instant now);
  void announced(const Announcement& announcement, std::uint32_t from, Seal seal, bool by_multicast);
  // utc_ns: of this host.
  void answered(const EchoAnswer& answer, std::uint32_t from, Seal seal, Instant now, TimeNs utc_ns);
  bool is_own(const EchoRequest& request) const { return questions_.contains(request.number); }
  // A host of that address was called by its name: it is asked at this endpoint, whoever is there.
  void call(const Ipv4Endpoint& endpoint);
  void undelivered(const Ipv4Endpoint& to, int error);

  // All endpoints that are to be asked, of participants and of hosts that were called.
  std::vector<Ipv4Endpoint> endpoints() const;
  // Whether nothing came from there yet.
  bool is_silent(const Ipv4Endpoint& endpoint) const;

 private:
  struct Question {
    Way way = Way::kBack;
    Ipv4Endpoint to;
    Instant sent;
  };

  Voice& voice_of(const Announcement& announcement);
  Road* road_to(const Ipv4Endpoint& endpoint);
  Voice& voice_at(const Ipv4Endpoint& endpoint, const std::string& name, std::uint32_t from);
  void note_error(std::uint32_t address, std::optional<int> error);

  FleetFacts& facts_;
  std::map<std::uint64_t, Question> questions_;
  std::map<ParticipantKey, std::size_t> voice_of_;
  std::map<Ipv4Endpoint, Road> called_;  // addresses where nobody is known yet
};

}  // namespace coslam::doctor
