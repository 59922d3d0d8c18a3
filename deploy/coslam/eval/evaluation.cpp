// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/evaluation.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "common/dataset/calibration.h"
#include "deploy/coslam/eval/moving.h"

namespace coslam::eval {
namespace {

// The surfaces of a simulated scene, seen from the true poses. Its time is that of the sources.
SurfaceAt surfaces_of(const Scene& scene, const Sequence& sequence, const std::vector<AgentPaths>& agents) {
  struct Eye {
    CameraModel camera;
    Trajectory truth;
    double start_s = 0;
  };
  auto eyes = std::make_shared<std::map<std::string, Eye>>();
  for (const AgentPaths& agent : agents) {
    for (const SequenceAgent& listed : sequence.agents) {
      if (listed.name == agent.name && !listed.calibration.empty())
        eyes->emplace(agent.name, Eye{load_calibration(listed.calibration), agent.truth, listed.start_s});
    }
  }
  const TimeNs gap_ns = to_ns(2.5 / sequence.rate_hz);
  return [&scene, eyes, gap_ns](const std::string& agent, TimeNs t_ns,
                                const Eigen::Vector2d& raw_px) -> std::optional<SurfacePoint> {
    const auto eye = eyes->find(agent);
    if (eye == eyes->end()) return std::nullopt;
    const auto cam_from_world = pose_at(eye->second.truth, t_ns, gap_ns);
    if (!cam_from_world) return std::nullopt;
    const double t_s = to_seconds(t_ns) + eye->second.start_s;
    const auto at = [&](const Eigen::Vector2d& px) -> std::optional<RayHit> {
      const auto undistorted_px = eye->second.camera.undistorted_from_raw(px);
      if (!undistorted_px) return std::nullopt;
      const Eigen::Vector3d in_cam = eye->second.camera.normalized_from_pixel(*undistorted_px).homogeneous();
      return scene.cast(cam_from_world->center(), cam_from_world->rotation.conjugate() * in_cam.normalized(), t_s);
    };
    const auto hit = at(raw_px);
    if (!hit) return std::nullopt;
    return SurfacePoint{hit->point,
                        hit->distance_m,
                        scene.body(hit->object),
                        scene.velocity_m_s(scene.spot(*hit, t_s), t_s),
                        scene.body_velocity_m_s(hit->object, t_s),
                        is_on_depth_edge(hit->distance_m, [&](const Eigen::Vector2d& by_px) {
                          const auto beside = at(raw_px + by_px);
                          return beside ? beside->distance_m : std::numeric_limits<double>::infinity();
                        })};
  };
}

// One pass over tracks/<agent>.csv feeds all figures that need the pixels.
class TrackEvaluation {
 public:
  TrackEvaluation(const ResultFolder& result, const Sequence& sequence, const SurfaceAt& surface,
                  const Similarity3& truth_from_map)
      : result_(result),
        surface_(surface),
        truth_from_map_(truth_from_map),
        frame_ns_(sequence.rate_hz > 0 ? to_ns(1 / sequence.rate_hz) : 0) {
    if (sequence.masks) masks_.emplace(*sequence.masks);
    for (const SequenceAgent& agent : sequence.agents) {
      later_ns_[agent.name] = to_ns(agent.start_s - sequence.agents.front().start_s);
    }
    if (std::filesystem::exists(result.dynamic())) dynamic_ = read_dynamic(result.dynamic());
  }

  void read(const std::string& agent) {
    const auto file = result_.tracks(agent);
    if (!std::filesystem::exists(file)) return;
    TrackAges ages;
    for_each_track_row(file, [&](const ResultTrackRow& row) { add(agent, row, ages.age(row)); });
  }

  void report(Evaluation& e) const {
    if (classification_.observations() > 0) {
      e.classification = {classification_.precision(), classification_.recall(), classification_.static_on_moving(),
                          classification_.false_alarm(), classification_.observations()};
    }
    e.dynamic_length_s = median_length_s(dynamic_);
    if (!surface_) return;
    if (static_truth_.points() > 0 && std::filesystem::exists(result_.points())) {
      const auto truth = static_truth_.positions();
      e.points = accuracy_of(read_points(result_.points()), truth, truth_from_map_);
      e.points->without_truth = static_cast<int>(static_truth_.points() - truth.size());
    }
    report_dynamic(e);
    std::optional<ObjectsAt> objects;
    if (std::filesystem::exists(result_.objects())) objects = read_objects(result_.objects());
    e.bodies = bodies_.scores(dynamic_, objects, truth_from_map_, frame_ns_);
  }

  const std::unordered_map<PointId, PointPath>& dynamic() const { return dynamic_; }

 private:
  struct DynamicError {
    PointId point;
    TimeNs t_ns;
    double error_m;
  };

  void add(const std::string& agent, ResultTrackRow row, std::uint32_t age_frames) {
    constexpr std::uint32_t kMinAgeFrames = 15;  // what has just appeared cannot have been told yet
    if (masks_ && age_frames >= kMinAgeFrames) {
      const auto moving = masks_->moving_at(agent, row.frame, row.raw_px);
      if (moving) classification_.add(*moving, row.state);
    }
    if (!surface_) return;
    const auto seen = surface_(agent, row.t_ns, row.raw_px);
    if (!seen) return;
    row.t_ns += later_ns_.at(agent);
    bodies_.add(agent, row, *seen);
    if (row.state == PointState::kStatic) static_truth_.add(row.point, *seen);
    if (row.state == PointState::kDynamic) add_dynamic(row, *seen);
  }

  void add_dynamic(const ResultTrackRow& row, const SurfacePoint& seen) {
    constexpr TimeNs kMaxPathGap_ns = 100'000'000;  // a few frames
    const auto path = dynamic_.find(row.point);
    if (path == dynamic_.end()) return;
    const auto estimate = position_at(path->second, row.t_ns, kMaxPathGap_ns);
    if (!estimate) return;
    dynamic_errors_.push_back({row.point, row.t_ns, (truth_from_map_ * *estimate - seen.position).norm()});
    double& nearest_m = nearest_m_.try_emplace({row.point, row.t_ns}, seen.distance_m).first->second;
    nearest_m = std::min(nearest_m, seen.distance_m);
  }

  void report_dynamic(Evaluation& e) const {
    if (dynamic_errors_.empty()) return;
    std::vector<double> errors_m, relative;
    for (const DynamicError& d : dynamic_errors_) {
      errors_m.push_back(d.error_m);
      relative.push_back(d.error_m / nearest_m_.at({d.point, d.t_ns}));
    }
    e.dynamic_surface_error_m = spread_of(errors_m);
    e.dynamic_relative_error = spread_of(relative);
  }

  const ResultFolder& result_;
  const SurfaceAt& surface_;
  Similarity3 truth_from_map_;
  TimeNs frame_ns_;
  // Of a simulated scene: by how much an agent's played time is behind that of the first, in which the paths of moving
  // points are. Agents whose source begins at another time play at the same time what did not happen together.
  std::map<std::string, TimeNs> later_ns_;
  std::optional<Masks> masks_;
  std::unordered_map<PointId, PointPath> dynamic_;
  Classification classification_;
  StaticTruth static_truth_;
  std::vector<DynamicError> dynamic_errors_;
  std::map<std::pair<PointId, TimeNs>, double> nearest_m_;  // of the cameras that see the point
  BodyTracks bodies_;
};

// Among the agents of the run; who is covered sees nothing.
std::vector<OverlapRow> overlap_of(const Sequence& sequence, const std::vector<AgentPaths>& agents) {
  std::vector<OverlapRow> rows = read_overlap(*sequence.overlap);
  const auto took_part = [&](const std::string& name) {
    return std::any_of(agents.begin(), agents.end(), [&](const AgentPaths& a) { return a.name == name; });
  };
  std::erase_if(rows, [&](const OverlapRow& row) { return !took_part(row.a) || !took_part(row.b); });
  for (const SequenceAgent& agent : sequence.agents) {
    for (const TimeSpan& span : agent.covered) {
      for (OverlapRow& row : rows) {
        const double t_s = to_seconds(row.t_ns);
        if ((row.a == agent.name || row.b == agent.name) && t_s >= span.from_s && t_s < span.to_s) row.share = 0;
      }
    }
  }
  return rows;
}

// Agents that have one map: as the report lists them; where it lists none, those that were ever in one group.
Partition agents_by_map(const ResultFolder& result, const ReportedGroups& groups) {
  const ResultMap common = contents_of(result).maps.front();
  if (common.id == MapId()) return maps_of(groups);
  return {AgentNames(common.agents.begin(), common.agents.end())};
}

void evaluate_groups(Evaluation& e, const ResultFolder& result, const Sequence& sequence,
                     const std::vector<AgentPaths>& agents) {
  if (!std::filesystem::exists(result.groups())) return;
  const ReportedGroups reported = reported_groups(read_groups(result.groups()));
  evaluate_maps(e, agents, agents_by_map(result, reported), sequence.rate_hz);
  if (!sequence.overlap) return;
  const auto rows = overlap_of(sequence, agents);
  if (!rows.empty()) e.groups = score_groups(reported, TrueOverlap(rows));
}

}  // namespace

Evaluation evaluate(const ResultFolder& result, const Sequence& sequence, const std::vector<AgentPaths>& agents,
                    const Scene* scene) {
  Evaluation e = evaluate_paths(agents, sequence.rate_hz);
  e.sequence = sequence.name;
  evaluate_groups(e, result, sequence, agents);

  // Without an alignment no position can be judged; the classification can.
  const bool aligned = e.alignment.target_from_source.has_value();
  const Similarity3 truth_from_map = e.alignment.target_from_source.value_or(Similarity3());
  const SurfaceAt surface = scene != nullptr && aligned ? surfaces_of(*scene, sequence, agents) : SurfaceAt();
  TrackEvaluation tracks(result, sequence, surface, truth_from_map);
  for (const AgentPaths& agent : agents) tracks.read(agent.name);
  tracks.report(e);

  if (sequence.truth_points && aligned) {
    // Its time is that of the first agent.
    const TimeNs later_ns = to_ns(sequence.agents.front().start_s - sequence.agents.front().truth_start_s);
    const auto errors =
        dynamic_errors(tracks.dynamic(), read_truth_points(*sequence.truth_points, later_ns), truth_from_map);
    if (!errors.errors_m.empty()) e.dynamic_error_m = spread_of(errors.errors_m);
  }
  return e;
}

}  // namespace coslam::eval
