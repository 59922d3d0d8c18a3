// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/cart.h"

#include <Eigen/Geometry>
#include <numbers>
#include <utility>

#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kWheelBaseM = 0.62, kTrackM = 0.40;

std::vector<Mesh> cart_parts(std::uint64_t seed) {
  Random random(mix(seed, 78));
  const auto drawn = [&](MaterialKind kind, double tone) {
    return Material{kind, static_cast<std::uint32_t>(random.next() >> 32), static_cast<float>(tone)};
  };
  std::vector<Mesh> out(5);
  Mesh& cart = out[0];
  const Rigid3 origin;
  const Material wood = drawn(MaterialKind::kWood, 0.4), metal = drawn(MaterialKind::kPaint, 0.35);
  add_box(cart, origin, {-0.45, -0.25, 0.16}, {0.45, 0.25, 0.21}, wood, wood);
  add_box(cart, origin, {-0.30, -0.23, 0.21}, {0.42, 0.22, 0.56}, drawn(MaterialKind::kCarton, 0.45),
          drawn(MaterialKind::kNewspaper, 0.6));
  const Rigid3 askew(Quaterniond(AngleAxisd(0.25, Vector3d::UnitZ())), {0.08, 0, 0.56});
  add_box(cart, askew, {-0.25, -0.17, 0}, {0.22, 0.17, 0.28}, drawn(MaterialKind::kPoster, 0.6),
          drawn(MaterialKind::kCarton, 0.3));
  for (const double y : {-0.23, 0.20}) add_box(cart, origin, {-0.45, y, 0.21}, {-0.42, y + 0.03, 0.97}, metal, metal);
  add_box(cart, origin, {-0.45, -0.23, 0.97}, {-0.42, 0.23, 1.0}, metal, metal);
  // z of the loft along the axle.
  const Rigid3 axle(Quaterniond(AngleAxisd(-0.5 * std::numbers::pi, Vector3d::UnitX())), Vector3d::Zero());
  for (std::size_t i = 1; i < out.size(); ++i) {
    add_loft(out[i], axle, {{{-0.025, kCartWheelM, kCartWheelM}, {0.025, kCartWheelM, kCartWheelM}}, 0.012, 0.012},
             drawn(MaterialKind::kStripedCloth, 0.3));
  }
  return out;
}

}  // namespace

Body make_cart(std::uint64_t seed, const Eigen::Vector2d& start, double heading_deg,
               std::function<double(double t_s)> rolled_m) {
  const Quaterniond heading(AngleAxisd(heading_deg * std::numbers::pi / 180.0, Vector3d::UnitZ()));
  return {cart_parts(seed),
          [start, heading, rolled_m = std::move(rolled_m)](double t_s) {
            const double way_m = rolled_m(t_s);
            const Rigid3 cart(heading, Vector3d(start.x(), start.y(), 0) + way_m * (heading * Vector3d::UnitX()));
            const Quaterniond turned(AngleAxisd(way_m / kCartWheelM, Vector3d::UnitY()));
            std::vector<Rigid3> out{cart};
            for (const double x : {-0.5 * kWheelBaseM, 0.5 * kWheelBaseM}) {
              for (const double y : {-0.5 * kTrackM, 0.5 * kTrackM}) {
                out.push_back(cart * Rigid3(turned, {x, y, kCartWheelM}));
              }
            }
            return out;
          },
          "cart"};
}

}  // namespace coslam::sim
