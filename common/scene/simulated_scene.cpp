// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/scene/simulated_scene.h"

#include <array>
#include <utility>

#include "common/base/check.h"
#include "common/base/error.h"

namespace coslam {
namespace sim {
namespace {

struct NamedScene {
  const char* name;
  SceneDescription (*describe)(std::uint64_t seed, int cameras);
};

constexpr int kUsualCameras = 3;
constexpr std::array<NamedScene, 2> kScenes{{{"room", describe_room}, {"wall", describe_wall}}};

}  // namespace

SimulatedScene::SimulatedScene(SceneDescription description, const SceneSize& size)
    : description_(std::move(description)), caster_(description_.world) {
  if (size.frames > 0) description_.frames = size.frames;
}

const SceneCamera& SimulatedScene::at(int camera) const {
  COSLAM_CHECK(camera >= 0 && camera < cameras(), "no such camera");
  return description_.cameras[static_cast<std::size_t>(camera)];
}

std::optional<RayHit> SimulatedScene::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                           double /*t_s*/) const {
  const auto hit = caster_.cast(origin, direction);
  if (!hit) return std::nullopt;
  const Facet& facet = description_.world.facets[hit->facet];
  const double towards = facet.normal.dot(direction);
  RayHit out;
  // The facet is known now: its plane gives the point to double precision, where the caster has single.
  const double distance = towards == 0 ? hit->distance : facet.normal.dot(facet.origin - origin) / towards;
  out.point = origin + distance * direction;
  out.normal = towards > 0 ? Eigen::Vector3d(-facet.normal) : facet.normal;
  out.object = facet.object;
  out.distance_m = distance * direction.norm();
  return out;
}

std::unique_ptr<SimulatedScene> make_simulated_scene(const std::string& name, std::uint64_t seed,
                                                     const SceneSize& size) {
  if (size.cameras > kMaxCameras) {
    throw UserError("a simulated scene has at most " + std::to_string(kMaxCameras) + " cameras, not " +
                    std::to_string(size.cameras));
  }
  const int cameras = size.cameras > 0 ? size.cameras : kUsualCameras;
  std::string known;
  for (const NamedScene& scene : kScenes) {
    known += known.empty() ? scene.name : std::string(", ") + scene.name;
    if (name != scene.name) continue;
    SceneDescription description = scene.describe(seed, cameras);
    for (int i = 0; i < cameras; ++i) {
      description.cameras[static_cast<std::size_t>(i)].model = simulated_camera(i, size.image_scale);
    }
    return std::make_unique<SimulatedScene>(std::move(description), size);
  }
  throw UserError("unknown simulated scene '" + name + "' (known: " + known + ")");
}

}  // namespace sim

std::vector<std::string> scene_names() {
  std::vector<std::string> out;
  for (const sim::NamedScene& scene : sim::kScenes) out.emplace_back(scene.name);
  return out;
}

std::unique_ptr<Scene> make_scene(const std::string& name, std::uint64_t seed, int cameras, int frames) {
  return sim::make_simulated_scene(name, seed, {cameras, frames, 1.0});
}

}  // namespace coslam
