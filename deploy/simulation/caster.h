// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/geometry/rigid3.h"
#include "deploy/simulation/mesh.h"
#include "deploy/simulation/world.h"

namespace coslam::sim {

inline constexpr std::uint32_t kNoFacet = 0xffffffffU;
inline constexpr std::uint32_t kNoPart = 0xffffffffU;

// Intersection of a ray with a facet: u, v in [0, 1] along its edges; distance in lengths of the ray's direction. On a
// moving part facet is the triangle, and u, v are the weights of its second and third corner.
struct FacetHit {
  std::uint32_t facet = 0;
  float u = 0, v = 0;
  float distance = 0;
  std::uint32_t part = kNoPart;
};

// Ray casting against the facets of a world. Thread-safe once built.
class Caster {
 public:
  // parts: what can move through the world; they are met only through a PosedCaster.
  explicit Caster(const World& world, const std::vector<Mesh>& parts = {});
  ~Caster();
  Caster(const Caster&) = delete;
  Caster& operator=(const Caster&) = delete;

  std::optional<FacetHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  // A packet of rays from one origin; facet == kNoFacet where nothing is met.
  static constexpr int kPacket = 8;
  using Directions = Eigen::Matrix<float, 3, kPacket>;
  std::array<FacetHit, kPacket> cast_packet(const Eigen::Vector3f& origin, const Directions& directions) const;
  // Whether something lies between two points.
  bool blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

 private:
  friend class PosedCaster;
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

// Ray casting against a world and its moving parts at one instant. Thread-safe; the caster must outlive it.
class PosedCaster {
 public:
  PosedCaster(const Caster& caster, const std::vector<Rigid3>& world_from_parts);
  ~PosedCaster();
  PosedCaster(const PosedCaster&) = delete;
  PosedCaster& operator=(const PosedCaster&) = delete;

  std::optional<FacetHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  std::array<FacetHit, Caster::kPacket> cast_packet(const Eigen::Vector3f& origin,
                                                    const Caster::Directions& directions) const;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace coslam::sim
