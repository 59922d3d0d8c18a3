// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/device_matcher.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "agent/gpu/device_values.h"
#include "agent/gpu/match_program.h"
#include "agent/track/cell_corners.h"

namespace coslam {
namespace {

class MatcherOnDevice final : public Matcher {
 public:
  MatcherOnDevice(std::unique_ptr<Device> device, const TrackerConfig& config)
      : config_(config), device_(std::move(device)) {}

  // What is under way reads and writes what goes now.
  ~MatcherOnDevice() override { device_->wait(); }
  MatcherOnDevice(const MatcherOnDevice&) = delete;
  MatcherOnDevice& operator=(const MatcherOnDevice&) = delete;

  void push(const cv::Mat& grey) override {
    // The memory of the image before last is free then. What failed meanwhile may be said by a call below: the fallback
    // goes on from this image.
    if (!settled_) device_->wait();
    std::swap(before_, newest_);
    std::swap(pyramid_before_, pyramid_newest_);
    newest_.build(grey, 1);
    const PyramidLevel& image = newest_.level(0);
    if (sizes_.empty()) lay_out(image);
    settled_ = false;
    device_->start_write(pyramid_newest_, 0, image.first_byte(), image.bytes());
    for (std::int32_t l = 1; l < levels(); ++l) {
      device_->run(halve_, of_pixels(l), kAcross, pyramid_newest_, size_buffer_, l);
    }
    look_for_corners();
  }

  void restart() override {
    settle();
    before_ = newest_ = {};
    sizes_.clear();
    corners_.clear();
    key_places_.clear();
  }

  Following follow(const std::vector<Sought>& tracks, const Eigen::Vector2f& last_shift_px) override {
    make_room(tracks.size());
    send(tracks);
    const std::int32_t top = levels() - 1, count = static_cast<std::int32_t>(tracks.size());
    const DeviceLimits limits = device_limits(config_);
    const std::array<float, 2> last_shift = {last_shift_px.x(), last_shift_px.y()};
    const std::size_t group = device_->group();
    const Device::Items of_tracks = {group * tracks.size()}, of_shifts = {group * kShiftSide, kShiftSide};
    device_->run(try_shifts_, of_shifts, group, pyramid_before_, pyramid_newest_, size_buffer_, top, shifts_);
    device_->run(pick_shift_, {group}, group, shifts_, size_buffer_, top, sightings_);
    device_->run(match_tracks_, of_tracks, group, pyramid_before_, pyramid_newest_, size_buffer_, levels(), limits,
                 last_shift, sought_, sightings_);
    device_->run(match_again_, of_tracks, group, pyramid_before_, pyramid_newest_, size_buffer_, levels(), limits,
                 sought_, count, sightings_);
    device_->run(find_keys_, of_tracks, group, pyramid_newest_, size_buffer_, levels(), sought_, keys_, sightings_);
    return receive(tracks.size());
  }

  void watch(const std::vector<CornerCell>& cells) override {
    sent_cells_.clear();
    for (const CornerCell& c : cells) sent_cells_.push_back({c.x0, c.y0, c.x1, c.y1});
    cells_ = device_->memory(sent_cells_.size() * sizeof(DeviceCell));
    device_->start_write(cells_, 0, sent_cells_.data(), sent_cells_.size() * sizeof(DeviceCell));
    const DeviceSize& level = sizes_[static_cast<std::size_t>(corner_level(levels()))];
    columns_ = device_->memory(static_cast<std::size_t>(3 * (level.cols + 2 * kCornerHalf) * level.rows) *
                               sizeof(std::int32_t));
    scores_ = device_->memory(static_cast<std::size_t>(level.cols * level.rows) * sizeof(float));
    maxima_ = device_->memory(static_cast<std::size_t>(level.cols * level.rows) * sizeof(float));
    found_corners_ = device_->memory(cells.size() * sizeof(DeviceCellCorners));
    corners_.resize(cells.size());
    look_for_corners();
  }

  CellCorners corners(std::size_t cell) override {
    settle();
    return cell_corners(corners_[cell]);
  }

  const Pyramid& before() const override { return before_; }
  const Pyramid& newest() const override { return newest_; }

 private:
  static constexpr std::size_t kAcross = 64;  // pixels of a row that a group has

  std::int32_t levels() const { return static_cast<std::int32_t>(sizes_.size()); }

  // An item a pixel of the level, in rows of whole groups, with some more beside it.
  Device::Items of_pixels(std::int32_t l, int more_cols = 0) const {
    const DeviceSize& size = sizes_[static_cast<std::size_t>(l)];
    return {(static_cast<std::size_t>(size.cols + more_cols) + kAcross - 1) / kAcross * kAcross,
            static_cast<std::size_t>(size.rows)};
  }

  // All that was queued is done.
  void settle() {
    if (!settled_) device_->finish();
    settled_ = true;
  }

  // What they are comes back with the sightings.
  void look_for_corners() {
    if (corners_.empty()) return;
    const std::int32_t l = corner_level(levels());
    device_->run(sum_columns_, of_pixels(l, 2 * kCornerHalf), kAcross, pyramid_newest_, size_buffer_, l, columns_);
    device_->run(score_corners_, of_pixels(l), kAcross, columns_, size_buffer_, l, scores_);
    const std::size_t group = device_->group();
    device_->run(keep_maxima_, of_pixels(l), kAcross, scores_, size_buffer_, l, maxima_);
    device_->run(find_corners_, {group * corners_.size()}, group, scores_, maxima_, size_buffer_, l, cells_,
                 found_corners_);
    device_->start_read(found_corners_, corners_.data(), corners_.size() * sizeof(DeviceCellCorners));
    settled_ = false;
  }

  // The image comes as it lies on the CPU, with its margin; the other levels follow without.
  void lay_out(const PyramidLevel& image) {
    const int count = pyramid_levels(image.cols(), image.rows(), config_.levels);
    DeviceSize size{static_cast<std::int32_t>(image.at(0, 0) - image.first_byte()), image.cols(), image.rows(),
                    static_cast<std::int32_t>(image.stride())};
    auto bytes = static_cast<std::int32_t>(image.bytes());
    for (int l = 0; l < count; ++l) {
      sizes_.push_back(size);
      const std::int32_t cols = (size.cols + 1) / 2;
      size = {bytes, cols, (size.rows + 1) / 2, cols};
      bytes += size.cols * size.rows;
    }
    size_buffer_ = device_->memory(sizes_.size() * sizeof(DeviceSize));
    device_->start_write(size_buffer_, 0, sizes_.data(), sizes_.size() * sizeof(DeviceSize));
    pyramid_before_ = device_->memory(static_cast<std::size_t>(bytes));
    pyramid_newest_ = device_->memory(static_cast<std::size_t>(bytes));
    shifts_ = device_->memory(kShiftSide * kShiftSide * sizeof(float));
  }

  void make_room(std::size_t tracks) {
    if (tracks <= room_) return;
    settle();  // whatever uses what goes now
    room_ = tracks + tracks / 2;
    sought_ = device_->memory(room_ * sizeof(DeviceSought));
    keys_ = device_->memory(kKeysPerTrack * room_ * sizeof(DeviceKey));
    sightings_ = device_->memory((room_ + 1) * sizeof(DeviceSighting));
    key_places_.clear();
  }

  // First patches that are not there yet go behind those that are; when the room is used up all are sent anew.
  void send(const std::vector<Sought>& tracks) {
    const auto is_there = [&](const Sought& t) { return key_places_.contains(t.key->number); };
    const auto fresh = static_cast<std::size_t>(std::count_if(tracks.begin(), tracks.end(), std::not_fn(is_there)));
    if (key_places_.size() + fresh > kKeysPerTrack * room_) key_places_.clear();
    const std::size_t first = key_places_.size();
    sent_.clear();
    sent_keys_.clear();
    for (const Sought& t : tracks) {
      const auto [place, is_new] = key_places_.try_emplace(t.key->number, key_places_.size());
      if (is_new) sent_keys_.push_back(device_key(*t.key));
      sent_.push_back(device_sought(t, static_cast<std::int32_t>(place->second)));
    }
    device_->start_write(sought_, 0, sent_.data(), sent_.size() * sizeof(DeviceSought));
    if (sent_keys_.empty()) return;
    device_->start_write(keys_, first * sizeof(DeviceKey), sent_keys_.data(), sent_keys_.size() * sizeof(DeviceKey));
  }

  Following receive(std::size_t tracks) {
    seen_.resize(tracks + 1);
    device_->start_read(sightings_, seen_.data(), seen_.size() * sizeof(DeviceSighting));
    settled_ = false;
    settle();
    Following out;
    out.shift_px = {seen_[0].px[0], seen_[0].px[1]};
    for (std::size_t i = 0; i < tracks; ++i) out.sightings.push_back(track_sighting(seen_[i + 1]));
    return out;
  }

  static constexpr std::size_t kKeysPerTrack = 4;  // room

  const TrackerConfig config_;
  Pyramid before_, newest_;
  const std::unique_ptr<Device> device_;
  const Device::Handle halve_ = device_->kernel("halve"), try_shifts_ = device_->kernel("try_shifts"),
                       pick_shift_ = device_->kernel("pick_shift"), match_tracks_ = device_->kernel("match_tracks"),
                       match_again_ = device_->kernel("match_again"), find_keys_ = device_->kernel("find_keys"),
                       sum_columns_ = device_->kernel("sum_columns"), score_corners_ = device_->kernel("score_corners"),
                       keep_maxima_ = device_->kernel("keep_maxima"), find_corners_ = device_->kernel("find_corners");
  std::vector<DeviceSize> sizes_;  // of the levels
  Device::Handle size_buffer_, pyramid_before_, pyramid_newest_, shifts_;
  std::size_t room_ = 0;  // tracks that fit
  Device::Handle sought_, keys_, sightings_;
  std::unordered_map<std::uint32_t, std::size_t> key_places_;  // by number
  std::vector<DeviceSought> sent_;
  std::vector<DeviceKey> sent_keys_;
  std::vector<DeviceSighting> seen_;
  std::vector<DeviceCell> sent_cells_;
  Device::Handle cells_, columns_, scores_, maxima_, found_corners_;
  std::vector<DeviceCellCorners> corners_;  // of the newest image, by cell
  bool settled_ = true;
};

}  // namespace

DeviceMatcher device_matcher(std::unique_ptr<Device> device, const TrackerConfig& config) {
  std::string name = device->name();
  return {std::move(name), std::make_unique<MatcherOnDevice>(std::move(device), config)};
}

}  // namespace coslam
