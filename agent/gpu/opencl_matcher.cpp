// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/opencl_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <ios>
#include <limits>
#include <locale>
#include <sstream>
#include <utility>
#include <vector>

#include "agent/gpu/match_source.h"
#include "agent/gpu/opencl.h"
#include "agent/track/cell_corners.h"
#include "agent/track/corner_score.h"
#include "agent/track/match_limits.h"
#include "agent/track/samples.h"
#include "agent/track/window.h"

namespace coslam {
namespace {

constexpr int kShiftSide = 2 * kShiftRadius + 3;

// As in match.cl.
struct DeviceSize {
  cl_int offset, cols, rows;
};
struct DeviceSought {
  std::array<cl_float, 2> from, motion;
  std::array<cl_float, 4> warp;
  cl_int moving;
};
struct DeviceKey {
  std::array<std::int16_t, kWindowArea> grey, dx, dy;
  cl_float squares;
  std::array<cl_float, 7> totals;
  std::array<cl_float, 49> inverse;
};
struct DeviceSighting {
  cl_int found;
  std::array<cl_float, 2> px;
  cl_int key_found;
  std::array<cl_float, 2> key_px;
  cl_float key_zncc;
  std::array<cl_float, 4> key_warp;
};
struct DeviceLimits {
  cl_float min_zncc, forward_backward_px, border_px;
};
struct DeviceCell {
  cl_int x0, y0, x1, y1;
};
struct DeviceCorner {
  cl_float x, y, score;
};
struct DeviceCellCorners {
  cl_float mean_score;
  cl_int count;
  std::array<DeviceCorner, kMostCellCorners> corners;  // strongest first
};

// The kernels with the CPU's constants in front.
std::string source() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << std::showpoint << std::setprecision(std::numeric_limits<float>::max_digits10);
  const auto whole = [&](const char* name, int value) { out << "#define " << name << " " << value << "\n"; };
  const auto real = [&](const char* name, double value) { out << "#define " << name << " " << value << "f\n"; };
  whole("WINDOW_SIDE", kWindowSide);
  whole("WINDOW_AREA", kWindowArea);
  real("WINDOW_HALF", kWindowHalf_px);
  real("WINDOW_REACH", kWindowReach_px);
  whole("MARGIN", PyramidLevel::kMargin);
  whole("WEIGHT_SUM", kWeightSum);
  whole("WEIGHT_SHIFT", kWeightShift);
  whole("SAMPLE_UNIT", kSampleUnit);
  whole("SAMPLE_CENTRE", kSampleCentre);
  whole("TEMPLATE_UNIT", kTemplateUnit);
  whole("TEMPLATE_SHIFT", kTemplateShift);
  whole("FINE_ITERATIONS", kFineIterations);
  whole("COARSE_ITERATIONS", kCoarseIterations);
  real("CONVERGED_FINE_PX", kConvergedFine_px);
  real("CONVERGED_COARSE_PX", kConvergedCoarse_px);
  real("WIDEST_STEP_PX", kWidestStep_px);
  real("FURTHEST_PX", kFurthest_px);
  real("LEAST_GAIN", kLeastGain);
  real("LEAST_TEXTURE", kLeastTexture);
  whole("GUESS_LEVEL", kGuessLevel);
  real("ALIKE_ZNCC", kAlike_zncc);
  whole("RETRY_TOP", kRetryTop);
  whole("BACKWARD_TOP", kBackwardTop);
  real("MOVING_ZNCC", kMovingZncc);
  real("MOVING_FORWARD_BACKWARD", kMovingForwardBackward);
  whole("MOTION_NEIGHBOURS", kMotionNeighbours);
  whole("SHIFT_RADIUS", kShiftRadius);
  whole("SHIFT_SIDE", kShiftSide);
  whole("KEY_ITERATIONS", kKeyIterations);
  real("KEY_CONVERGED_PX", kKeyConverged_px);
  real("KEY_FURTHEST_PX", kKeyFurthest_px);
  real("KEY_LEAST_GAIN", kKeyLeastGain);
  real("WIDEST_SCALE", kWidestScale);
  real("LEAST_DETERMINANT", kLeastDeterminant);
  whole("CORNER_HALF", kCornerHalf);
  whole("PRODUCT_SHIFT", kProductShift);
  real("SCORE_SCALE", kScoreScale);
  real("LEAST_CORNER_SCORE", kLeastCornerScore);
  whole("MOST_CELL_CORNERS", static_cast<int>(kMostCellCorners));
  return out.str() + kMatchSource;
}

template <class To, class From>
To copied(const From& from) {
  To to{};
  std::copy_n(from.data(), to.size(), to.begin());
  return to;
}

DeviceSought device_sought(const Sought& t) {
  const Eigen::Matrix2f& w = t.key->warp;
  return {copied<std::array<cl_float, 2>>(t.from_px),
          copied<std::array<cl_float, 2>>(t.motion_px),
          {w(0, 0), w(0, 1), w(1, 0), w(1, 1)},
          t.moving};
}

DeviceKey device_key(const KeyPatch& k) {
  using Grey = std::array<std::int16_t, kWindowArea>;
  return {copied<Grey>(k.grey),
          copied<Grey>(k.dx),
          copied<Grey>(k.dy),
          k.squares,
          copied<std::array<cl_float, 7>>(k.totals),
          copied<std::array<cl_float, 49>>(k.inverse)};
}

TrackSighting sighting(const DeviceSighting& s) {
  TrackSighting out;
  if (s.found == 0) return out;
  out.found = true;
  out.px = {s.px[0], s.px[1]};
  if (s.key_found == 0) return out;
  out.key.found = true;
  out.key.px = {s.key_px[0], s.key_px[1]};
  out.key.zncc = s.key_zncc;
  out.key.warp << s.key_warp[0], s.key_warp[1], s.key_warp[2], s.key_warp[3];
  return out;
}

class OpenClMatcher final : public Matcher {
 public:
  OpenClMatcher(const TrackerConfig& config, bool gpu_only) : config_(config), device_(gpu_only, source()) {}

  // Reads under way write to what goes now.
  ~OpenClMatcher() override { device_.wait(); }
  OpenClMatcher(const OpenClMatcher&) = delete;
  OpenClMatcher& operator=(const OpenClMatcher&) = delete;

  std::string device() const { return device_.name(); }

  void push(const cv::Mat& grey) override {
    std::swap(before_, newest_);
    std::swap(pyramid_before_, pyramid_newest_);
    newest_.build(grey, 1);
    if (sizes_.empty()) lay_out(grey.cols, grey.rows);
    const PyramidLevel& image = newest_.level(0);
    device_.write_rows(pyramid_newest_, image.at(0, 0), static_cast<std::size_t>(image.cols()),
                       static_cast<std::size_t>(image.rows()), static_cast<std::size_t>(image.stride()));
    for (cl_int l = 1; l < levels(); ++l) device_.run(halve_, of_pixels(l), kAcross, pyramid_newest_, size_buffer_, l);
    look_for_corners();
  }

  Following follow(const std::vector<Sought>& tracks, const Eigen::Vector2f& last_shift_px) override {
    if (tracks.size() > room_) make_room(tracks.size());
    send(tracks);
    const cl_int top = levels() - 1, count = static_cast<cl_int>(tracks.size());
    const DeviceLimits limits = {static_cast<float>(config_.min_zncc), static_cast<float>(config_.forward_backward_px),
                                 static_cast<float>(config_.border_px)};
    const cl_float2 last_shift = {{last_shift_px.x(), last_shift_px.y()}};
    const std::size_t group = device_.group();
    const ClRange of_tracks = {group * tracks.size()}, of_shifts = {group * kShiftSide, kShiftSide};
    device_.run(try_shifts_, of_shifts, group, pyramid_before_, pyramid_newest_, size_buffer_, top, shifts_);
    device_.run(pick_shift_, {}, 1, shifts_, size_buffer_, top, sightings_);
    device_.run(match_tracks_, of_tracks, group, pyramid_before_, pyramid_newest_, size_buffer_, levels(), limits,
                last_shift, sought_, sightings_);
    device_.run(match_again_, of_tracks, group, pyramid_before_, pyramid_newest_, size_buffer_, levels(), limits,
                sought_, count, sightings_);
    device_.run(find_keys_, of_tracks, group, pyramid_newest_, size_buffer_, levels(), sought_, keys_, sightings_);
    return receive(tracks.size());
  }

  void watch(const std::vector<CornerCell>& cells) override {
    std::vector<DeviceCell> device_cells;
    device_cells.reserve(cells.size());
    for (const CornerCell& c : cells) device_cells.push_back({c.x0, c.y0, c.x1, c.y1});
    cells_ = device_.buffer(device_cells.size() * sizeof(DeviceCell));
    device_.write(cells_, device_cells.data(), device_cells.size() * sizeof(DeviceCell));
    const DeviceSize& level = sizes_[static_cast<std::size_t>(corner_level(levels()))];
    columns_ =
        device_.buffer(static_cast<std::size_t>(3 * (level.cols + 2 * kCornerHalf) * level.rows) * sizeof(cl_int));
    scores_ = device_.buffer(static_cast<std::size_t>(level.cols * level.rows) * sizeof(cl_float));
    found_corners_ = device_.buffer(device_cells.size() * sizeof(DeviceCellCorners));
    corners_.resize(device_cells.size());
    look_for_corners();
  }

  CellCorners corners(std::size_t cell) override {
    if (!corners_are_here_) device_.finish();
    corners_are_here_ = true;
    const DeviceCellCorners& found = corners_[cell];
    CellCorners out{{}, found.mean_score};
    for (cl_int i = found.count - 1; i >= 0; --i) {
      const DeviceCorner& c = found.corners.at(static_cast<std::size_t>(i));
      out.corners.push_back({{c.x, c.y}, c.score});
    }
    return out;
  }

  const Pyramid& before() const override { return before_; }
  const Pyramid& newest() const override { return newest_; }

 private:
  static constexpr std::size_t kAcross = 64;  // pixels of a row that a group has

  cl_int levels() const { return static_cast<cl_int>(sizes_.size()); }

  // An item a pixel of the level, in rows of whole groups, with some more beside it.
  ClRange of_pixels(cl_int l, int more_cols = 0) const {
    const DeviceSize& size = sizes_[static_cast<std::size_t>(l)];
    return {(static_cast<std::size_t>(size.cols + more_cols) + kAcross - 1) / kAcross * kAcross,
            static_cast<std::size_t>(size.rows)};
  }

  // What they are comes back with the sightings.
  void look_for_corners() {
    if (corners_.empty()) return;
    const cl_int l = corner_level(levels());
    device_.run(sum_columns_, of_pixels(l, 2 * kCornerHalf), kAcross, pyramid_newest_, size_buffer_, l, columns_);
    device_.run(score_corners_, of_pixels(l), kAcross, columns_, size_buffer_, l, scores_);
    const std::size_t group = device_.group();
    device_.run(find_corners_, {group * corners_.size()}, group, scores_, size_buffer_, l, cells_, found_corners_);
    device_.start_read(found_corners_, corners_.data(), corners_.size() * sizeof(DeviceCellCorners));
    corners_are_here_ = false;
  }

  void lay_out(int cols, int rows) {
    const int count = pyramid_levels(cols, rows, config_.levels);
    int bytes = 0;
    for (int l = 0; l < count; ++l) {
      sizes_.push_back({bytes, cols, rows});
      bytes += cols * rows;
      cols = (cols + 1) / 2;
      rows = (rows + 1) / 2;
    }
    size_buffer_ = device_.buffer(sizes_.size() * sizeof(DeviceSize));
    device_.write(size_buffer_, sizes_.data(), sizes_.size() * sizeof(DeviceSize));
    pyramid_before_ = device_.buffer(static_cast<std::size_t>(bytes));
    pyramid_newest_ = device_.buffer(static_cast<std::size_t>(bytes));
    shifts_ = device_.buffer(kShiftSide * kShiftSide * sizeof(cl_float));
  }

  void make_room(std::size_t tracks) {
    room_ = tracks + tracks / 2;
    sought_ = device_.buffer(room_ * sizeof(DeviceSought));
    keys_ = device_.buffer(room_ * sizeof(DeviceKey));
    sightings_ = device_.buffer((room_ + 1) * sizeof(DeviceSighting));
  }

  void send(const std::vector<Sought>& tracks) {
    std::vector<DeviceSought> sought;
    std::vector<DeviceKey> keys;
    for (const Sought& t : tracks) {
      sought.push_back(device_sought(t));
      keys.push_back(device_key(*t.key));
    }
    device_.write(sought_, sought.data(), sought.size() * sizeof(DeviceSought));
    device_.write(keys_, keys.data(), keys.size() * sizeof(DeviceKey));
  }

  Following receive(std::size_t tracks) {
    seen_.resize(tracks + 1);
    device_.start_read(sightings_, seen_.data(), seen_.size() * sizeof(DeviceSighting));
    device_.finish();
    corners_are_here_ = true;
    Following out;
    out.shift_px = {seen_[0].px[0], seen_[0].px[1]};
    for (std::size_t i = 0; i < tracks; ++i) out.sightings.push_back(sighting(seen_[i + 1]));
    return out;
  }

  const TrackerConfig config_;
  Pyramid before_, newest_;
  const ClDevice device_;
  const ClKernel halve_ = device_.kernel("halve"), try_shifts_ = device_.kernel("try_shifts"),
                 pick_shift_ = device_.kernel("pick_shift"), match_tracks_ = device_.kernel("match_tracks"),
                 match_again_ = device_.kernel("match_again"), find_keys_ = device_.kernel("find_keys"),
                 sum_columns_ = device_.kernel("sum_columns"), score_corners_ = device_.kernel("score_corners"),
                 find_corners_ = device_.kernel("find_corners");
  std::vector<DeviceSize> sizes_;  // of the levels
  ClBuffer size_buffer_, pyramid_before_, pyramid_newest_, shifts_;
  std::size_t room_ = 0;  // tracks that fit
  ClBuffer sought_, keys_, sightings_;
  ClBuffer cells_, columns_, scores_, found_corners_;
  std::vector<DeviceSighting> seen_;
  std::vector<DeviceCellCorners> corners_;  // of the newest image, by cell
  bool corners_are_here_ = false;
};

}  // namespace

DeviceMatcher opencl_matcher(const TrackerConfig& config, bool gpu_only) {
  auto matcher = std::make_unique<OpenClMatcher>(config, gpu_only);
  std::string device = matcher->device();
  return {std::move(device), std::move(matcher)};
}

}  // namespace coslam
