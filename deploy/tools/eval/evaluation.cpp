// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/eval/evaluation.h"

#include <map>

#include "common/dataset/calibration.h"
#include "deploy/tools/eval/moving.h"

namespace coslam::eval {
namespace {

// The surfaces of a simulated scene, seen from the true poses.
SurfaceAt surfaces_of(const Scene& scene, const Sequence& sequence, const std::vector<AgentPaths>& agents) {
  struct Eye {
    CameraModel camera;
    Trajectory truth;
  };
  auto eyes = std::make_shared<std::map<std::string, Eye>>();
  for (const AgentPaths& agent : agents) {
    for (const SequenceAgent& listed : sequence.agents) {
      if (listed.name == agent.name) eyes->emplace(agent.name, Eye{load_calibration(listed.calibration), agent.truth});
    }
  }
  const TimeNs gap_ns = to_ns(2.5 / sequence.rate_hz);
  return [&scene, eyes, gap_ns](const std::string& agent, TimeNs t_ns,
                                const Eigen::Vector2d& raw_px) -> std::optional<SurfacePoint> {
    const auto eye = eyes->find(agent);
    if (eye == eyes->end()) return std::nullopt;
    const auto cam_from_world = pose_at(eye->second.truth, t_ns, gap_ns);
    const auto undistorted_px = eye->second.camera.undistorted_from_raw(raw_px);
    if (!cam_from_world || !undistorted_px) return std::nullopt;
    const Eigen::Vector3d in_cam = eye->second.camera.normalized_from_pixel(*undistorted_px).homogeneous();
    const Eigen::Vector3d direction = cam_from_world->rotation.conjugate() * in_cam.normalized();
    const auto hit = scene.cast(cam_from_world->center(), direction, to_seconds(t_ns));
    return hit ? std::optional(SurfacePoint{hit->point, hit->distance_m}) : std::nullopt;
  };
}

// One pass over tracks/<agent>.csv feeds all figures that need the pixels.
class TrackEvaluation {
 public:
  TrackEvaluation(const ResultFolder& result, const Sequence& sequence, const SurfaceAt& surface,
                  const Similarity3& truth_from_map)
      : result_(result), surface_(surface), truth_from_map_(truth_from_map) {
    if (sequence.masks) masks_.emplace(*sequence.masks);
    if (std::filesystem::exists(result.dynamic())) dynamic_ = read_dynamic(result.dynamic());
  }

  void read(const std::string& agent) {
    const auto file = result_.tracks(agent);
    if (std::filesystem::exists(file)) for_each_track_row(file, [&](const ResultTrackRow& row) { add(agent, row); });
  }

  void report(Evaluation& e) const {
    if (classification_.observations() > 0) {
      e.classification = {classification_.precision(), classification_.recall(), classification_.static_on_moving(),
                          classification_.observations()};
    }
    if (!surface_) return;
    if (static_truth_.points() > 0 && std::filesystem::exists(result_.points())) {
      const auto truth = static_truth_.positions();
      e.points = accuracy_of(read_points(result_.points()), truth, truth_from_map_);
      e.points->without_truth = static_cast<int>(static_truth_.points() - truth.size());
    }
    if (!dynamic_errors_m_.empty()) e.dynamic_surface_error_m = spread_of(dynamic_errors_m_);
  }

  const std::unordered_map<PointId, PointPath>& dynamic() const { return dynamic_; }

 private:
  void add(const std::string& agent, const ResultTrackRow& row) {
    if (!row.state) return;
    if (masks_) {
      const auto moving = masks_->moving_at(agent, row.frame, row.raw_px);
      if (moving) classification_.add(*moving, *row.state);
    }
    if (!surface_) return;
    if (row.state == PointState::kStatic) {
      if (const auto seen = surface_(agent, row.t_ns, row.raw_px)) static_truth_.add(row.point, *seen);
    } else if (row.state == PointState::kDynamic) {
      add_dynamic(agent, row);
    }
  }

  void add_dynamic(const std::string& agent, const ResultTrackRow& row) {
    constexpr TimeNs kMaxGap_ns = 100'000'000;  // a few frames
    const auto path = dynamic_.find(row.point);
    if (path == dynamic_.end()) return;
    const auto estimate = position_at(path->second, row.t_ns, kMaxGap_ns);
    const auto seen = surface_(agent, row.t_ns, row.raw_px);
    if (estimate && seen) dynamic_errors_m_.push_back((truth_from_map_ * *estimate - seen->position).norm());
  }

  const ResultFolder& result_;
  const SurfaceAt& surface_;
  Similarity3 truth_from_map_;
  std::optional<Masks> masks_;
  std::unordered_map<PointId, PointPath> dynamic_;
  Classification classification_;
  StaticTruth static_truth_;
  std::vector<double> dynamic_errors_m_;
};

}  // namespace

Evaluation evaluate(const ResultFolder& result, const Sequence& sequence, const std::vector<AgentPaths>& agents,
                    const Scene* scene) {
  Evaluation e = evaluate_paths(agents, sequence.rate_hz);
  e.sequence = sequence.name;

  // Without an alignment no position can be judged; the classification can.
  const bool aligned = e.alignment.target_from_source.has_value();
  const Similarity3 truth_from_map = e.alignment.target_from_source.value_or(Similarity3());
  const SurfaceAt surface = scene != nullptr && aligned ? surfaces_of(*scene, sequence, agents) : SurfaceAt();
  TrackEvaluation tracks(result, sequence, surface, truth_from_map);
  for (const AgentPaths& agent : agents) tracks.read(agent.name);
  tracks.report(e);

  if (sequence.truth_points && aligned) {
    const auto errors = dynamic_errors(tracks.dynamic(), read_truth_points(*sequence.truth_points), truth_from_map);
    if (!errors.errors_m.empty()) e.dynamic_error_m = spread_of(errors.errors_m);
  }
  return e;
}

}  // namespace coslam::eval
