// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

struct RayHit {
  Eigen::Vector3d point;   // world, metres
  Eigen::Vector3d normal;  // unit, towards the viewer
  std::uint32_t object = 0;
  double distance_m = 0;
};

// A place on a surface, wherever the surface goes: metres in the frame of the rigid object that it belongs to.
struct SurfaceSpot {
  std::uint32_t object = 0;
  Eigen::Vector3d in_object = Eigen::Vector3d::Zero();
};

// Speed from which on a place on a surface is said to move. Somebody who stands still is static for that time.
inline constexpr double kMovingSpeed_m_s = 0.02;

// A simulated world with exact truth: what the cameras see, where they are, what moves.
class Scene {
 public:
  virtual ~Scene() = default;
  virtual int cameras() const = 0;
  virtual int frames() const = 0;
  virtual double rate_hz() const = 0;
  virtual const CameraModel& camera(int camera) const = 0;
  virtual Rigid3 cam_from_world(int camera, double t_s) const = 0;
  // First surface along a ray at time t_s; empty when it leaves the world.
  virtual std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                     double t_s) const = 0;

  // Whether an object can move at all. The parts of a body are objects of their own.
  virtual bool can_move(std::uint32_t /*object*/) const { return false; }
  // The name of the body that an object is a part of; empty where it cannot move.
  virtual std::string body(std::uint32_t /*object*/) const { return {}; }
  // The place that a ray met at t_s.
  virtual SurfaceSpot spot(const RayHit& hit, double /*t_s*/) const { return {hit.object, hit.point}; }
  // World, metres.
  virtual Eigen::Vector3d position(const SurfaceSpot& spot, double /*t_s*/) const { return spot.in_object; }
  virtual Eigen::Vector3d velocity_m_s(const SurfaceSpot& /*spot*/, double /*t_s*/) const {
    return Eigen::Vector3d::Zero();
  }
  // Velocity of the whole body that an object is a part of: the mean over its surface. World.
  virtual Eigen::Vector3d body_velocity_m_s(std::uint32_t /*object*/, double /*t_s*/) const {
    return Eigen::Vector3d::Zero();
  }
  double speed_m_s(const SurfaceSpot& spot, double t_s) const { return velocity_m_s(spot, t_s).norm(); }
  bool moving(const SurfaceSpot& spot, double t_s) const { return speed_m_s(spot, t_s) > kMovingSpeed_m_s; }
};

// Names that `sim:NAME` accepts.
std::vector<std::string> scene_names();
// Throws UserError for an unknown name (with the list of names). cameras, frames <= 0: the scene's own number.
std::unique_ptr<Scene> make_scene(const std::string& name, std::uint64_t seed, int cameras = 0, int frames = 0);

// <= 0 or empty: the scene's own.
struct RenderOptions {
  std::string scene;
  std::uint64_t seed = 1;
  int cameras = 0;
  int frames = 0;                   // a camera
  double rate_hz = 0;               // image rate; the motion stays the same
  int width_px = 0, height_px = 0;  // image size: another width is another scale, another height shows more or less
  std::string lens;                 // see simulated_camera()
  double turn_at_s = 0;             // the cameras stop there and turn by 180 degrees on the spot, in kTurnS
  int threads = 2;
};

// Renders a sequence folder in the form of docs/configuration.md: sequence.yaml, <agent>/<6 digits>.png + times.txt,
// calibration, truth <agent>.tum, and what eval needs; masks and points.csv where things move. Written aside and
// renamed, so that a folder that exists is complete. progress(done, total) is called from this thread; an exception
// that it throws ends the rendering and leaves nothing. Throws UserError when the folder has something in it or cannot
// be written.
void render_sequence(const RenderOptions& options, const std::filesystem::path& folder,
                     const std::function<void(int, int)>& progress);

// The cached rendering of a scene (rendered when missing): $COSLAM_CACHE or ~/.cache/coslam, a folder per scene, seed,
// size and version of the renderer; of the scene's own rate, images and lenses.
std::filesystem::path cached_sequence(const RenderOptions& options, const std::function<void(int, int)>& progress);

}  // namespace coslam
