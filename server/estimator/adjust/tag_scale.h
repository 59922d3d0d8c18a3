// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/fields.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/solve/tag_size.h"

namespace coslam {

struct TagScaleConfig {
  double side_m = 0;        // side of the black square of every tag; 0: unknown, tags are not used
  double max_sigma = 0.02;  // largest relative standard deviation of a map's scale that is used
  double period_s = 0.33;   // time between measurements
  TagSizeConfig size;
};

template <class V>
void describe(V& v, TagScaleConfig& c) {
  v.field("max_sigma", c.max_sigma, {0.0001, 1}, "of a scale from printed tags, relative; less certain ones wait");
  v.field("period_s", c.period_s, {0.01, 100}, "between measurements of the tags");
}

struct MeasuredTag {
  TagId tag;
  TagSize size;  // lengths in units of its map
};
auto fields(Like<MeasuredTag> auto& m) { return std::tuple(kept("tag", m.tag), kept("size", m.size)); }

struct TagScaleReport {
  int measured = 0;                 // number of tags
  int scaled = 0;                   // number of maps
  std::vector<std::string> doubts;  // reasons why a map with tags gets no scale from them: a sentence each, each once
};

// Determines the scale of maps from printed tags of known size. A map becomes metric as soon as the sides of its tags,
// in lengths of the map, are certain enough; again whenever they are twice as certain, when it became part of another
// map, and at the end. A map keeps no scale that its tags contradict: when one of them is not in one place, is no
// square or differs in size from the others, the map counts as not metric until that is over.
class TagScale {
 public:
  explicit TagScale(const TagScaleConfig& config) : config_(config) {}

  // Measures tags; called after the poses of the set are known. merged: maps were joined in this set.
  TagScaleReport step(ScaleEdit& edit, const FrameSet& set, bool merged);
  // Measures tags at the end of a run, by the final poses.
  TagScaleReport finish(ScaleEdit& edit);

  bool in_metres(MapId map) const { return states_.contains(map) && states_.at(map).in_metres; }
  std::set<MapId> in_metres() const;
  // Tags as last measured; empty when no tag was seen in that map.
  std::vector<MeasuredTag> tags(MapId map) const;
  // Serialises the object for the map file.
  template <class Archive>
  void serialize(Archive& archive);

 private:
  struct TagSighting {
    CameraId camera;
    SetId set;
    std::array<Eigen::Vector2f, 4> calibrated_px;  // undistorted by the calibration alone
    template <class Archive>
    void serialize(Archive& archive);
  };
  struct State {
    bool in_metres = false;
    double sigma = 0;  // relative standard deviation of the scale in use
    int doubted = 0;   // number of successive measurements that contradict the scale
    std::vector<MeasuredTag> tags;
    template <class Archive>
    void serialize(Archive& archive);
  };
  // Common result of a map's tags.
  struct Verdict {
    double side = 0, sigma = 0;  // sigma 0: nothing is known
    std::string doubt;           // a clause; empty: none
  };

  void collect(const FrameSet& set);
  std::map<MapId, std::vector<MeasuredTag>> measure(const Map& map) const;
  Verdict judge(const std::vector<MeasuredTag>& tags) const;
  TagScaleReport update(ScaleEdit& edit, bool at_end);

  TagScaleConfig config_;
  std::map<TagId, std::vector<TagSighting>> seen_;
  std::set<TagId> twice_;  // tags that were twice in one image
  std::set<std::string> reported_;
  bool fresh_ = false;  // sightings since the last measurement
  std::map<MapId, State> states_;
};

}  // namespace coslam
