// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/bridge/bridge.h"

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/flow/clock.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/messages.h"
#include "common/ros/type.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "common/wire/ros_domain.h"
#include "server/show/bridge/ros_topics.h"

namespace coslam {
namespace {

constexpr const char* kName = "coslam-bridge";
constexpr std::chrono::milliseconds kTick{500};
constexpr std::chrono::seconds kPatience{5};

// As ROS spells it: /uav_1/fmu/in/vehicle_visual_odometry.
bool is_topic(const std::string& name) {
  char before = 0;
  for (const char c : name) {
    const bool digit = c >= '0' && c <= '9';
    const bool letter = c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (before == 0 ? c != '/' : before == '/' ? !letter : !(letter || digit || c == '/')) return false;
    before = c;
  }
  return before != 0 && before != '/';
}

const BridgeOptions& checked(const BridgeOptions& options) {
  if (options.bridge.domain == options.wire.domain) {
    throw UserError("DDS domain " + std::to_string(options.wire.domain) +
                    " is that of the fleet and of ROS 2: give one of them another with --from or --domain");
  }
  const Px4Config& px4 = options.bridge.px4;
  if (!px4.agent.empty() && !valid_agent_name(px4.agent)) {
    throw UserError("bridge.px4.agent: '" + px4.agent +
                    "' is no name of an agent: up to 32 letters, digits, '_', '-' and '.'");
  }
  if (!is_topic(px4.topic)) {
    throw UserError("bridge.px4.topic: '" + px4.topic +
                    "' is no topic of ROS: it begins with '/' and has letters, digits, '_' and '/'");
  }
  const MapLevel& level = options.bridge.map;
  if (level.down_x == 0 && level.down_y == 0 && level.down_z == 0) {
    throw UserError(
        "bridge.map: down_x, down_y and down_z are all 0, which is no direction: 0 1 0 is a level camera's");
  }
  return options;
}

// The map in axes that point ahead, left and up, for whoever draws or plans in them.
PublicSample upright_map(const MapLevel& level) {
  const Rigid3 world_from_map(flu_from_map(level), Eigen::Vector3d::Zero());
  const ros::TFMessage message{{{ros::header_of(0, "world"), "map", ros::transform_of(world_from_map)}}};
  return {"/tf_static", ros::type_text<ros::TFMessage>().name, 0, ros::to_cdr(message)};
}

// Says when that changes, not each time.
class Px4Log {
 public:
  void say(const std::string& agent, std::optional<Px4Refusal> refused) {
    if (reported_ && *reported_ == refused) return;
    reported_ = refused;
    if (refused) {
      log_warn("PX4 gets no pose of " + agent + ": " + sentence_of(*refused));
    } else {
      log_info("PX4 gets the poses of " + agent);
    }
  }

 private:
  std::optional<std::optional<Px4Refusal>> reported_;
};

}  // namespace

struct Bridge::Impl {
  explicit Impl(const BridgeOptions& options)
      : fleet_domain(checked(options).wire.domain),
        ros(ros_wire(options.bridge.domain, options.bridge.interfaces), kName),
        topics(ros),
        fleet(options.wire, kName),
        loop(fleet, kName, kTick, [this] { tick(); }) {
    loop.read<idl::PublicSample>([this](const idl::PublicSample& message, const Sample&) {
      if (auto sample = decode(message)) topics.put(*sample);
    });
    loop.read<idl::ServerStatus>([](const idl::ServerStatus&, const Sample&) {},
                                 [this](const WriterId&, Presence presence) { note(presence); });
    topics.put(upright_map(options.bridge.map));
    if (!options.bridge.px4.agent.empty()) read_agent(options.bridge);
    loop.start();
  }

  void read_agent(const BridgeConfig& config) {
    px4.emplace(config.px4, config.map);
    const auto topic = ros_topic(config.px4.topic, ros::type_text<ros::VehicleOdometry>().name);
    if (!topic)
      throw UserError("bridge.px4.topic '" + config.px4.topic + "' is no name of a topic: it starts with '/'");
    px4_writer = std::make_unique<OctetWriter>(ros, *topic);
    loop.read<idl::AgentPose>([this](const idl::AgentPose& message, const Sample&) {
      if (auto pose = decode(message)) px4->see(*pose);
    });
    loop.read<idl::TrackFrame>([this](const idl::TrackFrame& message, const Sample&) {
      auto frame = decode_header(message);
      if (frame && frame->agent == px4->agent()) tell_px4(*frame);
    });
  }

  void tell_px4(const TrackFrame& frame) {
    const Px4Odometry::Answer answer = px4->on_frame(frame, time_of_day_ns());
    px4_log.say(frame.agent, answer.refused);
    if (answer.odometry) px4_writer->write(ros::to_cdr(*answer.odometry));
  }

  void note(Presence presence) {
    const bool is_alive = presence == Presence::kAlive;
    if (is_alive != server_here)
      log_info(is_alive ? "the map server is there" : "the map server is silent; waiting for it");
    server_here = is_alive;
  }

  void tick() {
    if (server_here || std::chrono::steady_clock::now() - last_report < kPatience) return;
    last_report = std::chrono::steady_clock::now();
    log_info("waiting for a map server in domain " + std::to_string(fleet_domain));
  }

  const int fleet_domain;
  bool server_here = false;
  std::chrono::steady_clock::time_point last_report = std::chrono::steady_clock::now();
  Participant ros;
  RosTopics topics;
  std::optional<Px4Odometry> px4;
  std::unique_ptr<OctetWriter> px4_writer;
  Px4Log px4_log;
  Participant fleet;
  Loop loop;  // last: stops first
};

Bridge::Bridge(const BridgeOptions& options) : impl_(std::make_unique<Impl>(options)) {}

Bridge::~Bridge() = default;

}  // namespace coslam
