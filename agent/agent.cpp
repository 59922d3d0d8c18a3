// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/agent.h"

#include <algorithm>
#include <utility>

#include "agent/track/descriptors.h"

namespace coslam {
namespace {

constexpr float kSamePx = 2.5F;  // a SIFT feature this close to a track is that track
constexpr float kNearPx = 4.0F;  // the strongest SIFT feature this close to a track tells what is there
constexpr double kSiftBorderPx = 14;
constexpr int kShedAfterFrames = 20;
constexpr int kShedPerFrame = 15;

std::vector<Eigen::Vector2f> places_of(const std::vector<Track>& tracks) {
  std::vector<Eigen::Vector2f> out;
  for (const Track& t : tracks) out.push_back(t.raw_px);
  return out;
}

}  // namespace

Agent::Agent(std::string name, RunId run, const CameraModel& camera, const AgentConfig& config)
    : name_(std::move(name)),
      run_(run),
      camera_(camera),
      config_(config),
      pixel_scale_(pixel_scale(camera)),
      tracker_(config.tracker),
      pose_(camera, config.pose),
      map_(run) {
  if (config.tags.family != kNoTags) tag_finder_.emplace(camera, config.tags.family);
}

void Agent::track(const Image& image) {
  {
    const auto timer = times_.measure("track");
    image_ = image;
    tracker_.step(image.grey);
    // Features that an answer to a descriptor request added had time to start the map; the link is made for max_tracks.
    if (++since_described_ > kShedAfterFrames) tracker_.thin(kShedPerFrame);
    observe(tracker_.live());
  }
  look_for_tags();
}

void Agent::look_for_tags() {
  tags_.clear();
  if (!tag_finder_) return;
  if (tags_sought_ns_ && image_.capture_ns < *tags_sought_ns_ + to_ns(config_.tags.period_s)) return;
  const auto timer = times_.measure("tags");
  tags_sought_ns_ = image_.capture_ns;
  for (const FoundTag& found : tag_finder_->find(image_.grey)) {
    if (tags_.size() == kMaxTags) break;
    TagObservation& o = tags_.emplace_back();
    o.tag = found.tag;
    std::ranges::transform(found.undistorted_px, o.undistorted_px.begin(),
                           [this](const Eigen::Vector2d& px) { return quantised_px(px, pixel_scale_); });
  }
}

void Agent::observe(const std::vector<Track>& tracks) {
  tracks_.clear();
  observations_.clear();
  for (const Track& t : tracks) {
    const auto px = camera_.undistorted_from_raw(t.raw_px.cast<double>());
    if (!px) continue;
    tracks_.push_back(t);
    observations_.push_back({t.id, quantised_px(*px, pixel_scale_)});
  }
}

AgentOutput Agent::finish(std::span<const MapPatch> patches) {
  AgentOutput out;
  {
    const auto timer = times_.measure("correct");
    for (const MapPatch& p : patches) take(p);
    map_.keep_only(observations_);
  }
  {
    const auto timer = times_.measure("pose");
    pose_.step(image_.frame, observations_, map_);
  }
  if (pose_.state() == PoseState::kTracked) ++tracked_frames_;
  const auto timer = times_.measure("answer");
  out.descriptors = describe_image();  // may start tracks, so before the frame is made
  out.patches = cut_patches();
  out.frame = make_frame();
  out.frame.patches_sent = out.patches ? static_cast<std::uint16_t>(out.patches->patches.size()) : 0;
  out.frame.descriptors_sent = out.descriptors.has_value();
  return out;
}

void Agent::take(const MapPatch& patch) {
  const PatchEffect effect = map_.apply(patch);
  if (effect.new_server) {
    pose_.reset();
    descriptors_wanted_ = DescriptorRequest::kEverywhere;
    patch_requests_.clear();
  }
  if (!effect.accepted) return;
  if (effect.rebase) pose_.rebase(*effect.rebase);
  if (effect.placed) pose_.place(*effect.placed);
  patch_requests_.insert(effect.patch_requests.begin(), effect.patch_requests.end());
  descriptors_wanted_ = std::max(descriptors_wanted_, effect.descriptor_request);
}

std::optional<DescriptorReply> Agent::describe_image() {
  const DescriptorRequest wanted = std::exchange(descriptors_wanted_, DescriptorRequest::kNone);
  if (wanted == DescriptorRequest::kNone) return std::nullopt;
  const bool everywhere = wanted == DescriptorRequest::kEverywhere;
  if (everywhere) since_described_ = 0;
  const DescribedFeatures features =
      everywhere ? describe(image_.grey, config_.descriptor_features, kSiftBorderPx)
                 : describe_near(image_.grey, places_of(tracks_), kNearPx, config_.place_features, kSiftBorderPx);
  const std::vector<TrackId> ids = tracker_.add(features.raw_px, everywhere ? kSamePx : kNearPx);
  observe(tracker_.live());
  std::map<TrackId, std::size_t> feature_of;  // the first of several at one track
  for (std::size_t i = 0; i < ids.size(); ++i) feature_of.emplace(ids[i], i);
  DescriptorReply reply{.agent = name_, .agent_run = run_, .frame = image_.frame};
  for (const TrackObservation& o : observations_) {
    const auto at = feature_of.find(o.track);
    if (at == feature_of.end()) continue;
    reply.tracks.push_back(o.track);
    const auto begin = features.descriptors.begin() + static_cast<std::ptrdiff_t>(at->second * kDescriptorBytes);
    reply.descriptors.insert(reply.descriptors.end(), begin, begin + kDescriptorBytes);
  }
  return reply;
}

std::optional<PatchReply> Agent::cut_patches() {
  if (patch_requests_.empty()) return std::nullopt;
  PatchReply reply{.agent = name_, .agent_run = run_, .frame = image_.frame};
  const cv::Mat small = shrink_for_patches(image_.grey);
  for (const Track& t : tracks_) {
    if (patch_requests_.contains(t.id)) reply.patches.push_back(cut_patch(small, t));
  }
  patch_requests_.clear();
  if (reply.patches.empty()) return std::nullopt;
  return reply;
}

TrackFrame Agent::make_frame() const {
  TrackFrame f;
  f.agent = name_;
  f.agent_run = run_;
  f.frame = image_.frame;
  f.capture_ns = image_.capture_ns;
  f.pose_state = pose_.state();
  f.server_run = map_.server_run();
  f.epoch = map_.epoch();
  const PoseResult& r = pose_.result();
  f.cam_from_world = r.cam_from_world;
  f.pose_covariance = r.covariance.cast<float>();
  f.pose_inliers = static_cast<std::uint16_t>(r.inliers);
  f.hull_fraction = static_cast<float>(pose_.inlier_hull_fraction());
  f.applied_patch = map_.applied_sequence();
  f.wants_snapshot = map_.wants_snapshot();
  f.tracks = observations_;
  f.tags = tags_;
  return f;
}

}  // namespace coslam
