// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/caster.h"

#include <cstddef>
#include <limits>

#include "common/base/check.h"
#include "deploy/simulation/embree.h"

namespace coslam::sim {
namespace {

// Rays that start on a surface must not meet it again.
constexpr float kNearM = 1e-4F;

void put_vertex(float* out, const Eigen::Vector3d& p) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(p[i]);
}

RTCRay ray_along(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float near, float far) {
  const Eigen::Vector3f o = origin.cast<float>(), d = direction.cast<float>();
  RTCRay ray{};
  ray.org_x = o.x();
  ray.org_y = o.y();
  ray.org_z = o.z();
  ray.dir_x = d.x();
  ray.dir_y = d.y();
  ray.dir_z = d.z();
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = 0xffffffffU;
  return ray;
}

// In a posed scene instance 0 is the world, and the next ones are the parts.
std::uint32_t part_of(unsigned instance) {
  return instance == RTC_INVALID_GEOMETRY_ID || instance == 0 ? kNoPart : instance - 1;
}

std::optional<FacetHit> intersect(RTCScene scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  alignas(16) RTCRayHit query{};
  query.ray = ray_along(origin, direction, kNearM, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect_ray(scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return FacetHit{query.hit.primID, query.hit.u, query.hit.v, query.ray.tfar, part_of(query.hit.instID[0])};
}

std::array<FacetHit, Caster::kPacket> intersect_packet(RTCScene scene, const Eigen::Vector3f& origin,
                                                       const Caster::Directions& directions) {
  alignas(32) static constexpr int kAll[Caster::kPacket] = {-1, -1, -1, -1, -1, -1, -1, -1};
  // What Embree reads is set below. NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
  alignas(32) RTCRayHit8 query;
  for (int i = 0; i < Caster::kPacket; ++i) {
    query.ray.org_x[i] = origin.x();
    query.ray.org_y[i] = origin.y();
    query.ray.org_z[i] = origin.z();
    query.ray.dir_x[i] = directions(0, i);
    query.ray.dir_y[i] = directions(1, i);
    query.ray.dir_z[i] = directions(2, i);
    query.ray.tnear[i] = kNearM;
    query.ray.tfar[i] = std::numeric_limits<float>::infinity();
    query.ray.mask[i] = 0xffffffffU;
    query.ray.flags[i] = 0;
    query.ray.time[i] = 0;
    query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  intersect_rays(kAll, scene, query);
  std::array<FacetHit, Caster::kPacket> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool met = query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    out[i] = {met ? query.hit.primID[i] : kNoFacet, query.hit.u[i], query.hit.v[i], query.ray.tfar[i],
              met ? part_of(query.hit.instID[0][i]) : kNoPart};
  }
  return out;
}

RTCScene scene_of(RTCDevice device, const Mesh& mesh) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), mesh.triangles.size()));
  COSLAM_CHECK(vertices != nullptr && indices != nullptr, "no memory for a moving part");
  for (const MeshVertex& v : mesh.vertices) {
    for (int i = 0; i < 3; ++i) *vertices++ = v.point[i];
  }
  for (const MeshTriangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t.corners) *indices++ = corner;
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

void attach(RTCDevice device, RTCScene scene, RTCScene instanced, const Rigid3& scene_from_what) {
  RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, instanced);
  const Eigen::Matrix<float, 3, 4> transform = scene_from_what.matrix().cast<float>();
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
  rtcCommitGeometry(instance);
  rtcAttachGeometry(scene, instance);
  rtcReleaseGeometry(instance);
}

}  // namespace

struct Caster::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<RTCScene> parts;

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    for (RTCScene part : parts) rtcReleaseScene(part);
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

Caster::Caster(const World& world, const std::vector<Mesh>& parts) : handles_(std::make_unique<Handles>()) {
  handles_->device = rtcNewDevice("threads=1");  // a world of some thousand facets is built in milliseconds
  COSLAM_CHECK(handles_->device != nullptr, "no Embree device");
  handles_->scene = rtcNewScene(handles_->device);
  rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);  // no ray slips through a shared edge
  RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_QUAD);
  const std::size_t count = world.facets.size();
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * count));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), count));
  COSLAM_CHECK(vertices != nullptr && indices != nullptr, "no memory for the world's facets");
  for (std::size_t i = 0; i < count; ++i) {
    const Facet& f = world.facets[i];
    put_vertex(vertices + 12 * i, f.origin);
    put_vertex(vertices + 12 * i + 3, f.origin + f.edge_u);
    put_vertex(vertices + 12 * i + 6, f.origin + f.edge_u + f.edge_v);
    put_vertex(vertices + 12 * i + 9, f.origin + f.edge_v);
    for (std::size_t k = 0; k < 4; ++k) indices[4 * i + k] = static_cast<unsigned>(4 * i + k);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(handles_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(handles_->scene);
  for (const Mesh& part : parts) handles_->parts.push_back(scene_of(handles_->device, part));
}

Caster::~Caster() = default;

std::optional<FacetHit> Caster::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  return intersect(handles_->scene, origin, direction);
}

std::array<FacetHit, Caster::kPacket> Caster::cast_packet(const Eigen::Vector3f& origin,
                                                          const Directions& directions) const {
  return intersect_packet(handles_->scene, origin, directions);
}

bool Caster::blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
  alignas(16) RTCRay ray = ray_along(from, to - from, 0, 0.9999F);
  occlude_ray(handles_->scene, ray);
  return ray.tfar < 0;
}

struct PosedCaster::Handles {
  RTCScene scene = nullptr;

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }
};

PosedCaster::PosedCaster(const Caster& caster, const std::vector<Rigid3>& world_from_parts)
    : handles_(std::make_unique<Handles>()) {
  const Caster::Handles& shapes = *caster.handles_;
  COSLAM_CHECK(shapes.parts.size() == world_from_parts.size(), "a pose for every part");
  handles_->scene = rtcNewScene(shapes.device);
  rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);
  attach(shapes.device, handles_->scene, shapes.scene, Rigid3());
  for (std::size_t i = 0; i < shapes.parts.size(); ++i) {
    attach(shapes.device, handles_->scene, shapes.parts[i], world_from_parts[i]);
  }
  rtcCommitScene(handles_->scene);
}

PosedCaster::~PosedCaster() = default;

std::optional<FacetHit> PosedCaster::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  return intersect(handles_->scene, origin, direction);
}

std::array<FacetHit, Caster::kPacket> PosedCaster::cast_packet(const Eigen::Vector3f& origin,
                                                               const Caster::Directions& directions) const {
  return intersect_packet(handles_->scene, origin, directions);
}

}  // namespace coslam::sim
