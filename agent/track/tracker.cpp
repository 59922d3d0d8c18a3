// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/tracker.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <utility>

#include "agent/track/corners.h"
#include "agent/track/crowding.h"
#include "agent/track/key_patch.h"
#include "agent/track/motion.h"
#include "agent/track/outline.h"
#include "agent/track/pyramid.h"
#include "agent/track/wide_baseline_search.h"
#include "agent/track/working_scale.h"
#include "common/base/check.h"

namespace coslam {
namespace {

// Further than this from where the image before leads, the first patch is not believed.
constexpr float kKeyAgrees_px = 0.5f;
// Further than this one of the two is wrong: the track slides, or no longer looks like its first patch.
constexpr float kKeyDisagrees_px = 1.5f;
constexpr int kMostDoubts = 3;        // images in a row in which the first patch may not be found
constexpr double kMuchNew = 0.33;     // of the view, by the share of tracks that ended
constexpr float kCornerInset_px = 4;  // new corners keep off the border, where they would end at once

CornerConfig corner_config(const TrackerConfig& config, int image_cols, const cv::Mat& mask) {
  constexpr float kLeastFree = 0.1F;  // where less is left to be seen, tracks would crowd
  CornerConfig c;
  if (!mask.empty()) {
    c.free_share = std::max(kLeastFree, static_cast<float>(cv::countNonZero(mask)) / static_cast<float>(mask.total()));
  }
  c.max_tracks = config.max_tracks;
  c.min_distance_px = static_cast<float>(config.min_distance_px * image_cols / 640.0);
  c.min_eigenvalue = static_cast<float>(config.min_eigenvalue);
  c.border_px = static_cast<float>(config.border_px) + kCornerInset_px;
  return c;
}

}  // namespace

struct Tracker::State {
  // What a track remembers beside its place.
  struct Memory {
    Eigen::Vector2f motion_px = Eigen::Vector2f::Zero();  // from the image before to the last
    std::unique_ptr<KeyPatch> key;
    int doubts = 0;
    bool moving = false;  // apart from the image as a whole
    OutlineEvidence outline;
  };

  State(const TrackerConfig& c, std::unique_ptr<Matcher> m) : config(c), matcher(std::move(m)) {}

  const TrackerConfig config;
  const std::unique_ptr<Matcher> matcher;
  std::vector<Track> tracks;
  std::vector<Memory> memories;                        // by track
  Eigen::Vector2f shift_px = Eigen::Vector2f::Zero();  // of the whole image, last time
  std::unique_ptr<CornerFinder> finder;
  cv::Mat mask;
  std::uint32_t next_id = 1, next_key = 1;
  double ended_share = 0;  // of the tracks, in the newest image
  WideBaselineSearch search;

  bool masked(const Eigen::Vector2f& px) const;
  void follow();
  void take_key(KeyPatch& key, const Eigen::Vector2f& px);
  bool confirm(Memory& memory, const KeyAlignment& key, Eigen::Vector2f& px);
  void tell_moving();
  void end_outlines();
  const Memory* mover_beside(const Eigen::Vector2f& px) const;
  TrackId start(const Eigen::Vector2f& px);
  void replenish();
};

void Tracker::State::take_key(KeyPatch& key, const Eigen::Vector2f& px) {
  key.take(matcher->newest().level(0), px);
  key.number = next_key++;
}

// Moves px to where the track's first patch is found. False when it has not been for a while. What moves takes a new
// one then, so that it may drift.
bool Tracker::State::confirm(Memory& memory, const KeyAlignment& key, Eigen::Vector2f& px) {
  const float distance_px = (key.px - px).norm();
  if (!key.found || key.zncc < config.min_zncc || distance_px > kKeyDisagrees_px) {
    if (++memory.doubts < kMostDoubts) return true;
    if (!memory.moving) return false;
    take_key(*memory.key, px);
    memory.doubts = 0;
    return true;
  }
  memory.doubts = 0;
  if (distance_px < kKeyAgrees_px) {
    px = key.px;
    memory.key->warp = key.warp;
  }
  return true;
}

bool Tracker::State::masked(const Eigen::Vector2f& px) const {
  if (mask.empty()) return false;
  const int x = std::clamp(cvRound(px.x()), 0, mask.cols - 1), y = std::clamp(cvRound(px.y()), 0, mask.rows - 1);
  return mask.at<std::uint8_t>(y, x) == 0;
}

void Tracker::State::follow() {
  ended_share = 0;
  if (tracks.empty()) return;
  std::vector<Sought> sought;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    sought.push_back({tracks[i].raw_px, memories[i].motion_px, memories[i].moving, memories[i].key.get()});
  }
  Following following = matcher->follow(sought, shift_px);
  shift_px = following.shift_px;
  search.improve(*matcher, std::move(sought), shift_px, &following);
  const auto sought_for = static_cast<double>(tracks.size());
  std::size_t size = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Track track = tracks[i];
    Memory& memory = memories[i];
    const TrackSighting& seen = following.sightings[i];
    if (!seen.found) continue;
    Eigen::Vector2f px = seen.px;
    if (!confirm(memory, seen.key, px) || masked(px)) continue;
    memory.motion_px = px - track.raw_px;
    tracks[size] = {track.id, px, track.age_frames + 1};
    if (size != i) memories[size] = std::move(memory);
    ++size;
  }
  tracks.resize(size);
  memories.resize(size);
  ended_share = 1 - static_cast<double>(size) / sought_for;
}

void Tracker::State::tell_moving() {
  std::vector<Eigen::Vector2f> from, to;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    from.emplace_back(tracks[i].raw_px - memories[i].motion_px);
    to.push_back(tracks[i].raw_px);
  }
  const std::vector<bool> moving = moves_apart(from, to);
  for (std::size_t i = 0; i < tracks.size(); ++i) memories[i].moving = moving[i];
}

void Tracker::State::end_outlines() {
  MotionField rest;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!memories[i].moving) rest.add(tracks[i].raw_px - memories[i].motion_px, memories[i].motion_px);
  }
  if (rest.empty()) return;
  const PyramidLevel &before = matcher->before().level(0), &now = matcher->newest().level(0);
  std::size_t size = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    Memory& m = memories[i];
    const Eigen::Vector2f& px = tracks[i].raw_px;
    if (m.moving && m.outline.add(before, now, px, m.motion_px, rest.near(px - m.motion_px))) continue;
    if (size != i) {
      tracks[size] = tracks[i];
      memories[size] = std::move(m);
    }
    ++size;
  }
  tracks.resize(size);
  memories.resize(size);
}

// The nearest track, if it moves and is beside this place: a new track there will go with it.
const Tracker::State::Memory* Tracker::State::mover_beside(const Eigen::Vector2f& px) const {
  constexpr float kBeside_px = 40.0f;
  float nearest = kBeside_px * kBeside_px;
  const Memory* beside = nullptr;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const float distance2 = (tracks[i].raw_px - px).squaredNorm();
    if (distance2 >= nearest) continue;
    nearest = distance2;
    beside = memories[i].moving ? &memories[i] : nullptr;
  }
  return beside;
}

TrackId Tracker::State::start(const Eigen::Vector2f& px) {
  Memory memory;
  const Memory* beside = mover_beside(px);
  memory.motion_px = beside != nullptr ? beside->motion_px : shift_px;
  memory.moving = beside != nullptr;
  tracks.push_back({TrackId(next_id++), px, 0});
  memory.key = std::make_unique<KeyPatch>();
  take_key(*memory.key, px);
  memories.push_back(std::move(memory));
  return tracks.back().id;
}

void Tracker::State::replenish() {
  int missing = config.max_tracks - static_cast<int>(tracks.size());
  // Where much of the view is new, however many tracks were started beside these, what is new needs its share.
  if (ended_share > kMuchNew) missing = std::max(missing, static_cast<int>(ended_share * config.max_tracks));
  if (missing <= 0) return;
  if (!finder) {
    const int cols = matcher->newest().level(0).cols(), rows = matcher->newest().level(0).rows();
    const int level = corner_level(pyramid_levels(cols, rows, config.levels));
    finder = std::make_unique<CornerFinder>(corner_config(config, cols, mask), cols, rows, level);
    matcher->watch(finder->cells());
  }
  std::vector<Eigen::Vector2f> live_px, moving_px;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    live_px.push_back(tracks[i].raw_px);
    if (memories[i].moving) moving_px.push_back(tracks[i].raw_px);
  }
  const auto scale = static_cast<float>(1 << corner_level(matcher->newest().levels()));
  const auto look_in = [&](std::size_t cell) {
    CellCorners found = matcher->corners(cell);
    if (!mask.empty()) std::erase_if(found.corners, [&](const Corner& c) { return masked(c.px * scale); });
    return found;
  };
  for (const Eigen::Vector2f& px : finder->find(look_in, live_px, moving_px, missing)) {
    start(px);
  }
}

Tracker::Tracker(const TrackerConfig& config, std::unique_ptr<Matcher> matcher)
    : state_(std::make_unique<State>(config, std::move(matcher))) {}
Tracker::~Tracker() = default;

const std::vector<Track>& Tracker::step(const cv::Mat& grey) {
  COSLAM_CHECK(grey.type() == CV_8UC1, "a grey 8-bit image");
  const Pyramid& last = state_->matcher->newest();
  COSLAM_CHECK(last.empty() || (last.level(0).cols() == grey.cols && last.level(0).rows() == grey.rows),
               "constant size");
  state_->matcher->push(grey);
  state_->follow();
  state_->tell_moving();
  state_->end_outlines();
  state_->replenish();
  return state_->tracks;
}

const std::vector<Track>& Tracker::live() const { return state_->tracks; }

std::vector<TrackId> Tracker::add(const std::vector<Eigen::Vector2f>& raw_px, float same_px, int most_new) {
  std::vector<TrackId> ids;
  for (const Eigen::Vector2f& px : raw_px) {
    const auto same = std::find_if(state_->tracks.begin(), state_->tracks.end(),
                                   [&](const Track& t) { return (t.raw_px - px).squaredNorm() < same_px * same_px; });
    if (same != state_->tracks.end()) {
      ids.push_back(same->id);
      continue;
    }
    ids.push_back(!state_->masked(px) && most_new-- > 0 ? state_->start(px) : TrackId());
  }
  return ids;
}

void Tracker::thin(int at_most) {
  auto& tracks = state_->tracks;
  const PyramidLevel& image = state_->matcher->newest().level(0);
  const int surplus = std::min(at_most, static_cast<int>(tracks.size()) - state_->config.max_tracks);
  for (const std::size_t i : crowded_tracks(tracks, image.cols(), image.rows(), surplus)) {
    tracks.erase(tracks.begin() + static_cast<std::ptrdiff_t>(i));
    state_->memories.erase(state_->memories.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void Tracker::resize(const cv::Mat& grey, double ratio) {
  state_->matcher->restart();
  state_->matcher->push(grey);
  state_->finder.reset();
  for (std::size_t i = 0; i < state_->tracks.size(); ++i) {
    Track& track = state_->tracks[i];
    State::Memory& memory = state_->memories[i];
    track.raw_px = scaled_px(track.raw_px, ratio);
    memory.motion_px *= static_cast<float>(ratio);
    memory.key = std::make_unique<KeyPatch>();
    memory.doubts = 0;
    state_->take_key(*memory.key, track.raw_px);
  }
  state_->shift_px *= static_cast<float>(ratio);
}

void Tracker::set_mask(const cv::Mat& mask) {
  COSLAM_CHECK(mask.empty() || mask.type() == CV_8UC1, "a grey 8-bit image");
  state_->mask = mask;
  state_->finder.reset();
}

void Tracker::reset() {
  state_->tracks.clear();
  state_->memories.clear();
  state_->shift_px.setZero();
}

}  // namespace coslam
