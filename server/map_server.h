// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/metrics.h"
#include "common/model/map_patch.h"
#include "common/model/session.h"
#include "common/model/track_frame.h"
#include "server/correct/moving_writer.h"
#include "server/correct/patch_writer.h"
#include "server/map/edit.h"
#include "server/stages/classify.h"
#include "server/stages/clock.h"
#include "server/stages/cull.h"
#include "server/stages/fuse.h"
#include "server/stages/group.h"
#include "server/stages/inter_pose.h"
#include "server/stages/key_frame.h"
#include "server/stages/localise.h"
#include "server/stages/map_inter.h"
#include "server/stages/map_intra.h"
#include "server/stages/map_moving.h"
#include "server/stages/meet.h"
#include "server/stages/objects.h"
#include "server/stages/refine.h"
#include "server/stages/register.h"
#include "server/stages/start.h"
#include "server/stages/tag_scale.h"
#include "server/stages/verify.h"

namespace coslam {

struct MapServerConfig {
  MapConfig map;
  StartStageConfig start;
  MeetConfig meet;
  LocaliseConfig localise;
  InterPoseConfig inter_pose;
  VerifyConfig verify;
  ClassifyConfig classify;
  ClockConfig clock;
  RegisterConfig registration;
  MapIntraConfig intra;
  MapInterConfig inter;
  FuseConfig fuse;
  CullConfig cull;
  ObjectsConfig objects;
  GroupConfig group;
  KeyFrameConfig key_frame;
  RefineConfig refine;
  PatchWriterConfig patches;
  TagScaleConfig tags;
  double baseline_m = 0;  // known distance of the first two cameras at the start; 0 = unknown, tags may tell the scale
};

struct MapServerCounts {
  int frame_sets = 0;
  int merges = 0;
  int inter_pose_calls = 0;
  int refinements = 0;
  std::map<std::string, long> events;  // what the stages report, summed
};

// The map and the stages that make it: one frame set in, one patch for each of its agents out. Pure: no thread, no
// network, no clock but for its stage times. Bundle adjustment is handed out as a job, so that it can run beside.
class MapServer {
 public:
  MapServer(RunId run, const MapServerConfig& config);

  // Agents, in the order in which their cameras are to be numbered. A known name with a new run is a restart.
  CameraId admit(const Hello& hello);
  void set_alive(CameraId camera, bool alive);

  std::vector<MapPatch> step(const FrameSet& set);
  // The answer to a frame that is older than the last set and cannot be used any more.
  MapPatch acknowledge(CameraId camera, const TrackFrame& frame);

  // The job that the last step planned, at most one in flight; its solution is taken in at the next step.
  std::optional<RefineJob> take_refine_job();
  // took: to solve, for the report.
  void give_refined(RefineJob job, BundleResult result, std::chrono::steady_clock::duration took = {});

  // The last word: adjusts the whole run and sets the scale.
  void finish();

  const Map& map() const { return edit_.map(); }
  // What the last step changed, with what happened since the one before; after finish(), what came after the last step.
  const Journal& journal() const { return edit_.journal(); }
  void keep_journal(bool on) { edit_.journal().enable(on); }
  const ViewGraph& graph() const { return graph_; }
  // What moves as one, at the last frame set.
  const std::vector<MovingObject>& objects() const { return objects_.objects(); }
  // The same and the moving points, for others.
  const std::vector<MovingState>& moving() const { return moving_; }
  // Offset of the camera's clock from that of the first one it shares moving points with.
  ClockOffset clock_offset(CameraId camera) const { return clocks_.offset(camera); }
  const MapServerCounts& counts() const { return counts_; }
  const StageTimes& times() const { return times_; }
  // The map with the most frames: its frame is that of the result.
  MapId largest_map() const;
  // Maps that hold a frame of some camera: one, if all could be brought together.
  int map_count() const;
  // Whether the lengths of that map are metres.
  bool scale_known() const { return in_metres_.contains(largest_map()); }
  // Printed tags in that map, as last measured.
  std::vector<MeasuredTag> tags() const { return tag_scale_.tags(largest_map()); }
  // What the user should know of, each once: sentences since the last call.
  std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }
  RunId run() const { return run_; }

 private:
  InterPoseReport run_inter_pose(const FrameSet& set);
  void apply_refined();
  void plan_refinement(bool key_frame);
  void set_scale(const FrameSet& set, bool merged);
  void set_scale_by_baseline();
  void take(const TagScaleReport& report);
  std::vector<MapPatch> write_patches(const FrameSet& set, const MeetReport& met);
  void count(const char* event, long n) { counts_.events[event] += n; }

  RunId run_;
  MapServerConfig config_;
  MapEdit edit_;
  ViewGraph graph_;
  Meetings meetings_;
  Grouping grouping_;
  ClockFinder clocks_;
  ObjectFinder objects_;
  MovingWriter moving_writer_;
  std::vector<MovingState> moving_;
  std::map<CameraId, PatchWriter> writers_;
  std::optional<RefineJob> planned_;
  bool in_flight_ = false;
  std::optional<std::pair<RefineJob, BundleResult>> refined_;
  MapId refine_outline_;  // became one of two or was drawn together: adjust all of it; 0 = none
  MapId scaled_map_;      // the one that the baseline gave its scale; 0 = none
  SetId scaled_at_;       // the instant of the known baseline
  TagScale tag_scale_;
  std::set<MapId> in_metres_;
  std::vector<std::string> warnings_;
  MapServerCounts counts_;
  StageTimes times_;
};

}  // namespace coslam
