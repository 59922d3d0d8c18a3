// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/matcher_for.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "agent/track/tracker.h"
#include "agent/track/working_scale.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "tests/support/synthetic_view.h"
#include "tests/support/tracking_devices.h"

namespace coslam::matcher_for_test {
namespace {

// A device that fails at one of the calls, and each one after it.
class FailingMatcher final : public Matcher {
 public:
  FailingMatcher(std::unique_ptr<Matcher> device, int good_calls)
      : device_(std::move(device)), good_calls_(good_calls) {}

  void push(const cv::Mat& grey) override {
    device_->push(grey);
    call();
  }
  void restart() override {
    call();
    device_->restart();
  }
  Following follow(const std::vector<Sought>& tracks, const Eigen::Vector2f& last_shift_px) override {
    call();
    return device_->follow(tracks, last_shift_px);
  }
  void watch(const std::vector<CornerCell>& cells) override {
    device_->watch(cells);
    call();
  }
  CellCorners corners(std::size_t cell) override {
    call();
    return device_->corners(cell);
  }
  const Pyramid& before() const override { return device_->before(); }
  const Pyramid& newest() const override { return device_->newest(); }

 private:
  void call() {
    if (good_calls_-- <= 0) throw DeviceFailure("failed");
  }

  std::unique_ptr<Matcher> device_;
  int good_calls_;
};

cv::Mat image(int i) {
  static const cv::Mat texture = test::plane_texture(700, 600, 3);
  const cv::Size size(320, 240);
  return test::render(texture, test::View::at({300 + 3.0 * i, 250 + 2.0 * i}, 0, 1, size), size);
}

// The tracks of eight images, the last three of half the size, and how many warnings there were.
std::pair<std::vector<std::vector<Track>>, int> tracked(std::unique_ptr<Matcher> matcher) {
  init_log("gpu_test");
  testing::internal::CaptureStderr();
  Tracker tracker({}, std::move(matcher));
  std::vector<std::vector<Track>> all;
  for (int i = 0; i < 5; ++i) all.push_back(tracker.step(image(i)));
  tracker.resize(scaled_image(image(4), 0.5), 0.5);
  for (int i = 5; i < 8; ++i) all.push_back(tracker.step(scaled_image(image(i), 0.5)));
  const std::string said = testing::internal::GetCapturedStderr();
  int warnings = 0;
  for (std::size_t at = 0; (at = said.find("tracking goes on on the CPU", at)) != std::string::npos; ++at) ++warnings;
  return {all, warnings};
}

void expect_same_tracks(const std::vector<std::vector<Track>>& all, const std::vector<std::vector<Track>>& expected) {
  ASSERT_EQ(all.size(), expected.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_EQ(all[i].size(), expected[i].size()) << i;
    for (std::size_t k = 0; k < all[i].size(); ++k) {
      EXPECT_EQ(all[i][k].id, expected[i][k].id);
      EXPECT_EQ(all[i][k].age_frames, expected[i][k].age_frames);
      EXPECT_EQ(all[i][k].raw_px, expected[i][k].raw_px);
    }
  }
}

TEST(Fallback, NoTrackIsLostWhereverTheDeviceFails) {
  const auto [expected, none] = tracked(cpu_matcher({}));
  EXPECT_EQ(none, 0);
  // The first image's push, the grid, a cell of it, then anywhere.
  for (const int good_calls : {0, 1, 2, 100, 150, 165, 170, 175, 180, 185, 190}) {
    auto failing = std::make_unique<FailingMatcher>(cpu_matcher({}), good_calls);
    const auto [all, warnings] = tracked(with_fallback({"broken", std::move(failing)}, {}));
    EXPECT_EQ(warnings, 1) << good_calls;
    expect_same_tracks(all, expected);
  }
}

// What the device has on the CPU is enough to go on from.
TEST(Fallback, FromARealDeviceToTheCpu) {
  DeviceMatcher device;
  try {
    device = test::matcher_by("opencl", {});
  } catch (const NoDevice&) {
    GTEST_SKIP() << "no OpenCL device: install pocl-opencl-icd";
  }
  const std::vector<std::vector<Track>> expected = tracked(cpu_matcher({})).first;
  device.matcher = std::make_unique<FailingMatcher>(std::move(device.matcher), 170);
  const auto [all, warnings] = tracked(with_fallback(std::move(device), {}));
  EXPECT_EQ(warnings, 1);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(all[i].size()), static_cast<double>(expected[i].size()), 3) << i;
    const std::size_t same = std::min(all[i].size(), expected[i].size()) / 2;  // the oldest
    for (std::size_t k = 0; k < same; ++k) {
      EXPECT_EQ(all[i][k].id, expected[i][k].id);
      EXPECT_EQ(all[i][k].age_frames, expected[i][k].age_frames);
      EXPECT_LT((all[i][k].raw_px - expected[i][k].raw_px).norm(), 0.05F);
    }
  }
}

TEST(MatcherFor, EveryDeviceThatIsKnownIsMadeOrNamed) {
  for (const std::string& device : tracker_devices()) {
    try {
      EXPECT_NE(matcher_for({.device = device}), nullptr);
    } catch (const UserError& error) {
      EXPECT_TRUE(device == "opencl" || device == "cuda") << device;
      EXPECT_NE(std::string(error.what()).find("agent.tracker.device"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace coslam::matcher_for_test
