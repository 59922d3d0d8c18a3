// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/agent_loop.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "agent/thumbnail.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/report_parts.h"
#include "common/flow/clock.h"

namespace coslam {
namespace {

constexpr auto kServerPatience = std::chrono::seconds(5);
constexpr auto kStatusPeriod = std::chrono::seconds(1);
constexpr std::size_t kSentKept = 128;

}  // namespace

AgentLoop::AgentLoop(AgentLink& link, std::unique_ptr<Feed> feed, const Hello& hello, const AgentConfig& config)
    : AgentLoop(link, std::move(feed), hello, config, make_feature_tracker(hello.camera, config)) {}

AgentLoop::AgentLoop(AgentLink& link, std::unique_ptr<Feed> feed, const Hello& hello, const AgentConfig& config,
                     std::unique_ptr<FeatureTracker> tracker, Clock now)
    : link_(link),
      feed_(std::move(feed)),
      hello_(hello),
      agent_(hello.agent, hello.agent_run, hello.camera, config, std::move(tracker)),
      now_(std::move(now)),
      send_rate_(hello.rate_hz),
      gives_thumbnails_(config.thumbnails) {
  if (hello.pacing == Pacing::kLive) describer_.emplace("describe");
}

bool AgentLoop::step(const std::atomic<bool>& stop) {
  const std::optional<Image> image = feed_->next(stop);
  if (!image) return false;
  judge(*image);
  answer_who_looks(*image);
  if (image->fault != ImageFault::kNone) {
    tell_state();
    return true;
  }
  ++frames_;
  agent_.track(*image);
  const std::vector<MapPatch> patches = collect_patches(stop);
  if (hello_.pacing == Pacing::kLockstep && (stop || server_stops())) return false;
  if (stamps_are_utc_ && !patches.empty()) exchange_ = {patches.back().sent_ns, patches.back().received_ns};
  if (adapts_) watch_link(patches);
  const bool sends = !adapts_ || send_rate_.due(image->capture_ns);
  if (sends) take_described();
  AgentOutput out = agent_.finish(patches, sends ? answers() : Answers::none());
  out.frame.narrow_link = narrow_link_;
  out.frame.images_doubted = verdict_.verdict() != ImageFault::kNone;
  out.frame.clock_set_ns = clock_set_ns_;
  if (!sends) {
    not_sent_ = std::move(out.frame);
  } else {
    not_sent_.reset();
    last_sent_ = out.frame.frame;
    const double delay_s =
        image->available_since ? std::chrono::duration<double>(now_() - *image->available_since).count() : 0;
    if (out.describe) describe_beside(std::move(out.describe));
    if (!out.descriptors) out.descriptors = std::exchange(described_, std::nullopt);
    link_.send(std::move(out.frame), out.patches, out.descriptors);
    ++sent_frames_;
    sent_.push_back({image->frame, now_(), delay_s, link_.waiting().sent_bytes});
    if (sent_.size() > kSentKept) sent_.pop_front();
  }
  warn_when_slow();
  tell_state();
  return true;
}

void AgentLoop::judge(const Image& image) {
  // Stamps may be of any clock.
  const TimeNs now_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now_().time_since_epoch()).count();
  verdict_.note(image.fault, hello_.pacing == Pacing::kLive ? now_ns : image.capture_ns);
  if (image.fault != ImageFault::kNone && image.fault != ImageFault::kMissing) {
    ++left_out_[static_cast<std::size_t>(image.fault)];
  }
  pattern_stays_ |= image.pattern_stays;
  const bool stands = verdict_.verdict() != ImageFault::kNone;
  if (image.fault == ImageFault::kRepeated && !stands) ++repeated_;
  if (stamps_are_utc_) clock_set_ns_ = coslam::clock_set_ns();
}

// Images that are not to be believed are those that people want to see.
void AgentLoop::answer_who_looks(const Image& image) {
  constexpr std::chrono::milliseconds kPeriod{900}, kNarrowPeriod{10'000};
  if (image.grey.empty() || !link_.take_thumbnail_request()) return;
  const auto now = now_();
  if (last_thumbnail_ && now - *last_thumbnail_ < (narrow_link_ ? kNarrowPeriod : kPeriod)) return;
  last_thumbnail_ = now;
  Thumbnail thumbnail{hello_.agent, hello_.agent_run, image.capture_ns, {}};
  if (gives_thumbnails_) thumbnail.jpeg = thumbnail_jpeg(image.grey);
  link_.send_thumbnail(thumbnail);
}

// To the log and, when something changed or a second is over, to the server.
void AgentLoop::tell_state() {
  if (logs_as_) say_state();
  const auto now = now_();
  const bool changed = agent_.pose_state() != last_pose_state_ || verdict_.verdict() != last_verdict_;
  if (last_status_ && now - *last_status_ <= kStatusPeriod && !changed) return;
  last_status_ = now;
  last_pose_state_ = agent_.pose_state();
  last_verdict_ = verdict_.verdict();
  throw_if_refused();
  link_.send_status(status(AgentState::kRunning));
}

// New ones wait for the old ones. On a link that carries little an image is described in no more features than get
// through in about a second: later its tracks are others.
Answers AgentLoop::answers() const {
  constexpr double kSeconds = 1, kBytesAFeature = 80, kBytesAPatch = 80;
  constexpr int kLeastFeatures = 140, kFewFeatures = 200;
  constexpr double kFewPatches = 4, kManyPatches = 16;
  Answers out = Answers::all();
  out.later = describer_.has_value();
  if (describing()) out.described = 0;
  if (!adapts_) return out;
  const double a_frame = reply_rate_.bytes_per_s() * send_rate_.one_in() / hello_.rate_hz;
  const auto patches = static_cast<std::size_t>(std::clamp(a_frame / kBytesAPatch, kFewPatches, kManyPatches));
  if (reply_rate_.limited()) {
    const double most = kSeconds * reply_rate_.bytes_per_s() / kBytesAFeature;
    out.patches = patches;
    out.described = std::max(kLeastFeatures, static_cast<int>(std::min(most, 1e6)));
  } else if (send_rate_.narrow()) {
    out.patches = patches;
    out.described = kFewFeatures;
  }
  const RepliesWaiting waiting = link_.waiting();
  if (waiting.patches) out.patches = 0;
  if (waiting.descriptors || describing()) out.described = 0;
  return out;
}

void AgentLoop::describe_beside(DescribeWork work) {
  describer_->start([work = std::move(work)] {
    const auto begin = std::chrono::steady_clock::now();
    DescribeEnd end = work();
    return Described{std::move(end), std::chrono::steady_clock::now() - begin};
  });
}

void AgentLoop::take_described() {
  std::optional<Described> done = describer_ ? describer_->take() : std::nullopt;
  if (!done) return;
  times_.add("describe", done->took);
  described_ = agent_.take(done->end);
}

// From image to server it takes longer than at best for the link's sake, or the agent's own. Patches that come at once
// waited for one that was lost: the last of them tells how long the link takes.
void AgentLoop::watch_link(const std::vector<MapPatch>& patches) {
  constexpr double kWide_bytes_per_s = 25e3;  // of replies: frames take less
  constexpr std::chrono::seconds kWideAgain{20};
  std::optional<double> downlink_s;
  double wait_s = 0, round_s = 0;
  for (const MapPatch& p : patches) {
    if (p.sent_ns == 0) continue;
    const double took_s = to_seconds(p.received_ns - p.sent_ns);
    downlink_s = std::min(downlink_s.value_or(took_s), took_s);
    const Sent sent = sent_with(p.after_frame);
    wait_s = std::max(0.0, p.uplink_wait_s - sent.delay_s);
    round_s = std::chrono::duration<double>(now_() - sent.at).count();
    delivered_bytes_ = std::max(delivered_bytes_, sent.reply_bytes);
  }
  if (downlink_s) {
    const bool replies_wait = link_.waiting().any();
    // A link that was found to carry little is not taken for wide between two answers.
    if (replies_wait && reply_rate_.bytes_per_s() < kWide_bytes_per_s) full_ = now_();
    const bool full = full_ && now_() - *full_ <= (reply_rate_.limited() ? kWideAgain : std::chrono::seconds(0));
    send_rate_.heard(wait_s, *downlink_s, full, now_());
    reply_rate_.heard(wait_s, round_s, replies_wait, delivered_bytes_, now_());
  }
  narrow_link_ = send_rate_.narrow() || reply_rate_.limited_since(now_() - kWideAgain);
  link_.limit_replies({.bytes_a_frame = reply_rate_.bytes_per_s() * send_rate_.one_in() / hello_.rate_hz,
                       .up_to_bytes = delivered_bytes_ + reply_rate_.unanswered_bytes(),
                       .narrow_link = narrow_link_});
  if (link_.server_alive()) send_rate_.tick(now_());
}

AgentLoop::Sent AgentLoop::sent_with(FrameId frame) const {
  const auto at = std::ranges::find(sent_, frame, &Sent::frame);
  return at == sent_.end() ? Sent{frame, now_()} : *at;
}

// Once, when what the images need is known.
void AgentLoop::say(const std::string& text) const {
  log_info(logs_as_ == LogsAs::kOneOfSeveral ? "agent " + hello_.agent + ": " + text : text);
}

void AgentLoop::warn(const std::string& text) const {
  log_warn(logs_as_ == LogsAs::kOneOfSeveral ? "agent " + hello_.agent + ": " + text : text);
}

void AgentLoop::warn_when_slow() {
  constexpr std::uint32_t kFramesToTell = 60;
  if (hello_.pacing != Pacing::kLive || frames_ != kFramesToTell) return;
  const double taken_ms = mean_frame_ms(), period_ms = 1000 / hello_.rate_hz;
  if (taken_ms <= period_ms) return;
  warn("a frame of " + std::to_string(hello_.camera.width_px) + "x" + std::to_string(hello_.camera.height_px) +
       " pixels takes " + std::to_string(std::lround(taken_ms)) + " ms, but the next comes after " +
       std::to_string(std::lround(period_ms)) +
       ": images are dropped; track them smaller (agent.tracker.most_width_px), or fewer points "
       "(agent.tracker.max_tracks)" +
       (stamps_are_utc_ ? "" : "; with --rate max nothing is dropped"));
}

void AgentLoop::say_state() {
  if (const auto word = words_.server(link_.server_alive(), now_())) say(*word);
  if (const auto word = words_.link(!adapts_ || !send_rate_.narrow(), now_())) say(*word);
  if (const auto word = words_.pose(agent_.pose_state(), now_())) say(*word);
  if (const auto word = words_.working_width(agent_.working_width_px())) say(*word);
  if (const auto word = words_.own_body(agent_.own_body_share())) warn(*word);
  // Where the server says it in the same log, once is enough.
  if (const auto word = words_.images(verdict_.verdict()); word && logs_as_ == LogsAs::kProcess) {
    verdict_.verdict() == ImageFault::kNone ? say(*word) : warn(*word);
  }
  if (const auto word = words_.alternating(left_out_[static_cast<std::size_t>(ImageFault::kAlternating)] > 0)) {
    warn(*word);
  }
  if (const auto word = words_.repeating(repeated_, frames_)) warn(*word);
  if (const auto word = words_.fixed_pattern(pattern_stays_)) warn(*word);
  if (const auto word = words_.clock(clock_set_ns_)) warn(*word);
  if (const auto word = words_.readout(agent_.found_readout_s())) say(*word);
}

double AgentLoop::mean_frame_ms() const {
  const auto& stages = agent_.times().stages();
  const auto frame = stages.find(Agent::kFrame);
  return frame == stages.end() ? 0 : frame->second.mean_ms();
}

std::vector<MapPatch> AgentLoop::collect_patches(const std::atomic<bool>& stop) {
  if (hello_.pacing == Pacing::kLive) return link_.take_patches();
  std::vector<MapPatch> patches;
  if (!last_sent_) return patches;
  const auto give_up = now_() + kServerPatience;
  while (!stop) {
    std::optional<MapPatch> patch = link_.wait_patch(*last_sent_, std::chrono::milliseconds(200));
    if (patch) {
      const bool answered = patch->after_frame >= *last_sent_;
      patches.push_back(std::move(*patch));
      if (answered) return patches;
      continue;
    }
    if (server_stops()) return patches;
    throw_if_refused();
    if (now_() > give_up && !link_.server_alive()) {
      throw UserError("the map server no longer answers; a replay at full speed cannot go on without it");
    }
  }
  return patches;
}

bool AgentLoop::server_stops() const {
  const auto server = link_.server_status();
  return hello_.pacing == Pacing::kLockstep && server && server->stopping;
}

void AgentLoop::throw_if_refused() const {
  const auto server = link_.server_status();
  if (!server) return;
  if (const auto reason = refusal_of(*server, hello_.agent_run)) throw UserError(*reason);
}

std::uint32_t AgentLoop::left_out() const { return std::accumulate(left_out_.begin(), left_out_.end(), 0U); }

AgentStatus AgentLoop::status(AgentState state) const {
  AgentStatus s;
  s.agent = hello_.agent;
  s.agent_run = hello_.agent_run;
  s.state = state;
  s.pose_state = agent_.pose_state();
  s.frames = sent_frames_;
  s.dropped = not_sent();
  s.left_out = left_out();
  s.image_fault = verdict_.verdict();
  s.tracks = static_cast<std::uint32_t>(agent_.tracks());
  s.frame_ms = static_cast<float>(mean_frame_ms());
  s.exchange = exchange_;
  s.exchange.replied_ns = utc_now_ns();
  return s;
}

nlohmann::json AgentLoop::own_body() const {
  const ImageParts parts = agent_.own_body();
  std::string cells;
  for (const bool found : parts.cells) cells += found ? '1' : '0';
  return {
      {"percent", 100 * agent_.own_body_share()}, {"columns", parts.columns}, {"rows", parts.rows}, {"cells", cells}};
}

std::string AgentLoop::report() const {
  nlohmann::ordered_json ms = nlohmann::ordered_json::object();
  for (const StageTimes* times : {&agent_.times(), &times_}) {
    for (const auto& [name, h] : times->stages()) {
      ms[name] = {{"p50", h.percentile_ms(50)},
                  {"p95", h.percentile_ms(95)},
                  {"p99", h.percentile_ms(99)},
                  {"mean", h.mean_ms()},
                  {"count", h.count()}};
    }
  }
  nlohmann::ordered_json out;
  out["start_s"] = start_s_;
  const std::uint32_t images = sent_frames_ + not_sent() + left_out();
  out["frames"] = images;
  out["left_out"] = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < left_out_.size(); ++i) {
    if (left_out_[i] > 0) out["left_out"][std::string(words_of(static_cast<ImageFault>(i)).name)] = left_out_[i];
  }
  out["live_tracked_percent"] = 100.0 * agent_.tracked_frames() / std::max(1U, images);
  out["ms_per_frame"] = mean_frame_ms();
  out["tracked_width_px"] = agent_.working_width_px();
  if (agent_.own_body_share() > 0) out["own_body"] = own_body();
  out["ms"] = ms;
  out["peak_memory_mib"] = peak_memory_mib();
  if (logs_as_ == LogsAs::kProcess) out["warnings"] = json_of(warnings_given());
  return out.dump();
}

// Where a run ends, places are often seen again that it began with, and nobody can ask for this image any more.
std::optional<DescriptorReply> AgentLoop::last_image() {
  const bool known = !sent_.empty() && agent_.described() == sent_.back().frame;
  if (known && !describing() && !link_.waiting().descriptors) return std::nullopt;
  return agent_.describe_last();
}

void AgentLoop::finish(const std::atomic<bool>& stop) {
  // In lock-step the answer to the last frame is still to come; without it the server may not have used that frame.
  try {
    if (hello_.pacing == Pacing::kLockstep && link_.server_alive()) collect_patches(stop);
  } catch (const UserError&) {
    // It is gone: there is nobody to report to either.
  }
  // The server is to have the image that it is told about.
  if (not_sent_) {
    link_.send(std::move(*std::exchange(not_sent_, std::nullopt)), {}, {});
    ++sent_frames_;
  }
  AgentStatus last = status(AgentState::kFinished);
  last.report_json = report();
  last.last_image = last_image();
  link_.send_status(last);
}

}  // namespace coslam
