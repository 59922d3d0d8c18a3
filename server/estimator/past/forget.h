// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/map/past.h"
#include "server/estimator/pipeline/stage.h"

namespace coslam {

struct ForgetConfig {
  double whole_s = 600;     // newest part of a run that is kept whole
  double block_s = 5;       // time span of a camera's frames that leave memory together
  double near_share = 0.1;  // distance up to which images show one place alike, as a share of the scene's depth
  double near_rad = 0.15;   // rotation up to which images show one place alike
};

template <class V>
void describe(V& v, ForgetConfig& c) {
  v.field("whole_s", c.whole_s, {60, 1e6},
          "the newest part of a run that is kept whole; what is older goes to disk, and is thinned where other images "
          "show the same");
  v.field("near_share", c.near_share, {0, 10}, "of the distance of what is seen, that images of one place are apart");
  v.field("near_rad", c.near_rad, {0, 4}, "of turn between images of one place");
}

// Keeps the memory of a long run bounded by the place that it maps, not by its length. Of everything older than
// whole_s:
// - of images with descriptors that show one place alike, those of the first and of the newest instant keep them and
//   their observations; others keep their observations where fewer show the place;
// - points that fewer than two of these see, and no track follows, are removed;
// - frames of which nothing is kept are given out, for a disk, but for the first and the last of each block: these go
//   on moving with the map, and the others are anchored to them. Each is solved once more before it leaves;
// - paths of moving points are given out.
// Does nothing in a run that is shorter. Thread-compatible.
class Forget {
 public:
  static constexpr std::string_view kName = "forget";
  using Config = ForgetConfig;
  explicit Forget(const ForgetConfig& stage_config) : config(stage_config) {}
  ForgetConfig config;

  // Returns the data that left the map's memory.
  PastPart run(ForgetEdit& edit, HeldFrames held);

 private:
  void judge_images(ForgetEdit& edit, const std::set<ImageKey>& held, std::vector<ImageKey>* dropped);
  void judge_image(ForgetEdit& edit, const ImageKey& image, const std::set<ImageKey>& held,
                   std::vector<ImageKey>* dropped);
  std::vector<ImageKey> alike(const Map& map, const ImageKey& image, double depth) const;
  void drop_image(ForgetEdit& edit, const ImageKey& image, const std::set<ImageKey>& held,
                  std::vector<ImageKey>* dropped);
  void take_frames(ForgetEdit& edit, const std::set<ImageKey>& held, PastPart* past);
  void take_places(ForgetEdit& edit, PastPart* past);
  void remove_points(ForgetEdit& edit);

  SetId cutoff_;  // first set that is kept whole
  SetId judged_, placed_, swept_;
  std::vector<ImageKey> kept_images_;  // past images that keep their observations; sorted
  std::set<ImageKey> own_anchors_;    // first and last frames of blocks, which stay because others are anchored to them
  std::vector<SetId> archived_from_;  // first set of each camera whose frame this object archived
};

}  // namespace coslam
