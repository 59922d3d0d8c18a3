// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/fleet.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <map>

#include "common/base/text.h"
#include "common/base/words.h"
#include "common/model/session.h"
#include "common/wire/ports.h"
#include "deploy/coslam/doctor/udp.h"

namespace coslam::doctor {
namespace {

constexpr const char* kServer = "coslam-server";
constexpr const char* kAgent = "coslam-agent ";
constexpr const char* kSameKey = "scp the fleet's key to all machines, and set wire.key_file (docs/security.md)";

bool is_ours(const std::string& name) { return name.starts_with("coslam-"); }

std::string who_is(const std::string& name) {
  if (name == kServer) return "map server";
  if (name.starts_with(kAgent)) return "agent " + name.substr(std::string(kAgent).size());
  return name.empty() ? "a participant of DDS without a name" : name;
}

// The address at which it answered best, or where it speaks from.
const Road* best_of(const Voice& voice) {
  const auto best = std::ranges::max_element(voice.roads, {}, &Road::all_answered);
  return best == voice.roads.end() ? nullptr : &*best;
}

std::string at(const Voice& voice) { return text_of(voice.address); }

std::string domain_ports(int domain) {
  return std::to_string(multicast_port(domain)) + "-" + std::to_string(last_port(domain));
}

std::string let_in(int domain) {
  return "sudo nft insert rule inet filter input udp dport " + domain_ports(domain) + " accept";
}

// Who does not answer at all.
Finding judge_deaf(const Voice& voice, const FleetFacts& facts) {
  const Road* road = best_of(voice);
  const std::string destination =
      road == nullptr ? at(voice) : text_of(road->to.address) + " on UDP " + std::to_string(road->to.port);
  if (voice.heard_ours) {
    return {Grade::kFail, who_is(voice.name),
            at(voice) + ": it answers what is sent to all, but nothing that is sent to " + destination +
                ": a firewall there, or a route",
            "on " + at(voice) + ": " + let_in(facts.domain)};
  }
  return {Grade::kFail, who_is(voice.name),
          at(voice) + ": it announces itself but does not answer at " + destination +
              ": a firewall, a way that is open in one direction only, or an older version",
          "on " + at(voice) + ": " + let_in(facts.domain)};
}

std::string measured(const Voice& voice, const Road& road) {
  const double off_s = std::abs(road.clock_ahead_s);
  return at(voice) + ", protocol " + std::to_string(voice.protocol.value_or(0)) +
         (voice.seal == Seal::kOurs ? ", with the key, " : ", no key, ") + format_tenths(road.least_ms) +
         " ms there and back, " + std::to_string(road.all_answered()) + " of " + std::to_string(road.all_asked()) +
         " answered, clock " + (off_s < 0.1 ? format_tenths(1e3 * off_s) + " ms " : format_tenths(off_s) + " s ") +
         (road.clock_ahead_s < 0 ? "behind" : "ahead");
}

Finding judge_answering(const Voice& voice, const Road& road, const FleetFacts& facts) {
  constexpr double kSlow_ms = 200, kClock_s = 0.25, kMostLost = 0.1;
  Finding out{Grade::kOk, who_is(voice.name), measured(voice, road)};
  const auto say = [&](Grade grade, const std::string& problem, const std::string& mend) {
    if (grade <= out.grade) return;
    out.grade = grade;
    out.found = problem + " (" + measured(voice, road) + ")";
    out.mend = mend;
  };
  if (voice.protocol != kProtocolVersion) {
    say(Grade::kFail,
        "it speaks protocol " + std::to_string(voice.protocol.value_or(0)) + ", this machine " +
            std::to_string(kProtocolVersion),
        "install the same version on both");
  }
  if (!facts.key_file.empty() && voice.seal == Seal::kNone)
    say(Grade::kFail, "it has no key, this machine has", kSameKey);
  if (road.answered > 0 && road.asked_for_port > 2 && road.answered_at_port == 0) {
    say(Grade::kFail,
        "its answers reach this machine where they were asked for, but not on UDP " + std::to_string(facts.own_port) +
            ": a firewall on this machine",
        let_in(facts.domain));
  }
  const int asked = road.all_asked(), answered = road.all_answered();
  if (answered < (1 - kMostLost) * asked - 2) {
    say(Grade::kWarn,
        std::to_string(asked - answered) + " of " + std::to_string(asked) + " questions or answers were lost",
        "a better link; docs/field.md has what losses cost");
  }
  if (std::abs(road.clock_ahead_s) > kClock_s) {
    say(Grade::kWarn,
        "its clock is " + format_tenths(std::abs(road.clock_ahead_s)) + " s " +
            (road.clock_ahead_s > 0 ? "ahead of" : "behind") + " this machine's",
        "sudo timedatectl set-ntp true on both");
  }
  if (road.least_ms > kSlow_ms) say(Grade::kWarn, "the way is long", "docs/field.md has what delay costs");
  if (facts.called.empty() || voice.by_multicast || voice.heard_ours) return out;
  const bool alone = facts.asked_by.empty();  // nothing leads beyond this machine
  if (!alone && !facts.by_name_alone)
    say(Grade::kWarn, "no multicast passes", "wire.peers=[" + at(voice) + "] on agents");
  return out;
}

Finding judge(const Voice& voice, const FleetFacts& facts) {
  if (!is_ours(voice.name)) {
    return {Grade::kWarn, who_is(voice.name),
            at(voice) + ": no program of the fleet, in its domain " + std::to_string(facts.domain),
            "--domain N with another number on all machines of the fleet"};
  }
  if (!facts.key_file.empty() && voice.seal == Seal::kNone)
    return {Grade::kFail, who_is(voice.name), at(voice) + ": it has no key, this machine has", kSameKey};
  const Road* road = best_of(voice);
  if (road == nullptr || road->all_answered() == 0) return judge_deaf(voice, facts);
  return judge_answering(voice, *road, facts);
}

Finding judge_sealed(std::uint32_t address, const FleetFacts& facts) {
  const std::string from = text_of(address);
  if (facts.key_file.empty())
    return {Grade::kFail, "key", from + " seals its datagrams: this machine has no key", kSameKey};
  return {Grade::kFail, "key", from + " seals its datagrams with another key than " + facts.key_file, kSameKey};
}

// A host that was named and where nobody of the fleet answers.
Finding judge_silent(const Called& called, const FleetFacts& facts) {
  const std::string subject = "peer " + called.name, domain = std::to_string(facts.domain);
  if (!called.problem.empty())
    return {Grade::kFail, subject, called.problem, "getent hosts " + called.name + ", or its address instead"};
  const std::string address = text_of(called.addresses.front());
  const auto fail = [&](const std::string& found, const std::string& mend) {
    return Finding{Grade::kFail, subject, found, mend};
  };
  const std::string port = "UDP " + std::to_string(unicast_port(facts.domain, 0));
  switch (called.error.value_or(0)) {
    case ECONNREFUSED:
      return fail("nothing runs in domain " + domain + " at " + address + ": " + port + " is closed",
                  "on " + address + ": coslam-server --domain " + domain);
    case ENETUNREACH:
      return fail("there is no route to " + address, "ip route get " + address);
    case EHOSTUNREACH:
      return fail("no machine answers at " + address, "ping " + address);
    case EPERM:
    case EACCES:
      return fail("a firewall on this machine forbids to send to " + address, "sudo nft list ruleset");
    default:
      return fail("nothing comes back from " + address + " (" + port +
                      " and the next): does a program run there in domain " + domain +
                      (facts.key_file.empty() ? ", has it a key, which this machine lacks" : ", has it the same key") +
                      ", does a firewall stand between?",
                  "on " + address + ": coslam doctor --domain " + domain);
  }
}

Findings judge_multicast(const FleetFacts& facts) {
  Findings out;
  for (const Interface& i : facts.asked_by) {
    const std::string subject = "multicast " + i.name;
    if (facts.came_back.contains(i.index)) {
      out.push_back({Grade::kOk, subject, "out and back"});
    } else {
      out.push_back({facts.by_name_alone ? Grade::kWarn : Grade::kFail, subject,
                     "what is sent to " + std::string(kMulticastGroup) + " does not come back to this machine",
                     "a firewall: " + let_in(facts.domain) + ", or sudo ip route add 239.0.0.0/8 dev " + i.name});
    }
  }
  return out;
}

Findings judge_neighbours(const FleetFacts& facts, bool somebody) {
  Findings out;
  for (const Neighbour& n : facts.next_door) {
    const bool in_fleet = is_ours(n.name);
    const std::string number = std::to_string(n.domain),
                      at_address = " in domain " + number + " at " + text_of(n.address);
    const std::string found = (n.name.empty() ? "somebody who cannot be read" : who_is(n.name)) + at_address;
    if (in_fleet && !somebody) {
      out.push_back({Grade::kFail, "domain " + number, found + ", and nobody in domain " + std::to_string(facts.domain),
                     "--domain " + number});
    } else {
      out.push_back({Grade::kOk, "domain " + number, found});
    }
  }
  return out;
}

// That there is one server, and no name twice.
Findings judge_names(const FleetFacts& facts) {
  std::map<std::string, std::vector<std::string>> by_name;
  for (const Voice& voice : facts.voices) {
    if (voice.name == kServer || voice.name.starts_with(kAgent)) by_name[voice.name].push_back(at(voice));
  }
  Findings out;
  for (const auto& [name, addresses] : by_name) {
    if (addresses.size() < 2) continue;
    out.push_back({Grade::kFail, who_is(name),
                   "there are " + std::to_string(addresses.size()) + " in domain " + std::to_string(facts.domain) +
                       ", at " + addresses[0] + " and " + addresses[1],
                   name == kServer ? "stop one, or give it another --domain" : "another --id for one of them"});
  }
  if (!by_name.empty() && !by_name.contains(kServer)) {
    out.push_back({Grade::kWarn, "map server", "none is heard in domain " + std::to_string(facts.domain),
                   "coslam-server --domain " + std::to_string(facts.domain)});
  }
  return out;
}

Findings judge_silence(const FleetFacts& facts) {
  const std::string number = std::to_string(facts.domain);
  std::vector<std::string> on;
  for (const Interface& i : facts.asked_by) on.insert(on.end(), i.addresses.begin(), i.addresses.end());
  return {{Grade::kWarn, "fleet",
           "nobody is heard in domain " + number + " (listened on " + (on.empty() ? "no interface" : joined(on)) +
               "): nothing runs, or the network between carries no multicast",
           "coslam-server --domain " + number + ", or coslam doctor --domain " + number + " --peer HOST"}};
}

}  // namespace

Findings judge(const FleetFacts& facts) {
  Findings out = judge_multicast(facts);
  const auto add = [&](const Findings& more) { out.insert(out.end(), more.begin(), more.end()); };
  for (const std::uint32_t address : facts.sealed_by_others) out.push_back(judge_sealed(address, facts));
  // A fleet next door is the likelier reason for what else is missing.
  const bool somebody = std::ranges::any_of(facts.voices, [](const Voice& v) { return is_ours(v.name); });
  add(judge_neighbours(facts, somebody || !facts.sealed_by_others.empty()));
  for (const Called& called : facts.called) {
    const auto sealed = [&](std::uint32_t address) { return facts.sealed_by_others.contains(address); };
    if (!called.heard && std::ranges::none_of(called.addresses, sealed)) out.push_back(judge_silent(called, facts));
  }
  for (const Voice& voice : facts.voices) out.push_back(judge(voice, facts));
  add(judge_names(facts));
  const bool has_failure = std::ranges::any_of(out, [](const Finding& f) { return f.grade == Grade::kFail; });
  if (!somebody && !has_failure) add(judge_silence(facts));
  return out;
}

}  // namespace coslam::doctor
