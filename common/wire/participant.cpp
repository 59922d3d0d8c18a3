// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/participant.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/wire/participant_impl.h"
#include "common/wire/qos.h"

#include <algorithm>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>

#include "common/base/check.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/base/words.h"
#include "common/wire/addresses.h"
#include "common/wire/guard.h"
#include "common/wire/middleware_log.h"
#include "common/wire/peer_names.h"
#include "common/wire/ports.h"
#include "common/wire/serialisers.h"

#if defined(__SANITIZE_ADDRESS__)
// The middleware deletes a reader's statistics through a base without virtual destructor; nothing of ours does.
extern "C" const char* __asan_default_options() { return "new_delete_type_mismatch=0"; }
#endif

namespace coslam {
namespace {

// Per datagram, as seen on the wire: IPv4 20 and UDP 8; RTPS header 20, INFO_DST 16, INFO_TS 12, the header of DATA 24
// or DATA_FRAG 36, and 60 of the statistics that Debian's build appends. Heartbeats and acknowledgements are not
// counted: with frames of 300 tracks they add less than 2 %.
constexpr std::uint64_t kDatagramOverhead = 20 + 8 + 20 + 16 + 12 + 24 + 60;
constexpr std::uint64_t kFragmentOverhead = kDatagramOverhead + 12;
constexpr std::uint64_t kReserved = 176;  // what the middleware keeps free of max_message_bytes for headers

WireConfig with_addresses(WireConfig config) {
  std::vector<std::string> peers;
  for (const std::string& peer : config.peers) {
    for (std::string& address : addresses_of_peer(peer)) peers.push_back(std::move(address));
  }
  config.peers = std::move(peers);
  return config;
}

void require_addresses(const WireConfig& c) {
  const std::vector<std::string> local = local_addresses();
  if (local.empty() && !c.interfaces.empty()) {
    throw UserError(
        "no network interface of this machine is up, not even the loopback device, which `ip link set lo up` starts; "
        "coslam run --inline needs none");
  }
  const auto foreign = std::ranges::find_if(
      c.interfaces, [&](const std::string& address) { return std::ranges::find(local, address) == local.end(); });
  if (foreign != c.interfaces.end()) {
    throw UserError("network interface '" + *foreign + "' is not an IPv4 address of this machine (it has " +
                    joined(local) + ")");
  }
}

void require_certificates(const std::string& directory) {
  if (directory.empty()) return;
  for (const char* name : {"ca.pem", "cert.pem", "key.pem", "governance.p7s", "permissions.p7s"}) {
    const std::filesystem::path file = std::filesystem::path(directory) / name;
    if (!std::filesystem::is_regular_file(file)) throw UserError("certificate file '" + file.string() + "' is missing");
  }
}

bool port_is_free(int port) {
  const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool free = bind(udp, reinterpret_cast<const sockaddr*>(&any), sizeof(any)) == 0;
  close(udp);
  return free;
}

// Numbers of the participants in this process, of whatever domain: the middleware takes each once. One is chosen at a
// time, or two threads would choose the same.
struct ParticipantIds {
  std::mutex mutex;
  std::set<int> used;
};
ParticipantIds& participant_ids() {
  static ParticipantIds ids;
  return ids;
}

// The number whose pair of ports is free. When there is none the middleware would say nothing and hear nothing; and
// left alone, it counts up within a process until peers cannot find it.
int free_participant_id(int domain, const std::set<int>& used) {
  for (int id = 0; id < kMostPerHost; ++id) {
    if (used.contains(id)) continue;
    if (port_is_free(unicast_port(domain, id)) && port_is_free(unicast_port(domain, id) + 1)) return id;
  }
  throw UserError("no UDP port is free for DDS domain " + std::to_string(domain) + " (" +
                  std::to_string(unicast_port(domain, 0)) + " to " +
                  std::to_string(unicast_port(domain, kMostPerHost) - 1) + "): choose another domain");
}

void require_usable(const WireConfig& c) {
  if (c.domain < 0 || c.domain > kMostDomain) {
    throw UserError("DDS domain " + std::to_string(c.domain) + " is outside the range 0 to " +
                    std::to_string(kMostDomain));
  }
  if (c.max_message_bytes < 512 || c.max_message_bytes > kMostMessageBytes) {
    throw UserError("max_message_bytes " + std::to_string(c.max_message_bytes) + " is outside the range 512 to " +
                    std::to_string(kMostMessageBytes));
  }
  require_addresses(c);
  require_certificates(c.certificates);
}

void warn_when_open(const WireConfig& c) {
  const auto is_loopback = [](const std::string& address) { return address.starts_with("127."); };
  const bool alone = !c.interfaces.empty() && std::ranges::all_of(c.interfaces, is_loopback);
  if (alone || !c.key_file.empty() || !c.certificates.empty()) return;
  log_warn("no key: whoever can send datagrams to DDS domain " + std::to_string(c.domain) +
           " can join it, read it and stop this process; set wire.key_file, see docs/security.md");
}

// The middleware obeys variables that are meant for the ROS 2 nodes beside: with a discovery server named there a fleet
// never meets. Where this process talks is said in its own settings alone.
void ignore_environment() {
  for (const char* name : kIgnoredVariables) {
    if (std::getenv(name) == nullptr) continue;
    unsetenv(name);
    log_warn(std::string("the variable ") + name + " of the environment is ignored: see wire in the configuration");
  }
}

}  // namespace

dds::Topic* Participant::Impl::topic(std::size_t index) {
  const std::lock_guard lock(topics_mutex);
  const char* name = kTopics[index].name;
  if (dds::TopicDescription* known = participant->lookup_topicdescription(name)) {
    return static_cast<dds::Topic*>(known);
  }
  const dds::TypeSupport type(make_serialiser(index, *rejections));
  type.register_type(participant);
  return participant->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
}

const char* middleware_version() { return kMiddlewareVersion; }

WireConfig loopback_config(int domain) {
  WireConfig config;
  config.domain = domain;
  config.interfaces = {"127.0.0.1"};
  config.peers = {"127.0.0.1"};
  config.peer_range = kMostPerHost;
  config.bulk_bytes_per_s = 0;
  return config;
}

std::string partition_of(RunId agent_run) { return "run-" + format_hex(agent_run.value); }

std::uint64_t link_bytes(std::size_t sample_bytes, int max_message_bytes, bool with_key) {
  const std::uint64_t seal = with_key ? kSealBytes : 0;
  const std::uint64_t room = static_cast<std::uint64_t>(max_message_bytes) - kReserved - seal;
  if (sample_bytes <= room) return sample_bytes + kDatagramOverhead + seal;
  return sample_bytes + (sample_bytes + room - 1) / room * (kFragmentOverhead + seal);
}

Participant::Participant(const WireConfig& config, const std::string& name, std::shared_ptr<RejectionCounts> rejections)
    : impl_(std::make_unique<Impl>()) {
  require_usable(config);
  impl_->config = with_addresses(config);
  impl_->rejections = std::move(rejections);
  warn_when_open(config);
  capture_middleware_log();
  turn_off_intraprocess();  // so that tests within one process are true
  ParticipantIds& ids = participant_ids();
  const std::lock_guard lock(ids.mutex);
  ignore_environment();
  dds::DomainParticipantQos qos = participant_qos(impl_->config, name, *impl_->rejections, impl_->paths);
  const int id = free_participant_id(config.domain, ids.used);
  qos.wire_protocol().participant_id = id;
  ErrorWatch errors;
  auto* factory = dds::DomainParticipantFactory::get_instance();
  impl_->participant = factory->create_participant(static_cast<dds::DomainId_t>(config.domain), qos, impl_.get(),
                                                   dds::StatusMask::none());
  if (impl_->participant != nullptr) {
    impl_->id = id;
    impl_->paths.set_own(participant_key(impl_->participant->guid()));
    ids.used.insert(id);
    return;
  }
  const std::string with_certificates =
      config.certificates.empty() ? "" : " with the certificates in '" + config.certificates + "'";
  throw UserError("cannot join DDS domain " + std::to_string(config.domain) + with_certificates + ": " +
                  errors.first());
}

Participant::~Participant() {
  if (impl_->participant == nullptr) return;
  impl_->participant->set_listener(nullptr);
  impl_->participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(impl_->participant);
  const std::lock_guard lock(participant_ids().mutex);
  participant_ids().used.erase(impl_->id);
}

std::vector<std::string> Participant::others() const {
  const std::lock_guard lock(impl_->others_mutex);
  std::vector<std::string> names;
  for (const auto& [guid, other] : impl_->others) names.push_back(other.name);
  return names;
}

std::vector<std::string> Participant::addresses_of_others() const {
  const std::lock_guard lock(impl_->others_mutex);
  std::set<std::string> addresses;
  for (const auto& [guid, other] : impl_->others) addresses.insert(other.addresses.begin(), other.addresses.end());
  return {addresses.begin(), addresses.end()};
}

std::vector<OfferedTopic> Participant::offered() const {
  const std::lock_guard lock(impl_->others_mutex);
  std::set<OfferedTopic> offered;
  for (const auto& [guid, topic] : impl_->offered) offered.insert(topic);
  return {offered.begin(), offered.end()};
}

RejectionCounts& Participant::rejections() const { return *impl_->rejections; }

void Participant::give_up() { impl_->given_up = true; }

const WireConfig& Participant::config() const { return impl_->config; }

std::array<TopicCounts, kTopicCount> Participant::counts() const {
  std::array<TopicCounts, kTopicCount> counts;
  for (std::size_t i = 0; i < kTopicCount; ++i) {
    const Impl::Counts& c = impl_->counts[i];
    counts[i] = {c.sent, c.sent_bytes, c.received, c.received_bytes};
  }
  return counts;
}

}  // namespace coslam
