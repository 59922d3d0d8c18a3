// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/tag_scale.h"

#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr std::size_t kMostSightings = 512;  // of one tag; beyond, every other one goes
constexpr std::size_t kMostViews = 64;       // of one measurement
constexpr int kDoubtedFor = 3;               // measurements until a doubt counts: poses may still settle
constexpr double kMostSigma = 0.1;           // of the side, for a tag to have a say
constexpr double kDiffer = 3.5;              // standard deviations
constexpr double kPrint = 0.01;              // by which prints of one size differ

std::string name_of(TagId tag) { return "tag " + std::to_string(tag.value); }

template <class Item>
std::vector<Item> spread(const std::vector<Item>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<Item> out;
  for (std::size_t i = 0; i < most; ++i) out.push_back(all[i * (all.size() - 1) / (most - 1)]);
  return out;
}

}  // namespace

void TagScale::collect(const FrameSet& set) {
  for (const CameraFrame& cf : set.frames) {
    const auto& tags = cf.frame.tags;
    for (std::size_t i = 0; i < tags.size(); ++i) {
      if (i > 0 && tags[i].tag == tags[i - 1].tag) twice_.insert(tags[i].tag);
      auto& seen = seen_[tags[i].tag];
      seen.push_back({cf.camera, set.id, tags[i].undistorted_px});
      fresh_ = true;
      if (seen.size() <= kMostSightings) continue;
      for (std::size_t k = 0; 2 * k < seen.size(); ++k) seen[k] = seen[2 * k];
      seen.resize((seen.size() + 1) / 2);
    }
  }
}

std::map<MapId, std::vector<MeasuredTag>> TagScale::measure(const Map& map) const {
  std::map<MapId, std::vector<MeasuredTag>> out;
  for (const auto& [tag, sightings] : seen_) {
    std::map<MapId, std::vector<TagView>> views;
    for (const TagSighting& s : sightings) {
      const MapCamera& c = map.camera(s.camera);
      const FramePose* f = c.frame_at(s.set);
      if (f == nullptr || !f->valid()) continue;
      TagView v{c.id, &c.model, f->cam_from_world, {}, map.gate_sigma_px(c)};
      bool whole = true;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto px = c.lens.undistorted_from_calibrated(c.model, s.calibrated_px[k].cast<double>());
        whole &= px.has_value();
        v.undistorted_px[k] = px.value_or(Eigen::Vector2d::Zero());
      }
      if (whole) views[f->map].push_back(v);
    }
    for (const auto& [in, all] : views) out[in].push_back({tag, measure_tag(spread(all, kMostViews), config_.size)});
  }
  return out;
}

TagScale::Verdict TagScale::judge(const std::vector<MeasuredTag>& tags) const {
  std::vector<const MeasuredTag*> good;
  for (const MeasuredTag& t : tags) {
    if (twice_.contains(t.tag)) return {.doubt = name_of(t.tag) + " is printed twice"};
    if (t.size.status == TagStatus::kNotOnePlace)
      return {.doubt = name_of(t.tag) + " is not in one place: it moved, or is printed twice"};
    if (t.size.status == TagStatus::kNotSquare)
      return {.doubt = name_of(t.tag) + " is no square: it is bent, or printed askew"};
    if (t.size.status == TagStatus::kOk && t.size.sigma < kMostSigma * t.size.side) good.push_back(&t);
  }
  if (good.empty()) return {};
  double information = 0, sum = 0;
  for (const MeasuredTag* t : good) {
    information += 1 / (t->size.sigma * t->size.sigma);
    sum += t->size.side / (t->size.sigma * t->size.sigma);
  }
  const double side = sum / information, sigma = 1 / std::sqrt(information);
  const bool differ = std::ranges::any_of(good, [&](const MeasuredTag* t) {
    return std::abs(t->size.side - side) > kDiffer * std::hypot(t->size.sigma, sigma, kPrint * side);
  });
  if (differ) {
    const auto [small, large] =
        std::ranges::minmax_element(good, {}, [](const MeasuredTag* t) { return t->size.side; });
    return {.doubt = name_of((*large)->tag) + " is larger than " + name_of((*small)->tag) +
                     ", though all should be of one size"};
  }
  return {.side = side, .sigma = sigma};
}

TagScaleReport TagScale::update(ScaleEdit& edit, bool at_end) {
  TagScaleReport report;
  auto measured = measure(edit.map());
  std::erase_if(states_, [&](const auto& s) { return !measured.contains(s.first); });  // merged into another
  for (auto& [in, tags] : measured) {
    State& state = states_[in];
    state.tags = std::move(tags);
    report.measured += static_cast<int>(state.tags.size());
    const Verdict verdict = judge(state.tags);
    if (!verdict.doubt.empty()) {
      if (++state.doubted < kDoubtedFor && !at_end) continue;
      state.in_metres = false;
      std::string sentence = verdict.doubt + "; the size of the map is not taken from tags";
      if (reported_.insert(sentence).second) report.doubts.push_back(std::move(sentence));
      continue;
    }
    state.doubted = 0;
    if (verdict.sigma == 0 || verdict.sigma > config_.max_sigma * verdict.side) continue;
    const double sigma = verdict.sigma / verdict.side;
    if (state.in_metres && sigma > 0.5 * state.sigma && !at_end) continue;
    const double scale = config_.side_m / verdict.side;
    edit.transform(in, {scale, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()}, Why::kScaleKnown);
    for (MeasuredTag& t : state.tags) {
      t.size.side *= scale;
      t.size.sigma *= scale;
    }
    state.in_metres = true;
    state.sigma = sigma;
    ++report.scaled;
  }
  fresh_ = false;
  return report;
}

TagScaleReport TagScale::step(ScaleEdit& edit, const FrameSet& set, bool merged) {
  if (config_.side_m <= 0) return {};
  collect(set);
  const bool due = fresh_ && edit.map().every(config_.period_s);
  return due || (merged && !seen_.empty()) ? update(edit, false) : TagScaleReport{};
}

TagScaleReport TagScale::finish(ScaleEdit& edit) { return seen_.empty() ? TagScaleReport{} : update(edit, true); }

std::set<MapId> TagScale::in_metres() const {
  std::set<MapId> out;
  for (const auto& [id, state] : states_) {
    if (state.in_metres) out.insert(id);
  }
  return out;
}

std::vector<MeasuredTag> TagScale::tags(MapId map) const {
  const auto at = states_.find(map);
  return at == states_.end() ? std::vector<MeasuredTag>{} : at->second.tags;
}

}  // namespace coslam
