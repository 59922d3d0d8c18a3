// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/qos.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "common/wire/guarded_transport.h"
#include "common/wire/own_host_transport.h"
#include "common/wire/ports.h"
#include "common/wire/single_path_transport.h"

namespace coslam {
namespace {

constexpr const char* kBulkFlow = "bulk";
constexpr double kPacePeriodMs = 10;
// How soon a reader learns that it missed the last sample; later where samples take their time.
constexpr double kHeartbeat_s = 0.2, kPacedHeartbeat_s = 0.5, kSoonHeartbeat_s = 0.06;
// The handshake of the security plugins must fit one datagram: 4000 bytes fail, 6000 work.
constexpr int kSecureMessageBytes = 8192;

Duration_t duration(double seconds) { return Duration_t(static_cast<long double>(seconds)); }

rtps::Locator udp(const std::string& address, std::uint32_t port) {
  rtps::Locator locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  rtps::IPLocator::setIPv4(locator, address);
  locator.port = port;
  return locator;
}

std::shared_ptr<rtps::UDPv4TransportDescriptor> carrier_of(const WireConfig& c) {
  auto udp4 = std::make_shared<rtps::UDPv4TransportDescriptor>();
  // Above the MTU (default 65500) the loss of one IP fragment loses the whole datagram: nothing large gets through.
  udp4->maxMessageSize = static_cast<std::uint32_t>(
      c.certificates.empty() ? c.max_message_bytes : std::max(c.max_message_bytes, kSecureMessageBytes));
  udp4->receiveBufferSize = c.receive_buffer_bytes;
  udp4->sendBufferSize = c.send_buffer_bytes;
  udp4->maxInitialPeersRange = static_cast<std::uint32_t>(c.peer_range);
  udp4->interfaceWhiteList = c.interfaces;
  return udp4;
}

std::shared_ptr<rtps::TransportDescriptorInterface> transport_of(const WireConfig& c, const std::string& name,
                                                                 RejectionCounts& refused, PeerPaths& paths) {
  std::shared_ptr<rtps::TransportDescriptorInterface> transport = carrier_of(c);
  if (c.own_host) return own_host_transport(transport);
  std::optional<FleetKey> key;
  if (!c.key_file.empty()) key = load_fleet_key(c.key_file, c.domain);
  if (key) transport = guarded_transport(transport, *key, refused);
  return single_path_transport(transport, paths, c.interfaces, std::make_shared<EchoAnswerer>(name, key));
}

// A period must have room for one datagram, since fragments are cut to it: slow paces get longer periods.
std::shared_ptr<rtps::FlowControllerDescriptor> pace_of(const WireConfig& c) {
  const double bytes_per_ms = 1e-3 * c.bulk_bytes_per_s;
  const double period_ms = std::ceil(std::max(kPacePeriodMs, carrier_of(c)->maxMessageSize / bytes_per_ms));
  auto flow = std::make_shared<rtps::FlowControllerDescriptor>();
  flow->name = kBulkFlow;
  flow->scheduler = rtps::FlowControllerSchedulerPolicy::FIFO;
  flow->period_ms = static_cast<std::uint64_t>(period_ms);
  flow->max_bytes_per_period = static_cast<std::int32_t>(std::lround(bytes_per_ms * period_ms));
  return flow;
}

bool paces(const WireConfig& c) { return kHasSoundFlowControllers && c.bulk_bytes_per_s > 0; }

void set_discovery(const WireConfig& c, dds::DomainParticipantQos& qos) {
  auto& builtin = qos.wire_protocol().builtin;
  // Defaults of 20 s and 3 s: a dead agent would stay for 20 s, and one lost reply would cost a late joiner 3 s.
  builtin.discovery_config.leaseDuration = duration(c.lease_s);
  builtin.discovery_config.leaseDuration_announcementperiod = duration(c.announce_s);
  // In the place of the multicast address: agents that call their server need not know each other, and what they would
  // tell each other fills a third of a narrow link.
  for (const std::string& peer : c.peers) builtin.initialPeersList.push_back(udp(peer, 0));
  if (c.also_call.empty()) return;
  if (c.peers.empty())
    builtin.initialPeersList.push_back(udp(kMulticastGroup, static_cast<std::uint32_t>(multicast_port(c.domain))));
  for (const std::string& other : c.also_call) builtin.initialPeersList.push_back(udp(other, 0));
}

void set_security(const WireConfig& c, dds::DomainParticipantQos& qos) {
  auto& properties = qos.properties().properties();
  const auto file = [&](const std::string& key, const char* name) {
    properties.emplace_back("dds.sec." + key, "file://" + c.certificates + "/" + name);
  };
  properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
  file("auth.builtin.PKI-DH.identity_ca", "ca.pem");
  file("auth.builtin.PKI-DH.identity_certificate", "cert.pem");
  file("auth.builtin.PKI-DH.private_key", "key.pem");
  properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
  file("access.builtin.Access-Permissions.permissions_ca", "ca.pem");
  file("access.builtin.Access-Permissions.governance", "governance.p7s");
  file("access.builtin.Access-Permissions.permissions", "permissions.p7s");
  properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

// What writers and readers of a topic must agree on, and what the defaults get wrong for both.
template <class Qos>
void set_common(const Topic& topic, const WireConfig& c, Qos& qos) {
  qos.reliability().kind = topic.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.reliability().max_blocking_time = duration(0.05);
  qos.durability().kind = topic.late_joiners ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  // The default is 10 instances: the 11th agent would be invisible, without any event. 0 = unlimited; all three must be
  // 0 together. Memory stays bounded by depth and the number of keys.
  qos.resource_limits().max_samples = 0;
  qos.resource_limits().max_instances = 0;
  qos.resource_limits().max_samples_per_instance = 0;
  qos.resource_limits().allocated_samples = 1;
  // Samples differ widely in size; preallocated memory refuses those above the type's nominal size.
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  // Shared memory fails silently between users and containers, and leaves files behind when a process is killed.
  qos.data_sharing().off();
  if (topic.sign_of_life) {
    // The other kinds do not work in 2.9: any living participant counts as a sign of life of all.
    qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = duration(c.silent_after_s);
  }
}

}  // namespace

dds::DomainParticipantQos participant_qos(const WireConfig& c, const std::string& name, RejectionCounts& refused,
                                          PeerPaths& paths) {
  dds::DomainParticipantQos qos;
  qos.name(name.c_str());
  // UDP only, for the reason given at data_sharing() above.
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(transport_of(c, name, refused, paths));
  // Of a peer with many addresses (containers, VPNs) all are tried: by default the fifth and later ones are not heard
  // of.
  constexpr std::size_t kMostAddresses = 64;
  qos.allocation().locators.max_unicast_locators = kMostAddresses;
  qos.transport().listen_socket_buffer_size = c.receive_buffer_bytes;
  qos.transport().send_socket_buffer_size = c.send_buffer_bytes;
  set_discovery(c, qos);
  if (paces(c)) {
    // Without a pace, lost fragments on a slow link cause more repeats than the link can carry.
    qos.flow_controllers().push_back(pace_of(c));
  }
  if (!c.certificates.empty()) set_security(c, qos);
  return qos;
}

dds::DataWriterQos writer_qos(const Topic& topic, const WireConfig& c, Repeat repeat) {
  dds::DataWriterQos qos;
  set_common(topic, c, qos);
  qos.history().depth = topic.writer_depth;
  // The caller of write() never waits for the network.
  qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
  if (topic.paced && paces(c)) qos.publish_mode().flow_controller_name = kBulkFlow;
  const double usual_s = topic.paced ? kPacedHeartbeat_s : kHeartbeat_s;
  set_heartbeat_period(qos, duration(repeat == Repeat::kSoon ? kSoonHeartbeat_s : usual_s));
  set_plain_cdr(qos);
  if (topic.sign_of_life) qos.liveliness().announcement_period = duration(0.3 * c.silent_after_s);
  return qos;
}

dds::DataReaderQos reader_qos(const Topic& topic, const WireConfig& c) {
  dds::DataReaderQos qos;
  set_common(topic, c, qos);
  qos.history().depth = topic.reader_depth;
  return qos;
}

}  // namespace coslam
