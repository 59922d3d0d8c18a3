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
  double side_m = 0;        // of the black square of every tag; 0: unknown, tags are not used
  double max_sigma = 0.02;  // of a map's scale, relative; less certain ones are not used
  double period_s = 0.33;   // between measurements
  TagSizeConfig size;
};

template <class V>
void describe(V& v, TagScaleConfig& c) {
  v.field("max_sigma", c.max_sigma, {0.0001, 1}, "of a scale from printed tags, relative; less certain ones wait");
  v.field("period_s", c.period_s, {0.01, 100}, "between measurements of the tags");
}

struct MeasuredTag {
  TagId tag;
  TagSize size;  // in units of its map
};
auto fields(Like<MeasuredTag> auto& m) { return std::tuple(kept("tag", m.tag), kept("size", m.size)); }

struct TagScaleReport {
  int measured = 0;                 // tags
  int scaled = 0;                   // maps
  std::vector<std::string> doubts;  // why a map with tags gets no scale from them: a sentence each, each said once
};

// Printed tags of known size tell the scale of the maps that they are seen in. A map becomes metric as soon as the
// sides of its tags, as the map has them, are certain enough; again whenever they are twice as certain, when it became
// part of another map, and at the end. A map keeps no scale that its tags contradict: when one of them is not in one
// place, is no square or differs in size from the others, the map counts as not metric until that is over.
class TagScale {
 public:
  explicit TagScale(const TagScaleConfig& config) : config_(config) {}

  // After the poses of the set are known. merged: maps became one in it.
  TagScaleReport step(ScaleEdit& edit, const FrameSet& set, bool merged);
  // By the final poses.
  TagScaleReport finish(ScaleEdit& edit);

  bool in_metres(MapId map) const { return states_.contains(map) && states_.at(map).in_metres; }
  std::set<MapId> in_metres() const;
  // As last measured; empty when no tag was seen in that map.
  std::vector<MeasuredTag> tags(MapId map) const;
  // For the map file.
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
    double sigma = 0;  // relative, of the scale in use
    int doubted = 0;   // measurements in succession
    std::vector<MeasuredTag> tags;
    template <class Archive>
    void serialize(Archive& archive);
  };
  // What the tags of a map say together.
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
  std::set<TagId> twice_;  // in one image
  std::set<std::string> said_;
  bool fresh_ = false;  // sightings since the last measurement
  std::map<MapId, State> states_;
};

}  // namespace coslam
