// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "deploy/simulation/body.h"
#include "deploy/simulation/caster.h"
#include "deploy/simulation/posed_parts.h"
#include "deploy/simulation/scene.h"
#include "deploy/simulation/sensor.h"
#include "deploy/simulation/world.h"

namespace coslam::sim {

struct SceneCamera {
  CameraModel model;
  SensorModel sensor;
  std::function<Rigid3(double)> cam_from_world;  // pose at a time in seconds; defined for every time
};

// A scene as its author writes it.
struct SceneDescription {
  World world;
  std::vector<Body> bodies;
  std::vector<SceneCamera> cameras;
  int frames = 0;
  double rate_hz = 30;
  double image_scale = 1;  // scale of the images against 640 pixels across
  double tag_m = 0;        // side of the printed tag in it; 0: there is none
  std::string lens;        // see simulated_camera()
};

inline constexpr int kMaxCameras = 16;

// A furnished room; three cameras on closed paths of 8 m in 10 s, looking into one corner at the start.
SceneDescription describe_room(std::uint64_t seed, int cameras);
// Two walls; the cameras turn from one to the other from frame 180 to 256, nearly on the spot.
SceneDescription describe_wall(std::uint64_t seed, int cameras);
// A dim room; a man walks round in front of three cameras and stops now and then, a cart rolls past once.
SceneDescription describe_walking_man(std::uint64_t seed, int cameras);
// The room of the walking man, who stops before the first camera for 2 s.
SceneDescription describe_stopping_man(std::uint64_t seed, int cameras);
// A man who sits between bare walls and moves his body, and four cameras around him. From frame 150 to 240 two of them
// are close to him and see static texture in one corner of the view only.
SceneDescription describe_sitting_man(std::uint64_t seed, int cameras);
// A garden with a way of 63 m around it, which three cameras walk once in 1500 frames; four people walk with them,
// towards them and around, and often fill much of a view.
SceneDescription describe_garden(std::uint64_t seed, int cameras);
// A courtyard with a way of 96 m around it, which four cameras go once; in the middle of the long sides they part in
// pairs, on the north side in other pairs than on the south side. A sign board is seen at both ends.
SceneDescription describe_courtyard(std::uint64_t seed, int cameras);
// A room with a partition. Two cameras start on one side of it and one on the other, with nothing in common; after
// about eight seconds they see the same wall.
SceneDescription describe_strangers(std::uint64_t seed, int cameras);
// Two rooms with the same posters and furniture in different places, and a camera in each.
SceneDescription describe_twins(std::uint64_t seed, int cameras);
// A smaller courtyard. Twelve cameras start together in the west and go in two troops over the south and over the north
// to the east, where they meet; on the way each troop parts in halves and joins again.
SceneDescription describe_swarm(std::uint64_t seed, int cameras);

// A room with a tag of 16 cm on a wall, and one camera that passes it: the scale comes from the tag alone.
SceneDescription describe_tag(std::uint64_t seed, int cameras);

// A street around a block of houses, 10 images a second. Cars follow each other at 10 m, at up to 60 km/h, with a
// camera on the front of each; cars come towards them, cyclists are overtaken, people cross. They come back to the
// start.
SceneDescription describe_street(std::uint64_t seed, int cameras);
// A hall. Three drones with lenses of 150 degrees fly fast around a stand, 20 images a second; from 13 to 18 s they
// turn round on the spot. Two people walk around the stand.
SceneDescription describe_atrium(std::uint64_t seed, int cameras);

struct SceneSize {
  int cameras = 0, frames = 0;      // <= 0: the scene's own number; frames: those of its own time at the rate
  double image_scale = 1;           // share of the scene's image size; tests use small ones
  double rate_hz = 0;               // <= 0: the scene's own
  int width_px = 0, height_px = 0;  // <= 0: the scene's own
  std::string lens;                 // see simulated_camera(); empty: the scene's own
  double turn_at_s = 0;             // <= 0: none. As RenderOptions
};

// Duration of the turn, and of coming to rest before it and going on after it.
inline constexpr double kTurnS = 4, kRestS = 0.5;

// A world with what moves in it. Thread-safe.
class SimulatedScene : public Scene {
 public:
  SimulatedScene(SceneDescription description, const SceneSize& size);

  int cameras() const override { return static_cast<int>(description_.cameras.size()); }
  int frames() const override { return description_.frames; }
  double rate_hz() const override { return description_.rate_hz; }
  const CameraModel& camera(int camera) const override { return at(camera).model; }
  Rigid3 cam_from_world(int camera, double t_s) const override { return at(camera).cam_from_world(t_s); }
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double t_s) const override;
  bool can_move(std::uint32_t object) const override;
  std::string body(std::uint32_t object) const override;
  SurfaceSpot spot(const RayHit& hit, double t_s) const override;
  Eigen::Vector3d position(const SurfaceSpot& spot, double t_s) const override;
  Eigen::Vector3d velocity_m_s(const SurfaceSpot& spot, double t_s) const override;
  Eigen::Vector3d body_velocity_m_s(std::uint32_t object, double t_s) const override;

  double tag_m() const { return description_.tag_m; }
  double time_s(int frame) const { return frame / description_.rate_hz; }
  const SceneCamera& at(int camera) const;
  const World& world() const { return description_.world; }
  const Caster& caster() const { return caster_; }
  // The rigid parts of all bodies, one after the other; part i is object kFirstMovingObject + i.
  const std::vector<Mesh>& parts() const { return parts_; }
  int bodies() const { return static_cast<int>(description_.bodies.size()); }
  // The first part of a body; for body == bodies() the number of parts.
  std::size_t first_part(int body) const { return first_part_[static_cast<std::size_t>(body)]; }
  // Poses of the parts at an instant; null when nothing can move. The last few instants are kept.
  std::shared_ptr<const PosedParts> posed(double t_s) const;

 private:
  std::vector<Rigid3> world_from_parts(double t_s) const;
  std::size_t part_of(std::uint32_t object) const;
  int body_of(std::uint32_t object) const;

  SceneDescription description_;
  std::vector<Mesh> parts_;
  std::vector<std::size_t> first_part_;
  Caster caster_;
  mutable std::mutex mutex_;
  mutable std::vector<std::shared_ptr<const PosedParts>> recent_;  // newest last
};

// Makes a scene like make_scene(). Throws UserError for an unknown name, an unknown lens or too many cameras.
std::unique_ptr<SimulatedScene> make_simulated_scene(const std::string& name, std::uint64_t seed,
                                                     const SceneSize& size);

}  // namespace coslam::sim
