// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/model/map_patch.h"
#include "common/model/session.h"
#include "common/model/track_frame.h"
#include "server/estimator/map/memory.h"
#include "server/estimator/map_pipeline.h"
#include "server/estimator/places/join_maps.h"

namespace coslam {

// A map, and how many frames of whom have a pose in it.
struct MapFrames {
  MapId map;
  std::map<CameraId, int> frames;
};

struct MapServerCounts {
  int frame_sets = 0;
  int merges = 0;
  int inter_pose_calls = 0;
  int refinements = 0;
  std::map<std::string, long> events;  // what the stages report, summed
};

// The map and the stages that make it: one frame set in, one patch for each of its agents out. Pure: no thread, no
// network, no clock but for its stage times. Bundle adjustment is handed out as a job, so that it can run beside. A
// value: a copy goes on like the original.
class MapServer {
 public:
  MapServer(RunId run, const MapServerConfig& config);

  // Who shares in the work of its stages; they outlive it. The map is the same to the bit.
  void work_with(Workers& workers) { pipeline_.work_with(workers); }

  // Agents, in the order in which their cameras are to be numbered. A known name with a new run is a restart.
  CameraId admit(const Hello& hello);
  void set_alive(CameraId camera, bool alive) { edit_.set_alive(camera, alive); }

  std::vector<MapPatch> step(const FrameSet& seen);
  // What the last image of an agent's run shows; its frame may come later.
  void take_last_image(CameraId camera, const DescriptorReply& reply) { pipeline_.take_last_image(camera, reply); }
  // The answer to a frame that is older than the last set and cannot be used any more.
  MapPatch acknowledge(CameraId camera, const TrackFrame& frame);

  // The job that the last step planned, at most one in flight; its solution is taken in at the next step.
  std::optional<RefineJob> take_refine_job() { return pipeline_.stage<MapRole::PlansAdjustment>().take_job(); }
  // took: to solve, for the report.
  void give_refined(RefineJob job, BundleResult result, std::chrono::steady_clock::duration took = {});

  // The last word: adjusts what refine.at_end says and sets the scale.
  void finish(const TellProgress& tell = {});
  // The same of everything, whatever at_end says.
  void finish_whole(const TellProgress& tell = {});

  const Map& map() const { return edit_.map(); }
  // All that outlives the server, as rows, as far as it changed since the last call. They belong together.
  std::vector<Row> changed_rows();
  // Goes on with the map of these rows; before anything else. gap_s: how long nothing was seen since. Cameras are
  // known again by their names, and by their runs if these still live. version: of the rows; those of an older one
  // count as changed. Throws UserError when the rows are none.
  void restore(const Tables& tables, double gap_s, int version = kRowsVersion);
  // Maps of another server, which was restored and has no agents either, become maps of this one; those that show a
  // place of an older map become part of that one.
  struct TakenIn {
    Renumbered as;
    std::vector<JoinedMaps> joined;
  };
  TakenIn take_in(const MapServer& other);
  // The newest frame set of what was restored.
  std::optional<SetId> restored_until() const { return restored_until_; }
  // The frames of a camera from this set on are of agents that this server met; empty: none are.
  std::optional<SetId> met_since(CameraId camera) const;
  void meet_all();  // all frames count, of whatever day
  // See MapEdit::shift_times().
  void shift_times(TimeNs by_ns) { edit_.shift_times(by_ns); }

  // What left the map's memory in the last step: whoever keeps files writes it down.
  PastPart take_past() { return std::exchange(past_, {}); }

  // What the last step changed, with what happened since the one before; after finish(), what came after the last step.
  const Journal& journal() const { return edit_.journal(); }
  void keep_journal(bool on) { edit_.journal().enable(on); }
  // What a stage knows beyond its report, and the report of the last set that it ran in; see map_pipeline.h.
  template <class Stage>
  const Stage& stage() const {
    return pipeline_.stage<Stage>();
  }
  template <class Report>
  const Report& report() const {
    return pipeline_.report<Report>();
  }
  // How uncertain a camera's path is, once its map was adjusted as a whole.
  std::optional<PathError> path_error(CameraId camera) const;
  MapServerCounts counts() const;
  // What the map and the stages keep, by what it is for; bytes.
  MemoryUse memory() const;
  const StageTimes& times() const { return report_.times; }
  // The map with the most frames: its frame is that of the result.
  MapId largest_map() const;
  // Maps that hold a frame of some camera, the largest first: one, if all could be brought together.
  std::vector<MapFrames> maps() const;
  // Whether the lengths of a map are metres.
  bool scale_known(MapId map) const { return in_metres_.contains(map); }
  bool scale_known() const { return scale_known(largest_map()); }
  // What the user should know of, each once: sentences since the last call.
  std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }
  RunId run() const { return run_.id; }

 private:
  void take(const ScaleReport& scale);
  FrameSet by_lenses(const FrameSet& set) const;
  void tell_of_lenses();
  void note_adjusted();
  void close_loops_offline();
  void adjust(std::optional<SetId> since, const TellProgress& tell);

  ServerRun run_;
  MapServerConfig config_;
  MapEdit edit_;
  MapPipeline pipeline_;
  PipelineReport report_;
  PastPart past_;
  int frame_sets_ = 0;
  std::set<MapId> in_metres_;
  PathErrors path_errors_;
  std::vector<std::string> warnings_;
  std::set<CameraId> lenses_told_;
  std::set<CameraId> breathing_told_;
  MapRows rows_;
  std::optional<SetId> restored_until_;
  std::size_t restored_cameras_ = 0;
  std::map<CameraId, SetId> met_since_;  // of cameras that were restored
  std::map<MapId, SetId> adjusted_;      // maps that were adjusted as a whole, up to that set
  std::size_t moves_seen_ = 0;           // of the map's
  MapId first_new_map_;                  // later ones were not restored
};

}  // namespace coslam
