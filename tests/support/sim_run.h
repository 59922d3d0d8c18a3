// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "agent/agent.h"
#include "server/estimator/map_server.h"
#include "server/estimator/refiner.h"
#include "tests/support/sim_tracker.h"
#include "tests/support/sim_world.h"

namespace coslam::test {

// The product's agent on a simulated tracker.
class SimAgent {
 public:
  SimAgent(const SimWorld& world, CameraPath path, const TrackingConfig& tracking, const std::string& name, RunId run,
           TimeNs clock_behind_ns = 0);

  // The next image, after the patches given since the last.
  CameraFrame step(CameraId camera, TimeNs t_ns);
  void give(MapPatch patch) { patches_.push_back(std::move(patch)); }

  SimTracker& tracker() { return *tracker_; }
  const SimTracker& tracker() const { return *tracker_; }
  const LocalMap& local_map() const { return agent_.local_map(); }
  PoseState pose_state() const { return agent_.pose_state(); }
  const PoseResult& pose() const { return agent_.pose(); }

 private:
  SimAgent(std::unique_ptr<SimTracker> tracker, const CameraModel& calibration, const AgentConfig& config);

  SimTracker* tracker_;  // the agent's
  Agent agent_;
  std::vector<MapPatch> patches_;
  std::uint32_t next_frame_ = 0;
};

// How far the estimated path of some cameras is from truth, after the best similarity.
struct PathError {
  double ate = 0;      // rmse of the camera centres, metres of truth
  double path_m = 0;   // true length of the path, all cameras together
  int frames = 0;      // with a pose in the largest map
  int all_frames = 0;  // that were taken
  double scale = 0;    // truth over map
  Similarity3 truth_from_map;
};

// The first two cameras start so far apart.
inline MapServerConfig known_baseline(double baseline_m) {
  MapServerConfig config;
  config.of<ScaleConfig>().baseline_m = baseline_m;
  return config;
}

// Printed tags are so large.
inline MapServerConfig known_tags(double side_m) {
  MapServerConfig config;
  config.of<ScaleConfig>().tags.side_m = side_m;
  return config;
}

// Agents and a map server in lock-step in one process, with the bundle adjustment taken in a fixed number of frame sets
// after its plan, as the server's loop does. Deterministic.
class SimRun {
 public:
  SimRun(const SimWorld& world, const MapServerConfig& server, const TrackingConfig& tracking = {});

  // Joins now. Cameras are numbered in this order.
  // clock_behind_ns: dates its images so much earlier than they are taken.
  CameraId add_agent(const CameraPath& path, TimeNs clock_behind_ns = 0);
  // A printed tag, for the agents that join from now on. The same one may hang in several places.
  void hang(TagId tag, const std::array<Eigen::Vector3d, 4>& corners) { tags_.emplace(tag, corners); }
  void stop(CameraId camera);   // ends like a process that was told to
  void stall(CameraId camera);  // no frames until it is started again; nobody is told
  void resume(CameraId camera);
  void restart(CameraId camera);  // as another run of the same name
  void restart_server();          // another process, with an empty map; the agents go on
  void save();                    // the map, as its file would be
  // The server is killed; after so many frame sets that nobody answers there is another one, with the map as saved.
  void restore_server(int missed_sets);
  void step(int sets = 1);

  MapServer& server() { return server_; }
  const Map& map() const { return server_.map(); }
  SimAgent& agent(CameraId camera) { return *slots_[camera.value].agent; }
  const std::vector<MapPatch>& last_patches() const { return last_patches_; }
  const FrameSet& last_set() const { return last_set_; }
  // Truth of any frame of any run of this camera.
  Rigid3 truth(CameraId camera, TimeNs t_ns) const { return slots_[camera.value].agent->tracker().truth(t_ns); }
  // World point behind a map point; -1 when no track of the present runs tells.
  int world_point(const MapPoint& point) const;
  // Of every point of the largest map whose world point is known, in the map's own frame: the similarity between the
  // two is that of the points themselves, so that the map's free frame and scale do not count as their error.
  std::vector<double> point_nees() const;
  // empty: all cameras.
  PathError path_error(std::optional<CameraId> only = std::nullopt) const;

 private:
  struct Slot {
    std::unique_ptr<SimAgent> agent;
    CameraPath path;
    std::string name;
    TimeNs clock_behind_ns = 0;
    bool running = true;
    int runs = 1;
  };
  std::unique_ptr<SimAgent> make_agent(const Slot& slot, RunId run) const;
  void exchange_refinement();
  FrameSet look();

  const SimWorld& world_;
  TrackingConfig tracking_;
  MapServerConfig server_config_;
  MapServer server_;
  std::vector<Slot> slots_;
  std::multimap<TagId, std::array<Eigen::Vector3d, 4>> tags_;
  std::uint32_t next_set_ = 0;
  std::optional<Refiner> refiner_;
  std::vector<MapPatch> last_patches_;
  FrameSet last_set_;
  Tables saved_;
  TimeNs saved_ns_ = 0;  // of the newest frame set in it
};

}  // namespace coslam::test
