// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/tags.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "common/geometry/robust.h"

namespace coslam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<std::pair<const char*, int>, 8> kFamilies{{
    {"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11},
    {"DICT_APRILTAG_25h9", cv::aruco::DICT_APRILTAG_25h9},
    {"DICT_APRILTAG_16h5", cv::aruco::DICT_APRILTAG_16h5},
    {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
    {"DICT_4X4_50", cv::aruco::DICT_4X4_50},
    {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
    {"DICT_6X6_50", cv::aruco::DICT_6X6_50},
    {"DICT_7X7_50", cv::aruco::DICT_7X7_50},
}};

constexpr double kLeastCell_px = 2.5;  // below, the edges of a cell run into each other
constexpr double kMostError_px = 0.35;
constexpr double kLeastShare = 0.7;  // of the edges that must be seen where they are expected
constexpr double kLeastContrast = 15;

// A place on the edge between a black and a white cell. Coordinates in cells, x right, y down, from the outer corner of
// the black border.
struct Edge {
  Vector2d at;
  Vector2d to_white;  // unit
};

// Three places on each side of a cell that separates black from white, clear of the corners.
std::vector<Edge> edges_of(const cv::Mat& cells) {
  const int n = cells.rows;
  const auto white = [&](int row, int column) {
    return std::min(row, column) < 0 || std::max(row, column) >= n || cells.at<std::uint8_t>(row, column) > 0;
  };
  std::vector<Edge> out;
  for (int line = 0; line <= n; ++line) {
    for (int cell = 0; cell < n; ++cell) {
      for (const double along : {0.3, 0.5, 0.7}) {
        if (white(cell, line - 1) != white(cell, line))
          out.push_back({Vector2d(line, cell + along), Vector2d(white(cell, line) ? 1 : -1, 0)});
        if (white(line - 1, cell) != white(line, cell))
          out.push_back({Vector2d(cell + along, line), Vector2d(0, white(line, cell) ? 1 : -1)});
      }
    }
  }
  return out;
}

// x' ~ H x with H(2, 2) = 1.
struct Homography {
  Eigen::Matrix3d h = Eigen::Matrix3d::Identity();

  Vector2d operator()(const Vector2d& x) const { return (h * x.homogeneous()).hnormalized(); }
  Eigen::Matrix2d by_place(const Vector2d& x) const {
    const Vector3d y = h * x.homogeneous();
    return (h.topLeftCorner<2, 2>() - y.head<2>() / y.z() * h.row(2).head<2>()) / y.z();
  }
  // By the first eight entries, row by row.
  Eigen::Matrix<double, 2, 8> by_entries(const Vector2d& x) const {
    const Vector3d y = h * x.homogeneous();
    Eigen::Matrix<double, 2, 8> j = Eigen::Matrix<double, 2, 8>::Zero();
    j.block<1, 3>(0, 0) = j.block<1, 3>(1, 3) = x.homogeneous().transpose() / y.z();
    j.block<2, 2>(0, 6) = -y.head<2>() / (y.z() * y.z()) * x.transpose();
    return j;
  }
};

std::optional<Homography> homography_of(const std::array<Vector2d, 4>& from, const std::array<Vector2d, 4>& to) {
  Eigen::Matrix<double, 8, 8> a = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    a.block<1, 3>(row, 0) = a.block<1, 3>(row + 1, 3) = from[i].homogeneous().transpose();
    a.block<2, 2>(row, 6) = -to[i] * from[i].transpose();
    b.segment<2>(row) = to[i];
  }
  const Eigen::FullPivLU<Eigen::Matrix<double, 8, 8>> lu(a);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::Matrix<double, 8, 1> h = lu.solve(b);
  Homography out;
  out.h << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  return out;
}

std::optional<double> grey_at(const cv::Mat& image, const Vector2d& px) {
  const int x = static_cast<int>(std::floor(px.x())), y = static_cast<int>(std::floor(px.y()));
  if (x < 0 || y < 0 || x + 1 >= image.cols || y + 1 >= image.rows) return std::nullopt;
  const double fx = px.x() - x, fy = px.y() - y;
  const auto *upper = image.ptr<std::uint8_t>(y) + x, *lower = image.ptr<std::uint8_t>(y + 1) + x;
  return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) + fy * ((1 - fx) * lower[0] + fx * lower[1]);
}

// How far from `at` along the unit vector the image turns from black to white: the mean of the gradient within `reach`.
std::optional<double> edge_offset(const cv::Mat& image, const CameraModel& camera, const Vector2d& at,
                                  const Vector2d& to_white, double reach) {
  constexpr double kStep_px = 0.25;
  const int steps = static_cast<int>(reach / kStep_px);
  double sum = 0, moment = 0;
  std::optional<double> before;
  for (int i = -steps; i <= steps; ++i) {
    const auto grey = grey_at(image, camera.raw_from_undistorted(at + i * kStep_px * to_white));
    if (!grey) return std::nullopt;
    if (before) {
      const double rise = std::max(0.0, *grey - *before);
      sum += rise;
      moment += rise * (i - 0.5) * kStep_px;
    }
    before = grey;
  }
  if (sum < kLeastContrast) return std::nullopt;
  return moment / sum;
}

struct Fit {
  Homography h;
  int edges = 0;
  double error_px = 0;
};

// Gauss-Newton on the homography and on how far all edges lie towards the white side.
std::optional<Fit> fit_edges(const cv::Mat& image, const CameraModel& camera, const std::vector<Edge>& edges,
                             const Homography& start) {
  constexpr int kRounds = 5;
  constexpr double kTukey_px = 1.0, kShiftPrior_px = 0.5, kEdgeSigma_px = 0.1;
  constexpr double kReachCells = 0.45, kMostReach_px = 3.0;
  Fit fit{.h = start};
  double shift = 0;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, 9, 9> jtj = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 1> jtr = Eigen::Matrix<double, 9, 1>::Zero();
    const double prior = kEdgeSigma_px / kShiftPrior_px;
    jtj(8, 8) = prior * prior;
    jtr(8) = -prior * prior * shift;
    double squares = 0, weights = 0;
    fit.edges = 0;
    for (const Edge& e : edges) {
      // The edge runs across to_white in the plane; in the image its normal is that of the mapped direction.
      const Eigen::Matrix2d by_place = fit.h.by_place(e.at);
      const Vector2d along = by_place * Vector2d(-e.to_white.y(), e.to_white.x());
      Vector2d normal = Vector2d(along.y(), -along.x()).normalized();
      const double cell_px = normal.dot(by_place * e.to_white);
      if (cell_px < 0) normal = -normal;
      if (std::abs(cell_px) < kLeastCell_px) return std::nullopt;
      const double reach = std::min(kMostReach_px, kReachCells * std::abs(cell_px));
      const auto offset = edge_offset(image, camera, fit.h(e.at) + shift * normal, normal, reach);
      if (!offset) continue;
      Eigen::Matrix<double, 9, 1> j;
      j << fit.h.by_entries(e.at).transpose() * normal, 1;
      const double w = tukey_weight(*offset, kTukey_px);
      if (w > 0) ++fit.edges;
      jtj += w * j * j.transpose();
      jtr += w * *offset * j;
      squares += w * *offset * *offset;
      weights += w;
    }
    if (fit.edges < kLeastShare * static_cast<double>(edges.size())) return std::nullopt;
    fit.error_px = std::sqrt(squares / weights);
    const Eigen::Matrix<double, 9, 1> step = jtj.ldlt().solve(jtr);
    if (!step.allFinite()) return std::nullopt;
    for (int i = 0; i < 8; ++i) fit.h.h(i / 3, i % 3) += step[i];
    shift += step[8];
  }
  if (fit.error_px > kMostError_px) return std::nullopt;
  return fit;
}

}  // namespace

std::vector<std::string> tag_families() {
  std::vector<std::string> out{kNoTags};
  for (const auto& [name, id] : kFamilies) out.emplace_back(name);
  return out;
}

TagFinder::TagFinder(const CameraModel& camera, const std::string& family) : camera_(camera) {
  const auto at = std::ranges::find_if(kFamilies, [&](const auto& f) { return family == f.first; });
  if (at == kFamilies.end()) throw UserError("there is no family of tags '" + family + "'");
  dictionary_ = aruco::dictionary_of(at->second);
  // One size of window finds as many as OpenCV's three, in half the time.
  const int window = 2 * static_cast<int>(std::lround(4.0 * camera.width_px / 640)) + 1;
  parameters_.adaptiveThreshWinSizeMin = parameters_.adaptiveThreshWinSizeMax = std::max(3, window);
  parameters_.minMarkerDistanceRate = aruco::kCloseOutlines;
  parameters_.perspectiveRemovePixelPerCell = 8;
  parameters_.perspectiveRemoveIgnoredMarginPerCell = 0.3;  // corners are rough at this point
}

std::vector<FoundTag> TagFinder::find(const cv::Mat& grey) const {
  aruco::Corners corners;
  std::vector<int> ids;
  aruco::detect(grey, dictionary_, parameters_, &corners, &ids);
  std::vector<FoundTag> out;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    cv::Mat cells;
    const int side = aruco::cells_a_side(dictionary_) + 2;
    aruco::draw(dictionary_, ids[i], &cells);
    const std::array<Vector2d, 4> printed{Vector2d(0, 0), Vector2d(side, 0), Vector2d(side, side), Vector2d(0, side)};
    std::array<Vector2d, 4> seen;
    bool usable = true;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto px = camera_.undistorted_from_raw({corners[i][k].x, corners[i][k].y});
      usable &= px.has_value();
      if (px) seen[k] = *px;
    }
    const auto start = usable ? homography_of(printed, seen) : std::nullopt;
    const auto fit = start ? fit_edges(grey, camera_, edges_of(cells), *start) : std::nullopt;
    if (!fit) continue;
    FoundTag& tag = out.emplace_back();
    tag.tag = TagId(static_cast<std::uint16_t>(ids[i]));
    for (std::size_t k = 0; k < 4; ++k) tag.undistorted_px[k] = fit->h(printed[k]);
    tag.edges = fit->edges;
    tag.error_px = fit->error_px;
  }
  std::ranges::stable_sort(out, {}, &FoundTag::tag);
  return out;
}

}  // namespace coslam
