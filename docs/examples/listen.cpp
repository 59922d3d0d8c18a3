// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// listen [--domain N] [--loopback] [--key FILE]: once a second where each agent of a fleet is, and what moves.
// Any number of programs may listen; agents do not notice, and while nobody does the server sends none of this.
#include <pthread.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <map>
#include <string>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"

namespace {

// How to join the fleet's domain. All that is left out here is as agents and server have it by default.
coslam::WireConfig settings_of(int argc, char** argv) {
  coslam::WireConfig settings;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--loopback") {  // this machine alone, as `coslam run` has it
      const coslam::WireConfig loopback = coslam::loopback_config(settings.domain);
      settings.interfaces = loopback.interfaces;
      settings.peers = loopback.peers;
      settings.peer_range = loopback.peer_range;
      continue;
    }
    const std::string value = ++i < argc ? argv[i] : "";
    const auto domain = coslam::parse_integer(value);
    if (word == "--domain" && domain) {
      settings.domain = static_cast<int>(*domain);
    } else if (word == "--key" && !value.empty()) {
      settings.key_file = value;
    } else {
      throw coslam::UsageError("usage: listen [--domain N] [--loopback] [--key FILE]");
    }
  }
  return settings;
}

// The newest of each agent and of each map since it was last printed.
struct Heard {
  std::map<std::string, coslam::AgentPose> poses;
  std::map<coslam::MapId, coslam::MovingState> moving;
};

void print(const Heard& heard) {
  for (const auto& [name, pose] : heard.poses) {
    if (pose.state != coslam::PoseState::kTracked) {
      std::printf("%-12s has no pose\n", name.c_str());
      continue;
    }
    // The camera's place is where the origin of its coordinates comes to lie in the map.
    const Eigen::Vector3d& at = pose.map_from_cam.translation;
    std::printf("%-12s in map %u at %.3f %.3f %.3f %s\n", name.c_str(), pose.map.value, at.x(), at.y(), at.z(),
                pose.scale_known ? "m" : "units");
  }
  for (const auto& [map, state] : heard.moving) {
    for (const coslam::MovingObjectState& object : state.objects) {
      const Eigen::Vector3f& at = object.centroid;
      std::printf("object %-5u in map %u at %.3f %.3f %.3f %s, %.2f a second\n", object.object.value, map.value, at.x(),
                  at.y(), at.z(), state.scale_known ? "m" : "units", object.velocity_per_s.norm());
    }
  }
  std::fflush(stdout);
}

void listen(const coslam::WireConfig& settings) {
  // Ctrl-C is waited for at the end; the threads that are made from here on leave it alone.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  Heard heard;
  coslam::Participant participant(settings, "listen");  // throws when a setting is wrong
  // One thread, that of the loop, calls all these functions, so there is no lock.
  coslam::Loop loop(participant, "listen", std::chrono::seconds(1), [&] {
    print(heard);
    heard = {};
  });
  // What comes from the network is checked while it is decoded: nonsense gives nothing.
  loop.read<coslam::idl::AgentPose>([&](const coslam::idl::AgentPose& message, const coslam::Sample&) {
    if (auto pose = coslam::decode(message)) heard.poses[pose->agent] = *pose;
  });
  loop.read<coslam::idl::MovingState>([&](const coslam::idl::MovingState& message, const coslam::Sample&) {
    if (auto state = coslam::decode(message)) heard.moving[state->map] = *state;
  });
  loop.start();
  int signal = 0;
  sigwait(&signals, &signal);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    coslam::init_log("listen");
    listen(settings_of(argc, argv));
  } catch (const coslam::UsageError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "listen: %s\n", error.what());
    return 1;
  }
}
