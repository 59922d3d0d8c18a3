// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <utility>

#include "agent/agent_loop.h"
#include "agent/agent_options.h"
#include "agent/capture/camera_of.h"
#include "agent/capture/ros2_topic.h"
#include "agent/capture/sources.h"
#include "agent/link/dds_agent_link.h"
#include "agent/play_start.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/replay_rate.h"
#include "common/base/words.h"
#include "common/config/program.h"
#include "common/flow/clock.h"
#include "common/wire/addresses.h"
#include "common/wire/participant.h"
#include "common/wire/peer_names.h"
#include "common/wire/ports.h"
#include "common/wire/run_id.h"

namespace coslam {
namespace {

std::atomic<bool> stop_requested{false};
std::atomic<bool> awaits_source{false};  // a live source may take long to open

void stop(int) {
  if (awaits_source) std::_Exit(0);  // nobody has heard of this agent yet
  stop_requested = true;
}

void warn_of_clock(double ahead_s) {
  constexpr double kWorthAWord_s = 3.0;
  if (std::abs(ahead_s) < kWorthAWord_s) return;
  log_warn("the clock of this machine is " + std::to_string(std::lround(std::abs(ahead_s))) + " s " +
           (ahead_s > 0 ? "ahead of" : "behind") + " the server's; set it");
}

// Why nobody is heard, in the end of a sentence.
std::string likely_cause(const WireConfig& wire, const RejectionCounts& refused) {
  if (refused[Rejection::kUnauthentic] > 0) return "who is heard has another key, or none";
  const std::string key = wire.key_file.empty() ? "has it a key, which this agent lacks?" : "has it the same key?";
  const std::string ports = "UDP ports from " + std::to_string(multicast_port(wire.domain)) + " on";
  if (wire.peers.empty()) {
    return "is it in another domain? " + key + " Networks that carry no multicast want its address: wire.peers=[HOST]";
  }
  return "nothing comes from " + joined(wire.peers) + ": does it run there, in this domain? " + key +
         " Does a firewall let " + ports + " pass, both ways?";
}

// Waits until the server says that everybody is here, this agent among them. Returns when to start, or nothing when
// told to stop.
std::optional<TimeNs> wait_for_start(AgentLink& link, const Hello& hello, const WireConfig& wire) {
  constexpr int kUnheard = 2;  // times that it was said; then with a cause
  int unheard = 0;
  auto last_report = std::chrono::steady_clock::now();
  PlayStart start;
  while (!stop_requested) {
    const auto status = link.wait_server_status(std::chrono::milliseconds(200));
    if (status) {
      if (const auto reason = refusal_of(*status, hello.agent_run)) throw UserError(*reason);
      const bool met = std::ranges::find(status->agents, hello.agent) != status->agents.end();
      const auto known = status->started && met ? start.heard(*status, link.clock_ahead_s().value_or(0)) : std::nullopt;
      if (known) {
        warn_of_clock(known->clock_ahead_s);
        return known->start_utc_ns;
      }
    }
    if (std::chrono::steady_clock::now() - last_report > std::chrono::seconds(5)) {
      last_report = std::chrono::steady_clock::now();
      if (link.server_status()) {
        log_info("waiting for the other agents");
      } else {
        ++unheard;
        log_info("waiting for a map server in domain " + std::to_string(wire.domain) + ", on " +
                 joined(addresses_used(wire)) +
                 (unheard >= kUnheard ? ": " + likely_cause(wire, link.rejections()) : ""));
      }
    }
  }
  return std::nullopt;
}

// Others play already.
void warn_if_late(TimeNs start_utc_ns, double rate) {
  constexpr double kWorthAWord_s = 1;
  const double over_s = rate * to_seconds(utc_now_ns() - start_utc_ns);
  if (over_s < kWorthAWord_s) return;
  char text[240];
  std::snprintf(
      text, sizeof text,
      "joined when %.1f s were played: its images before that are left out; start agents that belong together "
      "within 3 s of each other, or name all of them to the server (--set agents=NAME,NAME)",
      over_s);
  log_warn(text);
}

std::unique_ptr<Feed> make_feed(std::unique_ptr<ImageSource> source, double rate, TimeNs start_utc_ns) {
  if (rate == 0) return prefetching_feed(std::move(source));
  return real_time_feed(std::move(source), rate, start_utc_ns);
}

// What nodes say must not reach the fleet.
void require_apart(const AgentOptions& o) {
  for (const std::string& name : {o.source, o.calibration}) {
    if (ros2_domain(name) != o.wire.domain) continue;
    throw UserError("DDS domain " + std::to_string(o.wire.domain) + " is that of the fleet and of " + name +
                    ": give one of them another with --domain or ?domain=N");
  }
}

// The last status travels while the server works off what it got; leave when it has, or is gone.
void wait_for_account(AgentLink& link) {
  for (int i = 0; i < 50 && !stop_requested; ++i) {
    const auto status = link.wait_server_status(std::chrono::milliseconds(100));
    const auto images = link.images();
    if ((images && images->complete) || (status && status->stopping) || !link.server_alive()) break;
  }
}

// What became of its images. Throws UserError when none has a pose.
void say_account(const AgentLink& link) {
  const auto account = link.images();
  if (!account || !account->complete) return;
  const ImageAccount& images = account->images;
  const std::string losses = images.losses();
  log_info(std::to_string(images[ImageFate::kTracked]) + " of " + std::to_string(images.captured()) +
           " images tracked" + (losses.empty() ? "" : "; " + losses));
  if (account->problem.empty()) return;
  if (images[ImageFate::kTracked] == 0) throw UserError(account->problem);
  log_warn(account->problem);
}

void run(AgentOptions& o) {
  if (o.id.empty()) throw UsageError("--id is empty: an agent needs a name");
  if (o.source.empty()) throw UsageError("--source is missing (see --help)");
  require_apart(o);
  const double rate = parse_replay_rate(o.rate);
  Hello hello;
  hello.agent = o.id;
  hello.agent_run = draw_run_id();
  awaits_source = is_live_uri(o.source) || ros2_domain(o.calibration);
  if (stop_requested) return;
  auto [found, source] = open_camera(o.source, o.calibration, o.play);
  awaits_source = false;
  hello.camera = found.camera;
  if (!found.guess.empty()) log_warn(found.guess);
  hello.rate_hz = o.play.rate_hz;
  hello.pacing = rate == 0 && !source->live() ? Pacing::kLockstep : Pacing::kLive;
  // Before anybody hears of this agent: a device that is not there ends it.
  std::unique_ptr<FeatureTracker> tracker = make_feature_tracker(hello.camera, o.agent);
  const std::unique_ptr<AgentLink> link = open_agent_link(o.wire, hello);
  TimeNs start_utc_ns = 0;
  const bool live = source->live();
  if (!live) {
    const auto start = wait_for_start(*link, hello, o.wire);
    if (!start) return;
    start_utc_ns = *start;
    log_info("playing " + o.source);
    if (rate > 0) warn_if_late(start_utc_ns, rate);
  }
  AgentLoop loop(
      *link, make_feed(std::move(source), hello.pacing == Pacing::kLockstep ? 0 : std::max(rate, 1e-3), start_utc_ns),
      hello, o.agent, std::move(tracker));
  loop.log_state();
  loop.plays_from(o.play.start_s);
  if (live) loop.stamps_are_utc();
  if (live || rate == 1) loop.adapt_to_link();
  while (!stop_requested && loop.step(stop_requested)) {
  }
  loop.finish(stop_requested);
  wait_for_account(*link);
  say_account(*link);
}

struct Arguments {
  CommonArguments common;
  std::string source, calibration, mask, rate;
  std::optional<std::string> id;
  std::optional<int> domain;
  std::optional<double> start_s, duration_s, rate_hz;
  std::vector<std::pair<double, double>> covered;
  bool loopback = false;
};

void add_options(CLI::App& app, Arguments& a) {
  a.common.add_to(app, "agent.yaml", "agent.tracker.max_tracks=200");
  app.add_option("--id", a.id, "name of this agent")->type_name("NAME");
  app.add_option("--source", a.source, "images")->type_name("URI");
  app.add_option("--calibration", a.calibration, "camera calibration")->type_name("FILE");
  app.add_option("--mask", a.mask, "image, black where nothing is to be tracked")->type_name("FILE");
  app.add_option("--domain", a.domain, "DDS domain, 0 to 232")->type_name("N")->check(CLI::Range(0, 232));
  app.add_option("--rate", a.rate, "speed of replay: a factor, or max")->type_name("R");
  app.add_option("--start", a.start_s, "offset into the source, seconds")
      ->type_name("S")
      ->check(CLI::Range(-3600.0, 1e9));
  app.add_option("--duration", a.duration_s, "length to play, seconds")->type_name("S")->check(CLI::Range(0.0, 1e9));
  app.add_option("--covered", a.covered, "black images from one time to another, seconds; may be repeated")
      ->type_name("FROM TO");
  app.add_option("--fps", a.rate_hz, "nominal frame rate")->type_name("HZ")->check(CLI::Range(0.01, 1000.0));
  app.add_flag("--loopback", a.loopback, "talk on this machine only");
}

AgentOptions options_of(const Arguments& a) {
  AgentOptions o;
  if (a.loopback) o.wire = loopback_config(0);
  a.common.apply_to(o);
  if (a.id) o.id = *a.id;
  if (!a.source.empty()) o.source = a.source;
  if (!a.calibration.empty()) o.calibration = a.calibration;
  if (!a.mask.empty()) o.agent.tracker.mask = a.mask;
  if (!a.rate.empty()) o.rate = a.rate;
  if (a.domain) o.wire.domain = *a.domain;
  if (a.start_s) o.play.start_s = *a.start_s;
  if (a.duration_s) o.play.duration_s = *a.duration_s;
  for (const auto& [from_s, to_s] : a.covered) {
    if (from_s < 0 || to_s <= from_s) throw UsageError("--covered: the second time must be later than the first");
    o.play.covered.push_back({from_s, to_s});
  }
  o.play.rate_is_given = a.rate_hz || o.play.rate_hz != SourceOptions().rate_hz;
  if (a.rate_hz) o.play.rate_hz = *a.rate_hz;
  return o;
}

int main_of(int argc, char** argv) {
  CLI::App app("Camera agent: tracks features in one camera and localises it; see docs/configuration.md");
  Arguments arguments;
  add_options(app, arguments);
  if (const auto code = parse_arguments(app, argc, argv)) return *code;
  AgentOptions o = options_of(arguments);
  if (arguments.common.print) {
    print_config("coslam-agent", o);
  } else {
    init_log(o.id, arguments.common.log_format);
    await_names(&o.wire.peers, while_starting([] { return stop_requested.load(); }));
    run(o);
  }
  return 0;
}

}  // namespace
}  // namespace coslam

int main(int argc, char** argv) {
  std::signal(SIGINT, coslam::stop);
  std::signal(SIGTERM, coslam::stop);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR);  // we say ourselves what cannot be opened
#ifdef M_ARENA_MAX
  // One heap for all threads: each of its own would grow by what an image is described with.
  mallopt(M_ARENA_MAX, 1);
#endif
  cv::setNumThreads(1);  // the other cores belong to the other processes of this machine
  return coslam::run_program("coslam-agent", [&] { return coslam::main_of(argc, argv); });
}
