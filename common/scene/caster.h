// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "common/scene/world.h"

namespace coslam::sim {

// Where a ray meets a facet: u, v in [0, 1] along its edges; distance in lengths of the ray's direction.
struct FacetHit {
  std::uint32_t facet = 0;
  float u = 0, v = 0;
  float distance = 0;
};

inline constexpr std::uint32_t kNoFacet = 0xffffffffU;

// Ray casting against the facets of a world. Thread-safe once built.
class Caster {
 public:
  explicit Caster(const World& world);
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
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace coslam::sim
