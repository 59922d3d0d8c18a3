// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The device's answers against the CPU's, on whatever devices there are: without a GPU that of pocl-opencl-icd.
#include "agent/gpu/device_matcher.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "agent/track/tracker.h"
#include "tests/support/compared_matcher.h"
#include "tests/support/synthetic_view.h"
#include "tests/support/tracking_devices.h"

namespace coslam::device_matcher_test {
namespace {

// A plane under a camera that moves, turns, zooms and changes its exposure, with a block that passes in front.
class Sequence {
 public:
  explicit Sequence(const cv::Size& size) : size_(size) {}
  cv::Mat image(int i) const {
    const double scale = size_.width / 640.0;
    const test::View view = test::view_on_loop(0.05 * i, {200 * scale, 120 * scale}, 0.3, 0.2, size_);
    cv::Mat image = test::render(plane_, view, size_, static_cast<std::uint64_t>(i) + 1);
    const cv::Rect at(7 * i % (size_.width / 2), size_.height / 3, size_.width / 5, size_.height / 3);
    block_(cv::Rect({}, at.size())).copyTo(image(at));
    return image;
  }

 private:
  cv::Size size_;
  cv::Mat plane_ = test::plane_texture(1400, 1100, 1), block_ = test::plane_texture(200, 200, 2);
};

class OnDevice : public testing::TestWithParam<const char*> {
 protected:
  // Null, and the test skipped, without such a device.
  static std::unique_ptr<Matcher> device(const TrackerConfig& config) {
    try {
      return test::matcher_by(GetParam(), config).matcher;
    } catch (const NoDevice& none) {
      [&] { GTEST_SKIP() << none.what(); }();
      return nullptr;
    }
  }
};
INSTANTIATE_TEST_SUITE_P(By, OnDevice, testing::Values("opencl", "cuda"),
                         [](const auto& param) { return std::string(param.param); });

TEST_P(OnDevice, SeesTracksAndCornersWhereTheCpuDoes) {
  const TrackerConfig config;
  for (const cv::Size& size : {cv::Size(640, 480), cv::Size(301, 177)}) {
    auto matcher = device(config);
    if (!matcher) return;
    test::Agreement agreement;
    Tracker tracker(config,
                    std::make_unique<test::ComparedMatcher>(cpu_matcher(config), std::move(matcher), &agreement));
    const Sequence sequence(size);
    for (int i = 0; i < 20; ++i) tracker.step(sequence.image(i));
    ASSERT_GT(agreement.distances_px.size(), 1000U);
    EXPECT_LT(test::quantile(agreement.distances_px, 0.5), 1e-3F);
    EXPECT_LT(test::quantile(agreement.distances_px, 0.99), 0.05F);
    ASSERT_GT(agreement.corner_distances_px.size(), 300U);
    EXPECT_LT(test::quantile(agreement.corner_distances_px, 0.99), 1e-3F);
  }
}

TEST_P(OnDevice, TracksByItselfAsWellAsTheCpu) {
  const TrackerConfig config;
  auto matcher = device(config);
  if (!matcher) return;
  Tracker on_device(config, std::move(matcher)), on_cpu(config);
  const Sequence sequence({640, 480});
  double device_ages = 0, cpu_ages = 0;
  for (int i = 0; i < 20; ++i) {
    for (const Track& t : on_device.step(sequence.image(i))) device_ages += t.age_frames;
    for (const Track& t : on_cpu.step(sequence.image(i))) cpu_ages += t.age_frames;
  }
  EXPECT_NEAR(device_ages / cpu_ages, 1, 0.01);
}

TEST_P(OnDevice, SameImagesSameBits) {
  const TrackerConfig config;
  auto first = device(config), second = device(config);
  if (!first) return;
  Tracker one(config, std::move(first)), two(config, std::move(second));
  const Sequence sequence({320, 240});
  for (int i = 0; i < 8; ++i) {
    const auto &a = one.step(sequence.image(i)), &b = two.step(sequence.image(i));
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].id, b[k].id);
      EXPECT_EQ(a[k].raw_px, b[k].raw_px);
    }
  }
}

// A device has room for the first patches of so many tracks, old ones included, and then takes all anew.
TEST_P(OnDevice, KnowsFirstPatchesAfterManyTracks) {
  const TrackerConfig config{.max_tracks = 40};
  auto matcher = device(config);
  if (!matcher) return;
  test::Agreement agreement;
  Tracker tracker(config, std::make_unique<test::ComparedMatcher>(cpu_matcher(config), std::move(matcher), &agreement));
  const Sequence sequence({320, 240});
  for (int i = 0; i < 120; ++i) tracker.step(sequence.image(i));
  ASSERT_GT(tracker.live().back().id.value, 300U) << "more than there is room for";
  EXPECT_LT(test::quantile(agreement.distances_px, 0.99), 0.05F);
}

// More tracks than there were before, images with nothing to see, and levels that have no room.
TEST_P(OnDevice, BearsWhatTheCpuBears) {
  const TrackerConfig config{.max_tracks = 30, .levels = 8};
  auto matcher = device(config);
  if (!matcher) return;
  Tracker tracker(config, std::move(matcher));
  const Sequence sequence({64, 48});
  tracker.step(sequence.image(0));
  std::vector<Eigen::Vector2f> places;
  for (int x = 0; x < 64; ++x) places.emplace_back(x, 20);
  tracker.add(places, 0);
  tracker.step(sequence.image(1));
  EXPECT_FALSE(tracker.live().empty());
  EXPECT_TRUE(tracker.step(cv::Mat(48, 64, CV_8U, cv::Scalar(255))).empty());
  EXPECT_FALSE(tracker.step(sequence.image(2)).empty());
}

}  // namespace
}  // namespace coslam::device_matcher_test
