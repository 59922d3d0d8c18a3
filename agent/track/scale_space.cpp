// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/scale_space.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "agent/track/scale_kernels.h"

namespace coslam {
namespace {

constexpr double kFirstBlur = 1.6;
constexpr double kBlurOfImage = 1.0;  // that it has itself, at twice its size
constexpr int kSmallest = 24;         // side of an octave
constexpr int kBorder = 5;            // of an octave, where nothing is looked for
constexpr float kEdge = 10;           // ratio of the curvatures of what is no blob

double level_blur(int level) { return kFirstBlur * std::exp2(static_cast<double>(level) / kScalesPerOctave); }

struct Gaussian {
  int radius = 0;
  std::array<std::int16_t, kMostBlurRadius + 1> weights{};
};

// Cut off at three standard deviations, and wider by what is lost there.
Gaussian gaussian(double sigma) {
  Gaussian out;
  out.radius = std::clamp(static_cast<int>(std::ceil(3 * sigma - 0.3)), 1, kMostBlurRadius);
  std::array<double, kMostBlurRadius + 1> w{};
  double wide = sigma;
  for (int i = 0; i < 20; ++i) {
    double sum = 0, squares = 0;
    for (int k = -out.radius; k <= out.radius; ++k) {
      const double v = std::exp(-0.5 * k * k / (wide * wide));
      w[static_cast<std::size_t>(std::abs(k))] = v;
      sum += v;
      squares += v * k * k;
    }
    for (double& v : w) v /= sum;
    wide *= sigma / std::sqrt(squares / sum);
  }
  int rest = 1 << 15;
  for (int k = 1; k <= out.radius; ++k) {
    out.weights[static_cast<std::size_t>(k)] =
        static_cast<std::int16_t>(std::lround(w[static_cast<std::size_t>(k)] * (1 << 15)));
    rest -= 2 * out.weights[static_cast<std::size_t>(k)];
  }
  out.weights[0] = static_cast<std::int16_t>(rest);
  return out;
}

int mirrored(int i, int size) {
  if (i < 0) i = -i;
  return i < size ? i : 2 * size - 2 - i;
}

cv::Mat1s blurred(const cv::Mat1s& from, double sigma) {
  const Gaussian g = gaussian(sigma);
  cv::Mat1s out(from.size());
  cv::Mat1s row(1, from.cols + 2 * g.radius);
  std::array<const std::int16_t*, 2 * kMostBlurRadius + 1> taps{};
  for (int y = 0; y < from.rows; ++y) {
    for (int k = -g.radius; k <= g.radius; ++k) {
      taps[static_cast<std::size_t>(k + g.radius)] = from.ptr<std::int16_t>(mirrored(y + k, from.rows));
    }
    std::int16_t* middle = row.ptr<std::int16_t>() + g.radius;
    scale_kernels().blur(taps.data(), g.weights.data(), g.radius, from.cols, middle);
    for (int k = 1; k <= g.radius; ++k) {
      middle[-k] = middle[k];
      middle[from.cols - 1 + k] = middle[from.cols - 1 - k];
    }
    for (int k = -g.radius; k <= g.radius; ++k) taps[static_cast<std::size_t>(k + g.radius)] = middle + k;
    scale_kernels().blur(taps.data(), g.weights.data(), g.radius, from.cols, out.ptr<std::int16_t>(y));
  }
  return out;
}

// Of sixteen grey levels.
std::int16_t grey16(int sum) { return static_cast<std::int16_t>((sum - 16 * 128) * (kGreyUnit / 16)); }

// Bilinear, exact: pixel centres at whole numbers, so that a pixel lies a quarter beside two of the double image.
cv::Mat1s doubled(const cv::Mat1b& grey) {
  cv::Mat1s out(2 * grey.rows, 2 * grey.cols);
  std::vector<std::int16_t> row(static_cast<std::size_t>(grey.cols));
  for (int y = 0; y < out.rows; ++y) {
    const std::uint8_t* near = grey.ptr<std::uint8_t>(y / 2);
    const std::uint8_t* far = grey.ptr<std::uint8_t>(std::clamp(y % 2 != 0 ? y / 2 + 1 : y / 2 - 1, 0, grey.rows - 1));
    for (int x = 0; x < grey.cols; ++x)
      row[static_cast<std::size_t>(x)] = static_cast<std::int16_t>(3 * near[x] + far[x]);
    auto* to = out.ptr<std::int16_t>(y);
    for (int x = 0; x < grey.cols; ++x) {
      const int centre = row[static_cast<std::size_t>(x)];
      const int left = row[static_cast<std::size_t>(std::max(0, x - 1))];
      const int right = row[static_cast<std::size_t>(std::min(grey.cols - 1, x + 1))];
      to[2 * x] = grey16(3 * centre + left);
      to[2 * x + 1] = grey16(3 * centre + right);
    }
  }
  return out;
}

cv::Mat1s halved(const cv::Mat1s& from) {
  cv::Mat1s out(from.rows / 2, from.cols / 2);
  for (int y = 0; y < out.rows; ++y) {
    const auto* row = from.ptr<std::int16_t>(2 * y);
    auto* to = out.ptr<std::int16_t>(y);
    for (int x = 0; x < out.cols; ++x) to[x] = row[2 * x];
  }
  return out;
}

double blur_between(double from, double to) { return std::sqrt(to * to - from * from); }

// Differences of neighbouring levels around a place.
class Differences {
 public:
  explicit Differences(const Octave& octave) : levels_(octave.levels) {}
  float at(int level, int y, int x) const {
    const auto l = static_cast<std::size_t>(level);
    return static_cast<float>(levels_[l + 1](y, x) - levels_[l](y, x));
  }
  Eigen::Vector3f gradient(int l, int y, int x) const {
    return 0.5F * Eigen::Vector3f(at(l, y, x + 1) - at(l, y, x - 1), at(l, y + 1, x) - at(l, y - 1, x),
                                  at(l + 1, y, x) - at(l - 1, y, x));
  }
  Eigen::Matrix3f hessian(int l, int y, int x) const {
    const float twice = 2 * at(l, y, x);
    const auto mixed = [](float pp, float pm, float mp, float mm) { return 0.25F * (pp - pm - mp + mm); };
    Eigen::Matrix3f h;
    h(0, 0) = at(l, y, x + 1) + at(l, y, x - 1) - twice;
    h(1, 1) = at(l, y + 1, x) + at(l, y - 1, x) - twice;
    h(2, 2) = at(l + 1, y, x) + at(l - 1, y, x) - twice;
    h(0, 1) = h(1, 0) = mixed(at(l, y + 1, x + 1), at(l, y + 1, x - 1), at(l, y - 1, x + 1), at(l, y - 1, x - 1));
    h(0, 2) = h(2, 0) = mixed(at(l + 1, y, x + 1), at(l + 1, y, x - 1), at(l - 1, y, x + 1), at(l - 1, y, x - 1));
    h(1, 2) = h(2, 1) = mixed(at(l + 1, y + 1, x), at(l + 1, y - 1, x), at(l - 1, y + 1, x), at(l - 1, y - 1, x));
    return h;
  }
  int rows() const { return levels_[0].rows; }
  int cols() const { return levels_[0].cols; }

 private:
  const std::array<cv::Mat1s, kScalesPerOctave + 3>& levels_;
};

// To a fraction of a pixel and a level, by the quadratic through its neighbours.
bool refine(const Differences& d, int octave, int level, int y, int x, float least, Blob* out) {
  constexpr int kTries = 5;
  constexpr float kNear = 0.6F;  // the least of what is half way between two pixels
  Eigen::Vector3f off;
  Eigen::Vector3f gradient;
  Eigen::Matrix3f hessian;
  for (int i = 0;; ++i) {
    gradient = d.gradient(level, y, x);
    hessian = d.hessian(level, y, x);
    bool solvable = false;
    Eigen::Matrix3f inverse;
    hessian.computeInverseWithCheck(inverse, solvable, 1e-6F);
    if (!solvable) return false;
    off = -(inverse * gradient);
    if (off.cwiseAbs().maxCoeff() < (i + 1 == kTries ? kNear : 0.5F)) break;
    if (i + 1 == kTries || off.cwiseAbs().maxCoeff() > 1e3F) return false;
    x += static_cast<int>(std::lround(off.x()));
    y += static_cast<int>(std::lround(off.y()));
    level += static_cast<int>(std::lround(off.z()));
    if (level < 1 || level > kScalesPerOctave || x < kBorder || y < kBorder || x >= d.cols() - kBorder ||
        y >= d.rows() - kBorder)
      return false;
  }
  constexpr float kGreyRange = 255.0F * kGreyUnit;
  out->contrast = std::abs(d.at(level, y, x) + 0.5F * gradient.dot(off)) / kGreyRange;
  if (out->contrast < least) return false;
  const float trace = hessian(0, 0) + hessian(1, 1);
  const float det = hessian(0, 0) * hessian(1, 1) - hessian(0, 1) * hessian(0, 1);
  if (det <= 0 || trace * trace * kEdge >= (kEdge + 1) * (kEdge + 1) * det) return false;
  out->octave = octave;
  out->level = level;
  out->x = static_cast<float>(x) + off.x();
  out->y = static_cast<float>(y) + off.y();
  out->sigma_px = static_cast<float>(kFirstBlur) * std::exp2((static_cast<float>(level) + off.z()) / kScalesPerOctave);
  const float size = std::ldexp(1.0F, octave - 1);
  out->x_px = out->x * size - 0.25F;
  out->y_px = out->y * size - 0.25F;
  return true;
}

bool wanted(const cv::Mat1b& mask, float x_px, float y_px) {
  if (mask.empty()) return true;
  const int x = static_cast<int>(std::lround(x_px)), y = static_cast<int>(std::lround(y_px));
  return x >= 0 && y >= 0 && x < mask.cols && y < mask.rows && mask(y, x) != 0;
}

// The extrema of one octave, row by row: three rows of each difference are held.
void find_in(const Octave& octave, int number, float least, const cv::Mat1b& mask, std::vector<Blob>* out) {
  constexpr int kDifferences = kScalesPerOctave + 2;
  const int rows = octave.levels[0].rows, cols = octave.levels[0].cols;
  std::array<std::array<std::vector<std::int16_t>, 3>, kDifferences> ring;
  for (auto& of_level : ring) {
    for (auto& row : of_level) row.resize(static_cast<std::size_t>(cols));
  }
  const auto subtract_row = [&](int y) {
    for (std::size_t l = 0; l < kDifferences; ++l) {
      scale_kernels().subtract(octave.levels[l + 1].ptr<std::int16_t>(y), octave.levels[l].ptr<std::int16_t>(y), cols,
                               ring[l][static_cast<std::size_t>(y % 3)].data());
    }
  };
  // What is between pixels may be more than what is at one.
  const auto threshold = static_cast<std::int16_t>(0.5F * least * 255 * kGreyUnit);
  const int count = cols - 2 * kBorder;
  if (count <= 0 || rows <= 2 * kBorder) return;
  std::vector<std::uint8_t> found(static_cast<std::size_t>(count));
  const auto next = [&](const std::uint8_t* from) {
    const auto left = static_cast<std::size_t>(found.data() + found.size() - from);
    return left == 0 ? nullptr : static_cast<const std::uint8_t*>(std::memchr(from, 1, left));
  };
  const Differences differences(octave);
  subtract_row(kBorder - 1);
  subtract_row(kBorder);
  for (int y = kBorder; y < rows - kBorder; ++y) {
    subtract_row(y + 1);
    for (int level = 1; level <= kScalesPerOctave; ++level) {
      std::array<const std::int16_t*, 9> around{};
      for (int l = 0; l < 3; ++l) {
        for (int r = 0; r < 3; ++r) {
          around[static_cast<std::size_t>(3 * l + r)] =
              ring[static_cast<std::size_t>(level - 1 + l)][static_cast<std::size_t>((y - 1 + r) % 3)].data() +
              kBorder - 1;
        }
      }
      scale_kernels().extrema(around.data(), threshold, count, found.data());
      for (const std::uint8_t* at = next(found.data()); at != nullptr; at = next(at + 1)) {
        const int x = kBorder + static_cast<int>(at - found.data());
        Blob blob;
        if (refine(differences, number, level, y, x, least, &blob) && wanted(mask, blob.x_px, blob.y_px))
          out->push_back(blob);
      }
    }
  }
}

}  // namespace

ScaleSpace scale_space(const cv::Mat1b& grey) {
  ScaleSpace out;
  if (2 * std::min(grey.rows, grey.cols) < kSmallest) return out;
  cv::Mat1s first = blurred(doubled(grey), blur_between(kBlurOfImage, kFirstBlur));
  while (std::min(first.rows, first.cols) >= kSmallest) {
    Octave& octave = out.octaves.emplace_back();
    octave.levels[0] = first;
    for (int l = 1; l < kScalesPerOctave + 3; ++l) {
      octave.levels[static_cast<std::size_t>(l)] =
          blurred(octave.levels[static_cast<std::size_t>(l - 1)], blur_between(level_blur(l - 1), level_blur(l)));
    }
    first = halved(octave.levels[kScalesPerOctave]);
  }
  return out;
}

std::vector<Blob> find_blobs(const ScaleSpace& space, float least, const cv::Mat1b& mask) {
  std::vector<Blob> out;
  for (std::size_t i = 0; i < space.octaves.size(); ++i) {
    find_in(space.octaves[i], static_cast<int>(i), least, mask, &out);
  }
  return out;
}

}  // namespace coslam
