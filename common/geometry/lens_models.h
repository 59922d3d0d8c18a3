// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "common/geometry/lens_base.h"
#include "common/geometry/lens_traits.h"

// Table of lens models: a number, a struct with the equations and the properties, and a place in the list LensModels
// each. Everything else asks the table.
namespace coslam {

// Number of a lens model. It crosses the wire (idl/coslam.idl) and stands in map files: a new one goes to the end.
enum class DistortionModel : std::uint8_t { kNone, kRadTan, kEquidistant, kDoubleSphere, kOmni, kUnknown };

// In the equations n is where the ideal pinhole sees a ray, d where the lens shows it (lens_base.h).
namespace lens {

struct None : Model {
  static constexpr DistortionModel kModel = DistortionModel::kNone;
  static constexpr LensTraits kTraits{
      .names = {"none"},
      .counts = {0},
      .forms = {{LensFile::kBasalt, "pinhole"},
                {LensFile::kColmap, "PINHOLE"},
                {LensFile::kColmap, "SIMPLE_PINHOLE", 0, true},
                {LensFile::kDso, "Pinhole"}},
  };

  static Eigen::Vector2d distort(const LensTerms& /*k*/, const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) {
    if (jacobian != nullptr) jacobian->setIdentity();
    return n;
  }

  static std::optional<Eigen::Vector2d> undistort(const LensTerms& /*k*/, const Eigen::Vector2d& d) { return d; }
};

// Radial and tangential terms as OpenCV has them, with 4, 5 or 8 coefficients.
struct RadTan : Model {
  static constexpr DistortionModel kModel = DistortionModel::kRadTan;
  static constexpr LensTraits kTraits{
      .names = {"radtan", "radial-tangential", "plumb_bob", "rational_polynomial"},
      .terms = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"},
      .counts = {4, 5, 8},
      .first_free = 0,
      .end_free = 5,
      .typical = {-0.28, 0.07, 3e-4, -2e-4},
      .forms = {{LensFile::kOpenCv, "pinhole", 5},
                {LensFile::kOpenCv, "pinhole", 8},
                {LensFile::kRos, "plumb_bob", 5},
                {LensFile::kRos, "rational_polynomial", 8},
                {.file = LensFile::kKalibr, .name = "pinhole", .terms = 4, .distortion = "radtan"},
                {LensFile::kBasalt, "pinhole-radtan8", 8},
                {LensFile::kColmap, "OPENCV", 4},
                {LensFile::kColmap, "FULL_OPENCV", 8},
                {LensFile::kColmap, "SIMPLE_RADIAL", 1, true},
                {LensFile::kColmap, "RADIAL", 2, true},
                {LensFile::kOrbSlam, "PinHole", 5},
                {LensFile::kOrbSlam, "Pinhole", 5},
                {LensFile::kOrbSlam, "perspective", 5},
                {LensFile::kDso, "RadTan", 4}},
  };

  static Eigen::Vector2d distort(const LensTerms& k, const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) {
    const double x = n.x(), y = n.y(), r2 = x * x + y * y;
    const double num = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    const double den = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
    const double radial = num / den;
    if (jacobian != nullptr) {
      const double dnum = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);
      const double dden = k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]);
      const double dradial = (dnum * den - num * dden) / (den * den);  // by r2
      (*jacobian)(0, 0) = radial + 2 * x * x * dradial + 2 * k[2] * y + 6 * k[3] * x;
      (*jacobian)(0, 1) = 2 * x * y * dradial + 2 * k[2] * x + 2 * k[3] * y;
      (*jacobian)(1, 0) = 2 * x * y * dradial + 2 * k[2] * x + 2 * k[3] * y;
      (*jacobian)(1, 1) = radial + 2 * y * y * dradial + 6 * k[2] * y + 2 * k[3] * x;
    }
    return {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
            y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
  }

  static std::optional<Eigen::Vector2d> undistort(const LensTerms& k, const Eigen::Vector2d& d) {
    Eigen::Vector2d n = d;
    for (int i = 0; i < 20; ++i) {
      Eigen::Matrix2d j;
      const Eigen::Vector2d error = distort(k, n, &j) - d;
      if (j.determinant() <= 1e-3) return std::nullopt;  // past the fold of the polynomial
      const Eigen::Vector2d step = j.inverse() * error;
      n -= step;
      if (step.squaredNorm() < 1e-20) return n;
    }
    return (distort(k, n, nullptr) - d).norm() < 1e-6 ? std::optional(n) : std::nullopt;
  }
};

// Kannala and Brandt 2006 with four terms, as Kalibr and OpenCV's fisheye have it.
struct Equidistant : Model {
  static constexpr DistortionModel kModel = DistortionModel::kEquidistant;
  static constexpr LensTraits kTraits{
      .names = {"equidistant", "equi", "fisheye", "KannalaBrandt8"},
      .terms = {"k1", "k2", "k3", "k4"},
      .counts = {4},
      .first_free = 0,
      .end_free = 4,
      .fisheye = true,
      .typical = {-0.012, 0.006, -0.003, 0.0005},
      .forms = {{LensFile::kOpenCv, "fisheye", 4},
                {LensFile::kRos, "equidistant", 4},
                {.file = LensFile::kKalibr, .name = "pinhole", .terms = 4, .distortion = "equidistant"},
                {LensFile::kBasalt, "kb4", 4},
                {LensFile::kColmap, "OPENCV_FISHEYE", 4},
                {LensFile::kColmap, "SIMPLE_RADIAL_FISHEYE", 1, true},
                {LensFile::kColmap, "RADIAL_FISHEYE", 2, true},
                {LensFile::kOrbSlam, "KannalaBrandt8", 4},
                {LensFile::kOrbSlam, "fisheye", 4},
                {LensFile::kDso, "EquiDistant", 4},
                {LensFile::kDso, "KannalaBrandt", 4}},
  };

  static double angle(const LensTerms& k, double theta) {
    const double t2 = theta * theta;
    return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  }

  static double slope(const LensTerms& k, double theta) {
    const double t2 = theta * theta;
    return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
  }

  static Eigen::Vector2d distort(const LensTerms& k, const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) {
    const double r = n.norm();
    if (r < 1e-9) return scale_radially(n, 1, 0, jacobian);
    const double theta = std::atan(r), scale = angle(k, theta) / r;
    const double by_r2 = (slope(k, theta) / (1 + r * r) - scale) / (2 * r * r);
    return scale_radially(n, scale, r < 1e-5 ? 0.0 : by_r2, jacobian);
  }

  static std::optional<Eigen::Vector2d> undistort(const LensTerms& k, const Eigen::Vector2d& d) {
    const double rd = d.norm();
    if (rd < 1e-9) return d;
    double theta = rd;
    for (int i = 0; i < 20; ++i) {
      const double by_theta = slope(k, theta);
      if (by_theta <= 1e-3) return std::nullopt;
      const double step = (angle(k, theta) - rd) / by_theta;
      theta -= step;
      if (std::abs(step) < 1e-12) break;
    }
    if (!(theta > 0 && theta < 1.5) || std::abs(angle(k, theta) - rd) > 1e-6) return std::nullopt;
    return d * (std::tan(theta) / rd);
  }
};

// Base of the models whose files give the focal lengths of the image of a sphere, 1 + xi times those in the middle.
struct Sphere : Model {
  static std::optional<const char*> problem(const LensTerms& k) {
    if (!(k[0] > -1)) return "xi of the lens must be above -1";
    return std::nullopt;
  }
  static double focal_in_files(const LensTerms& k) { return 1 + k[0]; }
};

// Usenko et al. 2018, scaled so that the middle of the image keeps its size.
struct DoubleSphere : Sphere {
  static constexpr DistortionModel kModel = DistortionModel::kDoubleSphere;
  static constexpr LensTraits kTraits{
      .names = {"double_sphere", "ds"},
      .terms = {"xi", "alpha"},
      .counts = {2},
      .first_free = 0,
      .end_free = 2,
      .fisheye = true,
      .typical = {-0.2, 0.6},
      .forms = {{.file = LensFile::kKalibr, .name = "ds", .terms = 2, .before = 2, .distortion = "none"},
                {LensFile::kBasalt, "ds", 2}},
  };

  static std::optional<const char*> problem(const LensTerms& k) {
    if (const auto of_sphere = Sphere::problem(k)) return of_sphere;
    if (!(k[1] >= 0 && k[1] <= 1)) return "alpha of the lens must be between 0 and 1";
    return std::nullopt;
  }

  static Eigen::Vector2d distort(const LensTerms& k, const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) {
    const double xi = k[0], alpha = k[1], r2 = n.squaredNorm(), d1 = std::sqrt(1 + r2), z = xi * d1 + 1;
    const double d2 = std::sqrt(r2 + z * z), den = alpha * d2 + (1 - alpha) * z;
    const double z_by_r2 = xi / (2 * d1);
    const double den_by_r2 = alpha * (1 + 2 * z * z_by_r2) / (2 * d2) + (1 - alpha) * z_by_r2;
    return scale_radially(n, (1 + xi) / den, -(1 + xi) * den_by_r2 / (den * den), jacobian);
  }

  static std::optional<Eigen::Vector2d> undistort(const LensTerms& k, const Eigen::Vector2d& d) {
    const double xi = k[0], alpha = k[1];
    const Eigen::Vector2d m = d / (1 + xi);
    const double r2 = m.squaredNorm(), root = 1 - (2 * alpha - 1) * r2;
    if (root < 0) return std::nullopt;
    const double z = (1 - alpha * alpha * r2) / (alpha * std::sqrt(root) + 1 - alpha);
    const double under = z * z + (1 - xi * xi) * r2;
    if (under < 0) return std::nullopt;
    const double length = (z * xi + std::sqrt(under)) / (z * z + r2);
    return normalized_of_ray({length * m.x(), length * m.y(), length * z - xi});
  }
};

// Mei and Rives 2007: a sphere, then radtan of four terms; scaled likewise.
struct Omni : Sphere {
  static constexpr DistortionModel kModel = DistortionModel::kOmni;
  static constexpr LensTraits kTraits{
      .names = {"omni", "mei"},
      .terms = {"xi", "k1", "k2", "p1", "p2"},
      .counts = {5},
      .first_free = 1,  // what xi does to the picture, k1 and k2 do as well
      .end_free = 5,
      .fisheye = true,
      .typical = {0.9, -0.1, 0.02, 3e-4, -2e-4},
      .forms = {{.file = LensFile::kKalibr, .name = "omni", .terms = 5, .before = 1, .distortion = "radtan"}},
  };

  static LensTerms radtan(const LensTerms& k) { return {k[1], k[2], k[3], k[4]}; }

  static Eigen::Vector2d distort(const LensTerms& k, const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) {
    const double xi = k[0], d = std::sqrt(1 + n.squaredNorm()), scale = 1 / (1 + xi * d);
    Eigen::Matrix2d by_n;
    const Eigen::Vector2d m = scale_radially(n, scale, -scale * scale * xi / (2 * d), &by_n);
    const Eigen::Vector2d bent = RadTan::distort(radtan(k), m, jacobian);
    if (jacobian != nullptr) *jacobian = (1 + xi) * *jacobian * by_n;
    return (1 + xi) * bent;
  }

  static std::optional<Eigen::Vector2d> undistort(const LensTerms& k, const Eigen::Vector2d& d) {
    const double xi = k[0];
    const auto m = RadTan::undistort(radtan(k), d / (1 + xi));
    if (!m) return std::nullopt;
    const double r2 = m->squaredNorm(), root = 1 + (1 - xi * xi) * r2;
    if (root < 0) return std::nullopt;
    const double length = (xi + std::sqrt(root)) / (1 + r2);
    return normalized_of_ray({length * m->x(), length * m->y(), length - xi});
  }
};

// A pinhole whose focal length is a guess.
struct Unknown : None {
  static constexpr DistortionModel kModel = DistortionModel::kUnknown;
  static constexpr LensTraits kTraits{.names = {"unknown"}, .counts = {0}, .guess = true};
};

}  // namespace lens

// All lens models, in the order of their numbers.
using LensModels =
    std::tuple<lens::None, lens::RadTan, lens::Equidistant, lens::DoubleSphere, lens::Omni, lens::Unknown>;
inline constexpr std::size_t kLensModels = std::tuple_size_v<LensModels>;
inline constexpr auto kLastDistortionModel = static_cast<DistortionModel>(kLensModels - 1);

// All numbers of lens models.
inline constexpr auto kDistortionModels = []<std::size_t... I>(std::index_sequence<I...> /*all*/) {
  return std::array{std::tuple_element_t<I, LensModels>::kModel...};
}
(std::make_index_sequence<kLensModels>());

// Result of visit(lens::...()) for the model of this number. It becomes one switch; so hot code may use it.
template <std::size_t I = 0, class Visit>
constexpr decltype(auto) visit_lens(DistortionModel model, const Visit& visit) {
  using Model = std::tuple_element_t<I, LensModels>;
  if constexpr (I + 1 == kLensModels) {
    return visit(Model());
  } else {
    return model == Model::kModel ? visit(Model()) : visit_lens<I + 1>(model, visit);
  }
}

constexpr const LensTraits& lens_traits(DistortionModel model) {
  return visit_lens(model, [](auto lens) -> const LensTraits& { return decltype(lens)::kTraits; });
}

}  // namespace coslam
