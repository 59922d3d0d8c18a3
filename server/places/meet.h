// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/covisibility/group.h"
#include "server/map/edit.h"
#include "server/pipeline/stage.h"
#include "server/places/close_loop.h"
#include "server/places/confirm.h"
#include "server/places/recognise.h"
#include "server/pose/localise.h"

namespace coslam {

struct MeetConfig {
  RecogniseConfig recognise;
  bool loops = true;            // own old places too, beside those that other cameras saw lately
  int min_merge_inliers = 25;   // to join two maps, or to draw one together
  double soon_s = 0.2;          // between requests for descriptors of a camera that is to be placed, that waits to
                                // confirm a meeting, or should see what nothing holds it to
  double apart_period_s = 0.5;  // while there are several maps
  double min_overlap = 0.08;    // of both views, by the map, for that
  double least_period_s = 1.0;  // between requests because the view changed
  double images_per_s = 0.5;    // of a camera that has a map, in the long run: descriptors cost 10 kB an image
  double image_burst = 3;       // and so many ahead of that
  double turned_rad = 0.3;      // of the optical axis, or
  double moved_share = 0.5;     // of the median depth: the view is another one
  double slack_sigma = 2.0;     // known points this close to where they are expected need no correction of poses
};

template <class V>
void describe(V& v, MeetConfig& c) {
  v.field("loops", c.loops, "recognise places seen long ago and draw the map together");
  v.field("min_place_inliers", c.recognise.min_inliers, {8, 1000}, "to place a camera by its descriptors");
  v.field("min_merge_inliers", c.min_merge_inliers, {8, 1000}, "to join two maps or draw one together");
  v.field("soon_s", c.soon_s, {0.01, 100}, "between requests for descriptors where much hangs on them");
  v.field("apart_period_s", c.apart_period_s, {0.01, 100}, "the same while there are several maps");
  v.field("min_overlap", c.min_overlap, {0, 1},
          "of both views, by the map, that two cameras should know of each other by");
  v.field("least_period_s", c.least_period_s, {0.01, 100}, "the same because the view changed");
  v.field("images_per_s", c.images_per_s, {0, 100}, "described by a camera that has a map, in the long run");
}

struct MeetReport {
  int described = 0;  // images that came with descriptors
  int sightings = 0;  // known places recognised
  int placed = 0, merged = 0, closed = 0, linked = 0, expected = 0, doubted = 0;
  MapId to_adjust;  // the last map that was made of two or drawn together; 0 = none
  std::map<CameraId, DescriptorRequest> requests;

  void count(auto&& add) const {
    add("images_described", described);
    add("sightings", sightings);
    add("placed", placed);
    add("merges", merged);
    add("loops_closed", closed);
    add("places_linked", linked);
    add("places_expected", expected);
    add("meetings_doubted", doubted);
  }
};

// Cameras that recognise a place. One without a map is placed there (late, restarted or lost ones). One of another map
// brings its map along: the two become one (paper 6.2, step 1). One of the same map, whose group had parted or which
// comes back, shows how far the map has drifted, and draws it together (step 2). Where the map says that two
// cameras see the same, but nothing holds them to each other, both are asked at once, and points are looked for where
// they should appear. Before anything
// moves, a meeting has to be confirmed by a second image.
class Meetings {
 public:
  static constexpr std::string_view kName = "meet";
  using Config = MeetConfig;
  explicit Meetings(const MeetConfig& of) : config(of), places_(of.recognise) {}
  MeetConfig config;

  // After the set's poses are known.
  MeetReport run(MapEdit& edit, const FrameSet& set, Last<ViewGraph> graph, const LocaliseConfig& localise,
                 const GroupConfig& group);

 private:
  // When a camera was last asked for descriptors, last gave them, and last saw a known place in too few features to act
  // on it.
  struct Described {
    std::optional<SetId> asked, at, hinted;
    double images_to_spare = 0;
    std::optional<TimeNs> counted_ns;
  };

  void expect(const Map& map, const FrameSet& set, const ViewGraph& graph, int min_holding);
  double slack_px(const Map& map, const MapCamera& camera) const {
    return config.slack_sigma * map.gate_sigma_px(camera);
  }
  ExpectedPlace find_expected(const Map& map, const CameraFrame& frame) const;
  bool may_ask(const Map& map, const MapCamera& camera, const ViewGraph& graph, const KeyImage& image, MapId in) const;
  void recognise(MapEdit& edit, const CameraFrame& frame, const ViewGraph& graph, const LocaliseConfig& localise,
                 MeetReport* report);
  void draw_together(MapEdit& edit, const MapCamera& camera, const Recognition& seen, const ViewGraph& graph,
                     MeetReport* report);
  void join(MapEdit& edit, const MapCamera& camera, const Recognition& seen, const Similarity3& in_from_own,
            MeetReport* report);
  void close(MapEdit& edit, const MapCamera& camera, const Recognition& seen, const Similarity3& in_from_own,
             const ViewGraph& graph, MeetReport* report);
  bool afford(Described& d, TimeNs now_ns, bool confirm) const;
  bool view_changed(const Map& map, const MapCamera& camera, SetId since, double share) const;
  DescriptorRequest request(const Map& map, const MapCamera& camera, bool apart, bool parted);

  PlaceMemory places_;
  Verification verification_;
  std::map<CameraId, Described> described_;
  std::map<CameraId, std::vector<CameraId>> expected_;  // whose view a camera's should overlap
  std::vector<LoopConstraint> loops_;
};

}  // namespace coslam
