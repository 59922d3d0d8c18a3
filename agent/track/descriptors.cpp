// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/descriptors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "agent/track/scale_space.h"

namespace coslam {
namespace {

constexpr float kContrast = 0.005F;  // least, of the range of greys: something is to be found in dim rooms too
constexpr float kPi = std::numbers::pi_v<float>;

// Gradients of a window of an image, row by row, as the loops over them like it.
struct GradientRow {
  std::vector<float> dx, dy, magnitude, angle_rad;  // angle: of the gradient, y down, -pi to pi

  void cut(const cv::Mat1s& image, int y, int from_x, int to_x) {
    const auto n = static_cast<std::size_t>(std::max(0, to_x - from_x));
    for (auto* v : {&dx, &dy, &magnitude, &angle_rad}) v->resize(n);
    const std::int16_t* above = image.ptr<std::int16_t>(y - 1) + from_x;
    const std::int16_t* row = image.ptr<std::int16_t>(y) + from_x;
    const std::int16_t* below = image.ptr<std::int16_t>(y + 1) + from_x;
    for (std::size_t i = 0; i < n; ++i) {
      const auto x = static_cast<std::ptrdiff_t>(i);
      dx[i] = static_cast<float>(row[x + 1] - row[x - 1]);
      dy[i] = static_cast<float>(below[x] - above[x]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      magnitude[i] = std::sqrt(dx[i] * dx[i] + dy[i] * dy[i]);
      angle_rad[i] = angle_of(dx[i], dy[i]);
    }
  }

 private:
  // To 1e-4 rad, without a branch.
  static float angle_of(float x, float y) {
    const float ax = std::abs(x), ay = std::abs(y);
    const float t = std::min(ax, ay) / (std::max(ax, ay) + 1e-20F), t2 = t * t;
    float a =
        t * (0.99997726F +
             t2 * (-0.33262347F + t2 * (0.19354346F + t2 * (-0.11643287F + t2 * (0.05265332F + t2 * -0.01172120F)))));
    a = ay > ax ? kPi / 2 - a : a;
    a = x < 0 ? kPi - a : a;
    return y < 0 ? -a : a;
  }
};

// Most of the gradients around a blob point there, by a histogram of 36 directions (Lowe, section 5).
float orientation(const cv::Mat1s& image, const Blob& blob, GradientRow* row) {
  constexpr int kBins = 36;
  const float sigma = 1.5F * blob.sigma_px;
  const int cx = static_cast<int>(std::lround(blob.x)), cy = static_cast<int>(std::lround(blob.y));
  const int radius = static_cast<int>(std::lround(3 * sigma));
  std::array<float, kBins> bins{};
  const int from_x = std::max(1, cx - radius), to_x = std::min(image.cols - 2, cx + radius) + 1;
  std::vector<float> weights;  // by the distance along one axis
  for (int i = 0; i <= radius; ++i) {
    const auto off = static_cast<float>(i);
    weights.push_back(std::exp(-0.5F * off * off / (sigma * sigma)));
  }
  for (int y = std::max(1, cy - radius); y <= std::min(image.rows - 2, cy + radius); ++y) {
    row->cut(image, y, from_x, to_x);
    const float of_y = weights[static_cast<std::size_t>(std::abs(y - cy))];
    for (int x = from_x; x < to_x; ++x) {
      const auto i = static_cast<std::size_t>(x - from_x);
      const int bin = static_cast<int>(row->angle_rad[i] * (kBins / (2 * kPi)) + (kBins / 2 + 0.5F));  // of -pi: 0
      bins[static_cast<std::size_t>(bin < kBins ? bin : 0)] +=
          of_y * weights[static_cast<std::size_t>(std::abs(x - cx))] * row->magnitude[i];
    }
  }
  const auto around = [](int i) { return static_cast<std::size_t>((i + kBins) % kBins); };
  std::array<float, kBins> smooth{};
  for (int i = 0; i < kBins; ++i) {
    smooth[around(i)] = (bins[around(i - 2)] + bins[around(i + 2)]) / 16 +
                        (bins[around(i - 1)] + bins[around(i + 1)]) / 4 + bins[around(i)] * 6 / 16;
  }
  const int best = static_cast<int>(std::ranges::max_element(smooth) - smooth.begin());
  const float left = smooth[around(best - 1)], mid = smooth[around(best)], right = smooth[around(best + 1)];
  const float curvature = left - 2 * mid + right;
  const float off = curvature < 0 ? 0.5F * (left - right) / curvature : 0;
  return (static_cast<float>(best) + off) * (2 * kPi / kBins) - kPi;
}

constexpr int kCells = 4, kDirections = 8;  // of a descriptor
static_assert(kCells * kCells * kDirections == kDescriptorBytes);

// exp(-r2 / 8): four cells are two standard deviations to each side.
class CellWeight {
 public:
  CellWeight() {
    for (std::size_t i = 0; i < table_.size(); ++i)
      table_[i] = std::exp(-(static_cast<float>(i) + 0.5F) / (8 * kSteps));
  }
  float operator()(float r2) const {
    return table_[std::min(static_cast<std::size_t>(r2 * kSteps), table_.size() - 1)];
  }

 private:
  static constexpr int kSteps = 32;  // a unit of r2
  std::array<float, 16 * kSteps> table_{};
};

constexpr int kSide = kCells + 2;  // with a margin that what lies between cells may fall into
using Bins = std::array<float, kSide * kSide * kDirections>;

// Those without the margin as a descriptor of one length.
std::array<std::uint8_t, kDescriptorBytes> quantised(const Bins& bins) {
  std::array<float, kDescriptorBytes> all{};
  float squares = 0;
  for (int l = 0; l < kCells; ++l) {
    for (int k = 0; k < kCells * kDirections; ++k) {
      const float v = bins[static_cast<std::size_t>(((l + 1) * kSide + 1) * kDirections + k)];
      all[static_cast<std::size_t>(l * kCells * kDirections + k)] = v;
      squares += v * v;
    }
  }
  // One strong edge is not to count for more than a fifth.
  const float most = 0.2F * std::sqrt(squares);
  squares = 0;
  for (float& v : all) {
    v = std::min(v, most);
    squares += v * v;
  }
  std::array<std::uint8_t, kDescriptorBytes> out{};
  const float scale = 512 / std::max(std::sqrt(squares), 1e-12F);
  std::ranges::transform(all, out.begin(), [&](float v) {
    return quantised_descriptor(static_cast<std::uint8_t>(std::min(255.0F, std::round(v * scale))));
  });
  return out;
}

// Gradients in cells of the turned window, by direction (Lowe, section 6).
std::array<std::uint8_t, kDescriptorBytes> descriptor(const cv::Mat1s& image, const Blob& blob, float turned_rad,
                                                      GradientRow* row) {
  static const CellWeight kWeight;
  Bins bins{};
  const float cell = 3 * blob.sigma_px;
  const int cx = static_cast<int>(std::lround(blob.x)), cy = static_cast<int>(std::lround(blob.y));
  const int radius = static_cast<int>(std::lround(cell * std::numbers::sqrt2_v<float> * (kCells + 1) / 2));
  const float c = std::cos(turned_rad) / cell, s = std::sin(turned_rad) / cell;
  const int from_x = std::max(1, cx - radius), to_x = std::min(image.cols - 2, cx + radius) + 1;
  constexpr float kMiddle = 0.5F * kCells - 0.5F;
  for (int y = std::max(1, cy - radius); y <= std::min(image.rows - 2, cy + radius); ++y) {
    // The part of the row that lies in the turned window.
    const auto off_y = static_cast<float>(y - cy);
    float first = static_cast<float>(from_x - cx), last = static_cast<float>(to_x - 1 - cx);
    constexpr float kReach = 0.5F * (kCells + 1);
    const auto narrow = [&](float per_x, float at_0) {  // |at_0 + per_x * x| < kReach
      if (std::abs(per_x) < 1e-6F) return;
      const float a = (-kReach - at_0) / per_x, b = (kReach - at_0) / per_x;
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    };
    narrow(c, s * off_y);
    narrow(-s, c * off_y);
    const int begin = cx + static_cast<int>(std::ceil(first)), end = cx + static_cast<int>(std::floor(last)) + 1;
    if (begin >= end) continue;
    row->cut(image, y, begin, end);
    for (int x = begin; x < end; ++x) {
      const auto i = static_cast<std::size_t>(x - begin);
      const auto off_x = static_cast<float>(x - cx);
      const float u = c * off_x + s * off_y, v = c * off_y - s * off_x;
      // From the margin on. Judged after the last rounding: what lies just below the end may be rounded up to it.
      const float c1 = u + kMiddle + 1, l1 = v + kMiddle + 1;
      if (!(c1 > 0 && c1 < kSide - 1 && l1 > 0 && l1 < kSide - 1)) continue;
      // All three above 0, so that what is cut off is the fraction.
      const float d = (turned_rad - row->angle_rad[i]) * (kDirections / (2 * kPi)) + 2 * kDirections;
      const float weight = row->magnitude[i] * kWeight(u * u + v * v);
      const int c_bin = static_cast<int>(c1), l_bin = static_cast<int>(l1), d_bin = static_cast<int>(d);
      const float fc = c1 - static_cast<float>(c_bin), fl = l1 - static_cast<float>(l_bin);
      const float fd = d - static_cast<float>(d_bin);
      const int d0 = d_bin % kDirections, d1 = (d_bin + 1) % kDirections;
      float* at = bins.data() + (l_bin * kSide + c_bin) * kDirections;
      const float near = weight * (1 - fl), far = weight * fl;
      const std::array<float, 4> share{near * (1 - fc), near * fc, far * (1 - fc), far * fc};
      const std::array<int, 4> to{0, kDirections, kSide * kDirections, (kSide + 1) * kDirections};
      for (std::size_t k = 0; k < 4; ++k) {
        at[to[k] + d0] += share[k] * (1 - fd);
        at[to[k] + d1] += share[k] * fd;
      }
    }
  }
  return quantised(bins);
}

DescribedFeatures described(const ScaleSpace& space, std::vector<Blob> found, cv::Size size, int most,
                            double border_px) {
  std::ranges::stable_sort(found, std::greater{}, &Blob::contrast);
  DescribedFeatures out;
  GradientRow row;
  const auto b = static_cast<float>(border_px);
  for (const Blob& blob : found) {
    if (static_cast<int>(out.raw_px.size()) == most) break;
    const Eigen::Vector2f px(blob.x_px, blob.y_px);
    if (px.x() < b || px.y() < b || px.x() > static_cast<float>(size.width - 1) - b ||
        px.y() > static_cast<float>(size.height - 1) - b)
      continue;
    const bool twice =
        std::any_of(out.raw_px.begin(), out.raw_px.end(), [&](const auto& o) { return (o - px).squaredNorm() < 9.0F; });
    if (twice) continue;
    out.raw_px.push_back(px);
    const cv::Mat1s& image =
        space.octaves[static_cast<std::size_t>(blob.octave)].levels[static_cast<std::size_t>(blob.level)];
    const auto d = descriptor(image, blob, orientation(image, blob, &row), &row);
    out.descriptors.insert(out.descriptors.end(), d.begin(), d.end());
  }
  return out;
}

}  // namespace

DescribedFeatures describe(const cv::Mat& grey, int most, double border_px) {
  const ScaleSpace space = scale_space(grey);
  return described(space, find_blobs(space, kContrast), grey.size(), most, border_px);
}

DescribedFeatures describe_near(const cv::Mat& grey, const std::vector<Eigen::Vector2f>& raw_px, float near_px,
                                int most, double border_px) {
  cv::Mat mask = cv::Mat::zeros(grey.size(), CV_8UC1);
  for (const Eigen::Vector2f& px : raw_px) {
    cv::circle(mask, {cvRound(px.x()), cvRound(px.y())}, static_cast<int>(near_px), {255}, cv::FILLED);
  }
  const ScaleSpace space = scale_space(grey);
  return described(space, find_blobs(space, kContrast, mask), grey.size(), most, border_px);
}

}  // namespace coslam
