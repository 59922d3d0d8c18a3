// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/agent.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "agent/gpu/matcher_for.h"
#include "agent/track/klt_feature_tracker.h"
#include "agent/track/mask.h"
#include "common/base/log.h"

namespace coslam {
namespace {

constexpr double kAlone_s = 0.5;  // without a word of the server
constexpr int kShedAfterFrames = 20;
constexpr int kShedPerFrame = 15;
// The map's errors are shared by many points, while a pose takes each point's for its own: it comes out too sure by so
// much in the variance, as simulated scenes show.
constexpr double kSharedByPoints = 4;

// Of those that are observed (ascending).
DescriptorReply reply_of(DescriptorReply reply, const DescribedTracks& described,
                         const std::vector<TrackId>& observed) {
  for (std::size_t i = 0; i < described.tracks.size(); ++i) {
    if (!std::ranges::binary_search(observed, described.tracks[i])) continue;
    reply.tracks.push_back(described.tracks[i]);
    const auto begin = described.descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
    reply.descriptors.insert(reply.descriptors.end(), begin, begin + kDescriptorBytes);
  }
  return reply;
}

}  // namespace

std::unique_ptr<FeatureTracker> make_feature_tracker(const CameraModel& camera, const AgentConfig& config) {
  const std::string& mask = config.tracker.mask;
  auto tracker = klt_feature_tracker(camera, config.tracker, config.tags.family, matcher_for(config.tracker));
  if (!mask.empty()) {
    const MaskWord word = word_of(mask, read_mask(mask));
    word.doubtful ? log_warn(word.text) : log_info(word.text);
  }
  return tracker;
}

Agent::Agent(std::string name, RunId run, const CameraModel& camera, const AgentConfig& config,
             std::unique_ptr<FeatureTracker> tracker)
    : name_(std::move(name)),
      run_(run),
      camera_(camera),
      config_(config),
      pixel_scale_(pixel_scale(camera)),
      tracker_(std::move(tracker)),
      shutter_(camera, config.readout_s),
      own_body_(camera),
      pose_(camera, config.pose),
      map_(run) {}

void Agent::track(const Image& image) {
  const auto begin = std::chrono::steady_clock::now();
  {
    const auto timer = times_.measure("track");
    frame_ = image.frame;
    capture_ns_ = image.capture_ns;
    tracker_->step(image);
    if (own_body_.step(image.capture_ns, tracker_->live())) tracker_->leave_out(own_body_.found());
    // Features that an answer to a descriptor request added had time to start the map; the link is made for max_tracks.
    if (++since_described_ > kShedAfterFrames) tracker_->thin(kShedPerFrame);
    observe();
  }
  look_for_tags();
  frame_took_ = std::chrono::steady_clock::now() - begin;
}

int Agent::working_width_px() const {
  return static_cast<int>(std::lround(tracker_->working_scale() * camera_.width_px));
}

void Agent::look_for_tags() {
  tags_.clear();
  if (config_.tags.family == kNoTags) return;
  if (tags_sought_ns_ && capture_ns_ < *tags_sought_ns_ + to_ns(config_.tags.period_s)) return;
  const auto timer = times_.measure("tags");
  tags_sought_ns_ = capture_ns_;
  tags_ = tracker_->tags();
  if (tags_.size() > kMaxTags) tags_.resize(kMaxTags);
}

void Agent::observe() {
  std::vector<SeenPlace> places;
  for (const Track& t : tracker_->live()) {
    if (places.size() == kMaxTracks) break;  // the oldest go, which are known
    const auto px = camera_.undistorted_from_raw(t.raw_px.cast<double>());
    if (px) places.push_back({t.id, t.raw_px.y(), *px});
  }
  shutter_.correct(capture_ns_, &places);
  observations_.clear();
  for (const SeenPlace& p : places) observations_.push_back({p.track, quantised_px(p.undistorted_px, pixel_scale_)});
}

std::vector<TrackId> Agent::observed() const {
  std::vector<TrackId> ids;
  for (const TrackObservation& o : observations_) ids.push_back(o.track);
  return ids;
}

AgentOutput Agent::finish(std::span<const MapPatch> patches, Answers answers) {
  const auto begin = std::chrono::steady_clock::now();
  AgentOutput out;
  {
    const auto timer = times_.measure("correct");
    for (const MapPatch& p : patches) take(p);
    map_.keep_only(observations_);
  }
  {
    const auto timer = times_.measure("pose");
    if (!patches.empty()) heard_ns_ = capture_ns_;
    const bool alone = capture_ns_ - heard_ns_ > to_ns(kAlone_s);
    pose_.step(frame_, capture_ns_, seen_through(camera_, lens_, observations_), map_, alone);
  }
  if (pose_.state() == PoseState::kTracked) ++tracked_frames_;
  {
    const auto timer = times_.measure("answer");
    const DescriptorsSent sent = describe_image(answers, &out);  // may start tracks, so before the frame is made
    out.patches = cut_patches(answers.patches);
    out.frame = make_frame();
    out.frame.patches_sent = out.patches ? static_cast<std::uint16_t>(out.patches->patches.size()) : 0;
    out.frame.descriptors_sent = sent;
  }
  times_.add(kFrame, frame_took_ + (std::chrono::steady_clock::now() - begin));
  return out;
}

void Agent::take(const MapPatch& patch) {
  const PatchEffect effect = map_.apply(patch);
  if (effect.new_server) {
    if (!effect.goes_on) pose_.reset();
    descriptors_wanted_ = DescriptorRequest::kEverywhere;
    patch_requests_.clear();
  }
  if (!effect.accepted) return;
  if (effect.lens && !(*effect.lens == lens_)) {
    lens_ = *effect.lens;
    pose_.change_lens();
  }
  if (effect.rebase) pose_.rebase(*effect.rebase);
  if (effect.placed) pose_.place(*effect.placed);
  patch_requests_.insert(effect.patch_requests.begin(), effect.patch_requests.end());
  descriptors_wanted_ = std::max(descriptors_wanted_, effect.descriptor_request);
}

// How many tracks an answer to a descriptor request may start. Without a place the agent is asked again and again: all
// answers together add no more than the features of one, and no more than a frame may carry.
int Agent::room_for_described() const {
  const int most = std::min(config_.tracker.max_tracks + config_.descriptor_features, static_cast<int>(kMaxTracks));
  return std::max(0, most - static_cast<int>(tracker_->live().size()));
}

DescriptorsSent Agent::describe_image(const Answers& answers, AgentOutput* out) {
  if (answers.described == 0) return DescriptorsSent::kNone;
  const DescriptorRequest wanted = std::exchange(descriptors_wanted_, DescriptorRequest::kNone);
  if (wanted == DescriptorRequest::kNone) return DescriptorsSent::kNone;
  const bool everywhere = wanted == DescriptorRequest::kEverywhere;
  DescribeWork work = everywhere ? describe_everywhere(std::min(answers.described, config_.descriptor_features))
                                 : describe_tracks(std::min(answers.described, config_.place_features));
  if (!answers.later) {
    out->descriptors = work()();
    return DescriptorsSent::kWithFrame;
  }
  out->describe = std::move(work);
  return everywhere ? DescriptorsSent::kNone : DescriptorsSent::kLater;  // those of another frame; of this one
}

DescribeWork Agent::describe_tracks(int most) {
  described_ = frame_;
  DescriptorReply empty{.agent = name_, .agent_run = run_, .frame = frame_};
  return [empty = std::move(empty), ids = observed(), work = tracker_->describe_at(observed(), most)] {
    return [reply = reply_of(empty, work(), ids)] { return reply; };
  };
}

DescribeWork Agent::describe_everywhere(int most) {
  return [this, work = tracker_->describe_strongest(most)] {
    return [this, start = work()] {
      described_ = frame_;
      since_described_ = 0;
      const DescribedTracks described = start(room_for_described());
      observe();
      return reply_of({.agent = name_, .agent_run = run_, .frame = frame_}, described, observed());
    };
  };
}

DescriptorReply Agent::take(const DescribeEnd& end) {
  const auto begin = std::chrono::steady_clock::now();
  DescriptorReply reply = end();
  frame_took_ += std::chrono::steady_clock::now() - begin;
  return reply;
}

std::optional<DescriptorReply> Agent::describe_last() {
  if (observations_.empty()) return std::nullopt;
  return describe_tracks(config_.place_features)()();
}

std::optional<PatchReply> Agent::cut_patches(std::size_t most) {
  std::vector<TrackId> wanted;
  std::set<TrackId> left;
  for (const TrackObservation& o : observations_) {
    if (!patch_requests_.contains(o.track)) continue;
    if (wanted.size() < most) {
      wanted.push_back(o.track);
    } else {
      left.insert(o.track);
    }
  }
  patch_requests_ = std::move(left);
  if (wanted.empty()) return std::nullopt;
  return PatchReply{.agent = name_, .agent_run = run_, .frame = frame_, .patches = tracker_->patches(wanted)};
}

TrackFrame Agent::make_frame() const {
  TrackFrame f;
  f.agent = name_;
  f.agent_run = run_;
  f.frame = frame_;
  f.capture_ns = capture_ns_;
  f.pose_state = pose_.state();
  f.server_run = map_.server_run();
  f.epoch = map_.epoch();
  const PoseResult& r = pose_.result();
  f.cam_from_world = r.cam_from_world;
  f.pose_covariance = quantised_pose_covariance(kSharedByPoints * r.covariance);
  f.on_own_points = pose_.on_own_points();
  f.pose_inliers = static_cast<std::uint16_t>(r.inliers);
  f.hull_fraction = static_cast<float>(pose_.inlier_hull_fraction());
  f.applied_patch = map_.applied_sequence();
  f.wants_snapshot = map_.wants_snapshot();
  f.tracks = observations_;
  f.tags = tags_;
  return f;
}

}  // namespace coslam
