// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/sim_run.h"

#include <utility>

#include "common/geometry/alignment.h"
#include "tests/support/sim_map.h"

namespace coslam::test {
namespace {

AgentConfig agent_config(const TrackingConfig& tracking) {
  AgentConfig config;
  config.descriptor_features = 400;
  config.tracker.max_tracks = tracking.max_tracks;
  config.tags.family = tag_families().back();  // whichever: the tracker knows what hangs where
  return config;
}

}  // namespace

SimAgent::SimAgent(const SimWorld& world, CameraPath path, const TrackingConfig& tracking, const std::string& name,
                   RunId run, TimeNs clock_behind_ns)
    : SimAgent(std::make_unique<SimTracker>(world, std::move(path), tracking, name, run), tracking.calibration(),
               agent_config(tracking)) {
  tracker_->set_clock_behind(clock_behind_ns);
}

SimAgent::SimAgent(std::unique_ptr<SimTracker> tracker, const CameraModel& calibration, const AgentConfig& config)
    : tracker_(tracker.get()), agent_(tracker_->name(), tracker_->run(), calibration, config, std::move(tracker)) {}

CameraFrame SimAgent::step(CameraId camera, TimeNs t_ns) {
  agent_.track({FrameId(next_frame_++), t_ns, {}});
  AgentOutput out = agent_.finish(std::exchange(patches_, {}));
  return {camera, std::move(out.frame), std::move(out.patches), std::move(out.descriptors)};
}

SimRun::SimRun(const SimWorld& world, const MapServerConfig& server, const TrackingConfig& tracking)
    : world_(world), tracking_(tracking), server_config_(server), server_(RunId(7), server) {
  refiner_.emplace(false);
}

CameraId SimRun::add_agent(const CameraPath& path, TimeNs clock_behind_ns) {
  Slot slot{.path = path, .name = "cam" + std::to_string(slots_.size()), .clock_behind_ns = clock_behind_ns};
  slot.agent = make_agent(slot, RunId(100 + slots_.size()));
  const CameraId id = server_.admit(slot.agent->tracker().hello());
  slots_.push_back(std::move(slot));
  return id;
}

std::unique_ptr<SimAgent> SimRun::make_agent(const Slot& slot, RunId run) const {
  auto agent = std::make_unique<SimAgent>(world_, slot.path, tracking_, slot.name, run, slot.clock_behind_ns);
  for (const auto& [tag, corners] : tags_) agent->tracker().hang(tag, corners);
  return agent;
}

void SimRun::stop(CameraId camera) {
  slots_[camera.value].running = false;
  server_.set_alive(camera, false);
}

void SimRun::stall(CameraId camera) { slots_[camera.value].running = false; }
void SimRun::resume(CameraId camera) { slots_[camera.value].running = true; }

void SimRun::restart(CameraId camera) {
  Slot& s = slots_[camera.value];
  const RunId run(100 + camera.value + 1000U * static_cast<unsigned>(s.runs++));
  s.agent = make_agent(s, run);
  s.running = true;
  server_.admit(s.agent->tracker().hello());
}

void SimRun::restart_server() {
  server_ = MapServer(RunId(server_.run().value + 1), server_config_);
  refiner_.emplace(false);
  for (const Slot& s : slots_) server_.admit(s.agent->tracker().hello());
}

void SimRun::save() {
  saved_ns_ = server_.map().now_ns();
  for (Row& row : server_.changed_rows()) {
    if (row.bytes.empty()) {
      saved_[row.table].erase(row.key);
    } else {
      saved_[row.table][row.key] = std::move(row.bytes);
    }
  }
}

void SimRun::restore_server(int missed_sets) {
  for (int i = 0; i < missed_sets; ++i) look();
  server_ = MapServer(RunId(server_.run().value + 1), server_config_);
  server_.restore(saved_, to_seconds(kPeriodNs * next_set_ - saved_ns_));
  next_set_ = std::max(next_set_, server_.map().now().value + 1);
  refiner_.emplace(false);
  for (const Slot& s : slots_) server_.admit(s.agent->tracker().hello());
}

// The agents' next images.
FrameSet SimRun::look() {
  FrameSet set{SetId(next_set_), kPeriodNs * next_set_, {}};
  ++next_set_;
  for (std::size_t c = 0; c < slots_.size(); ++c) {
    if (!slots_[c].running) continue;
    set.frames.push_back(slots_[c].agent->step(CameraId(static_cast<std::uint16_t>(c)), set.t_ns));
  }
  return set;
}

void SimRun::step(int sets) {
  for (int i = 0; i < sets; ++i) {
    const FrameSet set = look();
    exchange_refinement();
    last_patches_ = server_.step(set);
    last_set_ = set;
    for (std::size_t k = 0; k < set.frames.size(); ++k) {
      slots_[set.frames[k].camera.value].agent->give(last_patches_[k]);
    }
    if (auto job = server_.take_refine_job()) {
      refiner_->start(std::move(*job), set.id);
    }
  }
}

void SimRun::exchange_refinement() {
  if (auto solved = refiner_->take_due(SetId(next_set_ - 1), true)) {
    server_.give_refined(std::move(solved->job), std::move(solved->result), solved->took);
  }
}

int SimRun::world_point(const MapPoint& point) const {
  for (const BoundTrack& b : point.bound) {
    const int at = slots_[b.camera.value].agent->tracker().point_of(b.track);
    if (at >= 0) return at;
  }
  for (const KeyObservation& o : point.key_observations) {
    const int at = slots_[o.camera.value].agent->tracker().point_of(o.track);
    if (at >= 0) return at;
  }
  return -1;
}

std::vector<double> SimRun::point_nees() const {
  std::vector<Eigen::Vector3d> mapped, truth_points;
  std::vector<Eigen::Matrix3d> covariances;
  for (const auto& [id, p] : map().points()) {
    const int point = world_point(p);
    if (point < 0 || p.map != server_.largest_map()) continue;
    mapped.push_back(p.position);
    truth_points.push_back(world_.position(point));
    covariances.push_back(p.covariance);
  }
  std::vector<double> values;
  Alignment a = align_points(truth_points, mapped, AlignmentScale::kFree);
  for (int round = 0; round < 4 && a.target_from_source; ++round) {
    values.clear();
    std::vector<Eigen::Vector3d> good_truth, good_mapped;
    for (std::size_t i = 0; i < mapped.size(); ++i) {
      values.push_back(nees(mapped[i] - *a.target_from_source * truth_points[i], covariances[i]));
      if (values.back() > 30 || covariances[i].trace() > 1e-3) continue;  // the frame is that of the good ones
      good_truth.push_back(truth_points[i]);
      good_mapped.push_back(mapped[i]);
    }
    a = align_points(good_truth, good_mapped, AlignmentScale::kFree);
  }
  return values;
}

PathError SimRun::path_error(std::optional<CameraId> only) const {
  PathError error;
  const MapId of = server_.largest_map();
  std::vector<Eigen::Vector3d> estimated, truth_centers;
  for (const MapCamera& c : map().cameras()) {
    if (only && c.id != *only) continue;
    std::optional<Eigen::Vector3d> last;
    for (const FramePose& f : c.frames) {
      ++error.all_frames;
      const Eigen::Vector3d center = truth(c.id, f.capture_ns).center();
      if (last) error.path_m += (center - *last).norm();
      last = center;
      if (f.map != of) continue;
      estimated.push_back(f.cam_from_world.center());
      truth_centers.push_back(center);
    }
  }
  error.frames = static_cast<int>(estimated.size());
  const Alignment a = align_points(estimated, truth_centers, AlignmentScale::kFree);
  error.ate = a.target_from_source ? a.rmse : 1e9;
  if (a.target_from_source) error.truth_from_map = *a.target_from_source;
  error.scale = error.truth_from_map.scale;
  return error;
}

}  // namespace coslam::test
