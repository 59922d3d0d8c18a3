// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/simulated_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/check.h"
#include "common/base/error.h"
#include "deploy/simulation/motion.h"

namespace coslam {
namespace sim {
namespace {

struct NamedScene {
  const char* name;
  int cameras;
  SceneDescription (*describe)(std::uint64_t seed, int cameras);
};

constexpr std::array<NamedScene, 13> kScenes{{{"room", 3, describe_room},
                                              {"wall", 3, describe_wall},
                                              {"walking-man", 3, describe_walking_man},
                                              {"stopping-man", 3, describe_stopping_man},
                                              {"sitting-man", 4, describe_sitting_man},
                                              {"garden", 3, describe_garden},
                                              {"courtyard", 4, describe_courtyard},
                                              {"strangers", 3, describe_strangers},
                                              {"twins", 2, describe_twins},
                                              {"swarm", 12, describe_swarm},
                                              {"tag", 1, describe_tag},
                                              {"street", 2, describe_street},
                                              {"atrium", 3, describe_atrium}}};

// The instants that are asked for again: those that the cameras and threads work on.
constexpr std::size_t kInstantsKept = 8;

// Another width is another scale; another height shows more or less above and below.
CameraModel camera_of(int index, const SceneSize& size, const SceneDescription& description) {
  const std::string& lens = size.lens.empty() ? description.lens : size.lens;
  constexpr double kUsualWidthPx = 640;
  const double scale = size.width_px > 0 ? size.width_px / kUsualWidthPx : size.image_scale * description.image_scale;
  CameraModel out = simulated_camera(index, scale, lens);
  if (size.height_px > 0) {
    out.cy += 0.5 * (size.height_px - out.height_px);
    out.height_px = size.height_px;
  }
  return out;
}

std::vector<Mesh> parts_of(const std::vector<Body>& bodies) {
  std::vector<Mesh> out;
  for (const Body& body : bodies) out.insert(out.end(), body.parts.begin(), body.parts.end());
  return out;
}

// Stops at an instant, turns by 180 degrees about the vertical through its centre, and goes on its way looking back.
std::function<Rigid3(double)> turned_round(std::function<Rigid3(double)> cam_from_world, double at_s) {
  return [cam_from_world = std::move(cam_from_world), at_s](double t_s) {
    const Rigid3 before = cam_from_world(paused_time(t_s, at_s, at_s + kTurnS, kRestS));
    const double turned_rad = std::numbers::pi * eased_step(t_s, at_s, at_s + kTurnS);
    const Eigen::Quaterniond rotation = before.rotation * Eigen::AngleAxisd(-turned_rad, Eigen::Vector3d::UnitZ());
    return Rigid3{rotation, -(rotation * before.center())};
  };
}

}  // namespace

SimulatedScene::SimulatedScene(SceneDescription description, const SceneSize& size)
    : description_(std::move(description)), parts_(parts_of(description_.bodies)), caster_(description_.world, parts_) {
  if (size.turn_at_s > 0) {
    for (SceneCamera& c : description_.cameras) c.cam_from_world = turned_round(c.cam_from_world, size.turn_at_s);
    description_.frames += static_cast<int>(std::lround((kTurnS + kRestS) * description_.rate_hz));
  }
  if (size.rate_hz > 0) {
    const double own_s = description_.frames / description_.rate_hz;
    description_.frames = std::max(1, static_cast<int>(std::lround(own_s * size.rate_hz)));
    description_.rate_hz = size.rate_hz;
  }
  if (size.frames > 0) description_.frames = size.frames;
  std::size_t first = 0;
  for (const Body& body : description_.bodies) {
    first_part_.push_back(first);
    first += body.parts.size();
  }
  first_part_.push_back(first);
}

const SceneCamera& SimulatedScene::at(int camera) const {
  COSLAM_CHECK(camera >= 0 && camera < cameras(), "no such camera");
  return description_.cameras[static_cast<std::size_t>(camera)];
}

std::vector<Rigid3> SimulatedScene::world_from_parts(double t_s) const {
  std::vector<Rigid3> out;
  out.reserve(parts_.size());
  for (const Body& body : description_.bodies) {
    const std::vector<Rigid3> poses = body.world_from_parts(t_s);
    COSLAM_CHECK(poses.size() == body.parts.size(), "a pose for every part of a body");
    out.insert(out.end(), poses.begin(), poses.end());
  }
  return out;
}

std::shared_ptr<const PosedParts> SimulatedScene::posed(double t_s) const {
  if (parts_.empty()) return nullptr;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& posed : recent_) {
      if (posed->t_s() == t_s) return posed;
    }
  }
  constexpr double kStepS = 5e-4;  // for speeds
  auto made = std::make_shared<const PosedParts>(
      caster_, t_s, world_from_parts(t_s),
      PartMotion{world_from_parts(t_s - kStepS), world_from_parts(t_s + kStepS), 2 * kStepS});
  const std::scoped_lock lock(mutex_);
  recent_.push_back(made);
  if (recent_.size() > kInstantsKept) recent_.erase(recent_.begin());
  return made;
}

std::optional<RayHit> SimulatedScene::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                           double t_s) const {
  const auto posed = this->posed(t_s);
  const auto hit = posed ? posed->caster().cast(origin, direction) : caster_.cast(origin, direction);
  if (!hit) return std::nullopt;
  Eigen::Vector3d normal, on_plane;
  RayHit out;
  if (hit->part == kNoPart) {
    const Facet& facet = description_.world.facets[hit->facet];
    normal = facet.normal;
    on_plane = facet.origin;
    out.object = facet.object;
  } else {
    const Mesh& mesh = parts_[hit->part];
    const auto& [a, b, c] = mesh.triangles[hit->facet].corners;
    const auto corner = [&](std::uint32_t i) { return Eigen::Vector3d(mesh.vertices[i].point.cast<double>()); };
    const Rigid3& world_from_part = posed->world_from_part(hit->part);
    normal = world_from_part.rotation * (corner(b) - corner(a)).cross(corner(c) - corner(a)).normalized();
    on_plane = world_from_part * corner(a);
    out.object = kFirstMovingObject + hit->part;
  }
  const double towards = normal.dot(direction);
  // The plane is known now: it gives the point to double precision, where the caster has single.
  const double distance = towards == 0 ? hit->distance : normal.dot(on_plane - origin) / towards;
  out.point = origin + distance * direction;
  out.normal = towards > 0 ? Eigen::Vector3d(-normal) : normal;
  out.distance_m = distance * direction.norm();
  return out;
}

bool SimulatedScene::can_move(std::uint32_t object) const { return object >= kFirstMovingObject; }

std::string SimulatedScene::body(std::uint32_t object) const {
  if (!can_move(object)) return {};
  const int i = body_of(object);
  return description_.bodies[static_cast<std::size_t>(i)].kind + " " + std::to_string(i + 1);
}

int SimulatedScene::body_of(std::uint32_t object) const {
  const auto after = std::upper_bound(first_part_.begin(), first_part_.end(), part_of(object));
  return static_cast<int>(after - first_part_.begin()) - 1;
}

std::size_t SimulatedScene::part_of(std::uint32_t object) const {
  COSLAM_CHECK(object - kFirstMovingObject < parts_.size(), "no such moving object");
  return object - kFirstMovingObject;
}

SurfaceSpot SimulatedScene::spot(const RayHit& hit, double t_s) const {
  if (!can_move(hit.object)) return {hit.object, hit.point};
  return {hit.object, posed(t_s)->world_from_part(part_of(hit.object)).inverse() * hit.point};
}

Eigen::Vector3d SimulatedScene::position(const SurfaceSpot& spot, double t_s) const {
  if (!can_move(spot.object)) return spot.in_object;
  return posed(t_s)->world_from_part(part_of(spot.object)) * spot.in_object;
}

Eigen::Vector3d SimulatedScene::velocity_m_s(const SurfaceSpot& spot, double t_s) const {
  if (!can_move(spot.object)) return Eigen::Vector3d::Zero();
  return posed(t_s)->velocity(part_of(spot.object), spot.in_object);
}

Eigen::Vector3d SimulatedScene::body_velocity_m_s(std::uint32_t object, double t_s) const {
  if (!can_move(object)) return Eigen::Vector3d::Zero();
  const auto now = posed(t_s);
  const int body = body_of(object);
  Eigen::Vector3d sum_m_s = Eigen::Vector3d::Zero();
  double area = 0;
  for (std::size_t part = first_part(body); part < first_part(body + 1); ++part) {
    const Mesh& mesh = parts_[part];
    const auto corner = [&](std::uint32_t i) { return Eigen::Vector3d(mesh.vertices[i].point.cast<double>()); };
    for (const MeshTriangle& triangle : mesh.triangles) {
      const Eigen::Vector3d a = corner(triangle.corners[0]), b = corner(triangle.corners[1]),
                            c = corner(triangle.corners[2]);
      const double share = (b - a).cross(c - a).norm();
      sum_m_s += share * now->velocity(part, (a + b + c) / 3);
      area += share;
    }
  }
  return sum_m_s / area;
}

std::unique_ptr<SimulatedScene> make_simulated_scene(const std::string& name, std::uint64_t seed,
                                                     const SceneSize& size) {
  if (size.cameras > kMaxCameras) {
    throw UserError("a simulated scene has at most " + std::to_string(kMaxCameras) + " cameras, not " +
                    std::to_string(size.cameras));
  }
  std::string known;
  for (const NamedScene& scene : kScenes) {
    known += known.empty() ? scene.name : std::string(", ") + scene.name;
    if (name != scene.name) continue;
    const int cameras = size.cameras > 0 ? size.cameras : scene.cameras;
    SceneDescription description = scene.describe(seed, cameras);
    for (int i = 0; i < cameras; ++i) {
      description.cameras[static_cast<std::size_t>(i)].model = camera_of(i, size, description);
    }
    return std::make_unique<SimulatedScene>(std::move(description), size);
  }
  throw UserError("unknown simulated scene '" + name + "' (known: " + known + ")");
}

}  // namespace sim

std::vector<std::string> scene_names() {
  std::vector<std::string> out;
  out.reserve(sim::kScenes.size());
  for (const sim::NamedScene& scene : sim::kScenes) out.emplace_back(scene.name);
  return out;
}

std::unique_ptr<Scene> make_scene(const std::string& name, std::uint64_t seed, int cameras, int frames) {
  return sim::make_simulated_scene(name, seed, {cameras, frames, 1.0});
}

}  // namespace coslam
