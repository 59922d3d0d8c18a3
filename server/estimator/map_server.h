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

// Map, and the number of each camera's frames that have a pose in it.
struct MapFrames {
  MapId map;
  std::map<CameraId, int> frames;
};

struct MapServerCounts {
  int frame_sets = 0;
  int merges = 0;
  int inter_pose_calls = 0;
  int refinements = 0;
  std::map<std::string, long> events;  // counts of the stages' reports, summed over the run
};

// Map and the stages that make it: takes one frame set, gives one patch for each of its agents. Pure: no thread, no
// network, no clock but for its stage times. Bundle adjustment is handed out as a job, so that it can run beside. A
// value: a copy is independent of the original.
class MapServer {
 public:
  MapServer(RunId run, const MapServerConfig& config);

  // Sets the workers that share in the work of the stages; they outlive it. The map is the same to the bit.
  void work_with(Workers& workers) { pipeline_.work_with(workers); }

  // Admits an agent; cameras are numbered in the order of calls. A known name with a new run is a restart.
  CameraId admit(const Hello& hello);
  void set_alive(CameraId camera, bool alive) { edit_.set_alive(camera, alive); }

  std::vector<MapPatch> step(const FrameSet& seen);
  // Takes the descriptors of the last image of an agent's run; its frame may come later.
  void take_last_image(CameraId camera, const DescriptorReply& reply) { pipeline_.take_last_image(camera, reply); }
  // Answers a frame that is older than the last set and cannot be used any more.
  MapPatch acknowledge(CameraId camera, const TrackFrame& frame);

  // Returns the job that the last step planned, at most one in flight; its solution is applied at the next step.
  std::optional<RefineJob> take_refine_job() { return pipeline_.stage<MapRole::PlansAdjustment>().take_job(); }
  // Receives the solution; took: time to solve, for the report.
  void give_refined(RefineJob job, BundleResult result, std::chrono::steady_clock::duration took = {});

  // Finishes a run: adjusts what refine.at_end says and sets the scale.
  void finish(const TellProgress& tell = {});
  // Finishes a run with an adjustment of everything, whatever at_end says.
  void finish_whole(const TellProgress& tell = {});

  const Map& map() const { return edit_.map(); }
  // Returns all that outlives the server, as rows, as far as it changed since the last call. They belong together.
  std::vector<Row> changed_rows();
  // Continues the map of these rows; called before anything else. gap_s: how long nothing was seen since. Cameras are
  // recognised by their names, and by their runs if these still live. version: of the rows; those of an older one count
  // as changed. Throws UserError when the rows are damaged.
  void restore(const Tables& tables, double gap_s, int version = kRowsVersion);
  // Takes over the maps of another server, which was restored and has no agents either; those that show a place of an
  // older map are joined to it.
  struct TakenIn {
    Renumbered as;
    std::vector<JoinedMaps> joined;
  };
  TakenIn take_in(const MapServer& other);
  // Newest frame set of what was restored.
  std::optional<SetId> restored_until() const { return restored_until_; }
  // First set of a camera whose frame is of an agent that this server met; empty: none is.
  std::optional<SetId> met_since(CameraId camera) const;
  void meet_all();  // counts all frames as met, of whatever day
  // Shifts all times, see MapEdit::shift_times().
  void shift_times(TimeNs by_ns) { edit_.shift_times(by_ns); }

  // Returns the data that left the map's memory in the last step, for whoever writes files.
  PastPart take_past() { return std::exchange(past_, {}); }

  // Changes of the last step, and events since the one before; after finish(), events since the last step.
  const Journal& journal() const { return edit_.journal(); }
  void keep_journal(bool on) { edit_.journal().enable(on); }
  // State of a stage beyond its report, and its report of the last set, made by default if it did not run; see
  // map_pipeline.h.
  template <class Stage>
  const Stage& stage() const {
    return pipeline_.stage<Stage>();
  }
  template <class Report>
  const Report& report() const {
    return pipeline_.report<Report>();
  }
  // Uncertainty of a camera's path, once its map was adjusted as a whole.
  std::optional<PathError> path_error(CameraId camera) const;
  MapServerCounts counts() const;
  // Memory of the map and the stages by kind, in bytes.
  MemoryUse memory() const;
  const StageTimes& times() const { return report_.times; }
  // Map with the most frames: its frame is that of the result.
  MapId largest_map() const;
  // Maps that hold a frame of some camera, the largest first: one, if all could be joined.
  std::vector<MapFrames> maps() const;
  // True when the lengths of a map are metres.
  bool scale_known(MapId map) const { return in_metres_.contains(map); }
  bool scale_known() const { return scale_known(largest_map()); }
  // Returns warnings for the user since the last call, one sentence each, each once.
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
  std::map<CameraId, SetId> met_since_;  // only cameras that were restored
  std::map<MapId, SetId> adjusted_;      // maps that were adjusted as a whole, up to that set
  std::size_t moves_seen_ = 0;           // number of Map::moves() that were handled
  MapId first_new_map_;                  // maps before it were restored
};

}  // namespace coslam
