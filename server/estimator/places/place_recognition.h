// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/base/workers.h"
#include "server/estimator/covisibility/expected_overlap.h"
#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/map/memory.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/places/ask.h"
#include "server/estimator/places/close_loop.h"
#include "server/estimator/places/decide.h"
#include "server/estimator/places/join_maps.h"
#include "server/estimator/places/key_image_database.h"
#include "server/estimator/places/offline_loops.h"
#include "server/estimator/pose/localise.h"
#include "server/estimator/reports/place_recognition_report.h"

namespace coslam {

struct PlaceRecognitionConfig {
  bool loops = true;  // recognise own old places too, beside those that other cameras saw lately
  RecogniseConfig recognise;
  DecideConfig decide;
};

template <class V>
void describe(V& v, PlaceRecognitionConfig& c) {
  v.field("loops", c.loops, "recognise places seen long ago and draw the map together");
  v.field("min_place_inliers", c.decide.min_place_inliers, {8, 1000}, "to place a camera by its descriptors");
  v.field("min_merge_inliers", c.decide.min_merge_inliers, {8, 1000}, "to join two maps or draw one together");
}

// Recognises places and acts on them. A camera without a map is placed in the place's (late, restarted or lost ones). A
// camera of another map brings its map along: the two become one (paper 6.2, step 1). A camera of the same map, whose
// group had parted or which comes back, shows how far the map has drifted, and closes a loop (step 2). Where the map
// says that two cameras see the same, but nothing holds them to each other, points are searched for where they should
// appear. Before anything moves, a meeting has to be confirmed by a second image.
class PlaceRecognition {
 public:
  static constexpr std::string_view kName = "place_recognition";
  using Config = PlaceRecognitionConfig;
  explicit PlaceRecognition(const PlaceRecognitionConfig& stage_config)
      : config(stage_config), places_(stage_config.recognise), judge_(stage_config.decide) {}
  PlaceRecognitionConfig config;

  // Recognises places in this set's images; called when the set's poses are known.
  PlaceRecognitionReport run(PlaceRecognitionEdit& edit, const FrameSet& set, Last<ViewGraph> last,
                             const ExpectedOverlapReport& expected, const LocaliseConfig& localise,
                             const AskConfig& ask, Workers& workers = Workers::alone());
  // Remembers the last image of a run as a known place. False: its frame is still to come.
  bool remember_last(KeyImageEdit& edit, CameraId id, const DescriptorReply& reply);
  // Returns the frames of the newest loop constraints, which must not be forgotten because they hold the map together.
  std::vector<ImageKey> held_frames() const;
  // Forgets key images.
  void forget(const std::vector<ImageKey>& views) { places_.forget(views); }
  // Takes over key images and loops of a map that was taken in.
  void take_in(const PlaceRecognition& other, const Renumbered& renumbered);
  const KeyImageDatabase& places() const { return places_; }
  // Maps in which places are known, as of a short time ago.
  const std::set<MapId>& remembered_maps() const { return remembered_maps_; }
  // What a camera could add to a place that is not confirmed yet.
  Verification::Waiting waiting(const Map& map, CameraId camera) const { return judge_.waiting(map, camera); }
  // Joins maps at the end of a run, by places that were not recognised in the run.
  std::vector<JoinedMaps> join_all(PlaceRecognitionEdit& edit) const { return join_all_maps(edit, places_); }
  OfflineLoopsReport close_loops_offline(PlaceRecognitionEdit& edit, MapId map_id);
  void add_memory(MemoryUse* use) const { (*use)["places"] += places_.bytes(); }
  // Writes as rows what outlives the server and was not written before; and reads it.
  void save(std::vector<Row>* rows);
  void restore(const Tables& tables);

 private:
  // What is the same for all images of a set.
  struct Given {
    const ViewGraph& graph;
    const ExpectedOverlapReport& expected;
    const LocaliseConfig& localise;
    const AskConfig& ask;
  };
  // Known places that an image shows, in the map as it is now.
  struct Look {
    DescribedImage image;
    ExpectedPlace expected;
    std::optional<PlaceMatch> seen;
  };
  // Looks first where the map expects shared points; by appearance only when these are not found in place.
  Look look(const Map& map, const CameraFrame& frame, const Given& given) const;
  // Looks for points of the cameras that should see the same, as they were seen lately.
  ExpectedPlace find_expected(const Map& map, const DescribedImage& image, const DescriptorReply& reply,
                              const Given& given) const;
  // Tells whether a key image may be compared: one of another map, of long ago (with `loops`), or of a camera that is
  // in another group or expected to see the same.
  bool may_ask(const Map& map, const MapCamera& camera, const Given& given, const KeyImage& image, MapId in) const;
  // Does to the map what the judge decides, one case for each action, and counts it; true when that changed the map.
  bool act(PlaceRecognitionEdit& edit, const Look& look, const Given& given, PlaceRecognitionReport* report);

  AwaitedDescriptors awaited_;
  KeyImageDatabase places_;
  PlaceJudge judge_;
  std::set<MapId> remembered_maps_;
  std::vector<LoopConstraint> loops_;
};

}  // namespace coslam
