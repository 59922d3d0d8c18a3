// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/klt_feature_tracker.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "agent/track/tags.h"
#include "common/base/error.h"
#include "tests/support/synthetic_view.h"
#include "tests/support/temp_folder.h"

namespace coslam::klt_feature_tracker_test {
namespace {

CameraModel camera_of(const cv::Size& image) {
  CameraModel c;
  c.width_px = image.width;
  c.height_px = image.height;
  c.fx = c.fy = 0.75 * image.width;
  c.cx = 0.5 * (image.width - 1);
  c.cy = 0.5 * (image.height - 1);
  return c;
}

std::string mask_file(const test::TempFolder& folder) { return (folder / "mask.png").string(); }

// Small images that are doubled, usual ones, and ones that are shrunk.
class KltFeatureTrackerAtWidth : public testing::TestWithParam<int> {
 protected:
  Image image(int frame) const {
    const test::View view = test::View::at({400 + kStepX * frame, 300 + kStepY * frame}, 0, 1, size_);
    return {FrameId(static_cast<std::uint32_t>(frame)), frame * TimeNs{33'000'000},
            test::render(texture_, view, size_, 1)};
  }
  static constexpr double kStepX = 3.3, kStepY = 1.7;
  const cv::Size size_{GetParam(), GetParam() * 3 / 4};
  const cv::Mat texture_ = test::plane_texture(900, 700, 4);
};
INSTANTIATE_TEST_SUITE_P(Widths, KltFeatureTrackerAtWidth, testing::Values(320, 500, 640));

TEST_P(KltFeatureTrackerAtWidth, TracksAreInRawPixels) {
  const TrackerConfig config = {.most_width_px = 560};
  const auto tracker = klt_feature_tracker(camera_of(size_), config, kNoTags, cpu_matcher(config));
  std::map<TrackId, Eigen::Vector2f> began;
  for (const Track& t : tracker->step(image(0))) began[t.id] = t.raw_px;
  ASSERT_GT(began.size(), 80U);
  std::vector<double> errors_px;
  for (int i = 1; i < 6; ++i) {
    tracker->step(image(i));
    for (const Track& t : tracker->live()) {
      if (!began.contains(t.id)) continue;
      const Eigen::Vector2f moved = t.raw_px - began[t.id];
      if (i == 5) errors_px.push_back((moved.cast<double>() + 5 * Eigen::Vector2d(kStepX, kStepY)).norm());
      EXPECT_GE(t.raw_px.x(), 0);
      EXPECT_LT(t.raw_px.x(), size_.width);
    }
  }
  ASSERT_GT(errors_px.size(), 50U);
  std::ranges::nth_element(errors_px, errors_px.begin() + std::ssize(errors_px) / 2);
  EXPECT_LT(errors_px[errors_px.size() / 2], 0.15);
}

TEST_P(KltFeatureTrackerAtWidth, NothingIsTrackedWhereTheMaskIsBlack) {
  test::TempFolder folder;
  cv::Mat mask(size_, CV_8UC1, cv::Scalar(255));
  mask.rowRange(size_.height / 2, size_.height).setTo(0);  // a hood
  cv::imwrite(mask_file(folder), mask);
  const TrackerConfig config = {.most_width_px = 560, .mask = mask_file(folder)};
  const auto tracker = klt_feature_tracker(camera_of(size_), config, kNoTags, cpu_matcher(config));
  for (int i = 0; i < 6; ++i) {
    const auto& live = tracker->step(image(i));
    EXPECT_GT(live.size(), 40U);
    for (const Track& t : live) EXPECT_LT(t.raw_px.y(), static_cast<float>(size_.height) / 2);
  }
  const auto described = tracker->describe_strongest(200)()(100);
  EXPECT_GT(described.tracks.size(), 20U);
  for (const Track& t : tracker->live()) EXPECT_LT(t.raw_px.y(), static_cast<float>(size_.height) / 2);
}

TEST(KltFeatureTrackerMask, OfAnotherSizeIsRefused) {
  test::TempFolder folder;
  cv::imwrite(mask_file(folder), cv::Mat(48, 64, CV_8UC1, cv::Scalar(255)));
  const auto error = [&](const std::string& file) {
    return test::error_of<UserError>([&] {
      const TrackerConfig config = {.mask = file};
      klt_feature_tracker(camera_of({640, 480}), config, kNoTags, cpu_matcher(config));
    });
  };
  EXPECT_THAT(error(mask_file(folder)),
              testing::HasSubstr("mask.png is 64x48 pixels, the camera's images are 640x480"));
  EXPECT_THAT(error("nowhere.png"), testing::HasSubstr("the mask nowhere.png cannot be read"));
}

TEST_P(KltFeatureTrackerAtWidth, PatchesAreCutFromTheRawImage) {
  const TrackerConfig config = {.most_width_px = 560};
  const auto tracker = klt_feature_tracker(camera_of(size_), config, kNoTags, cpu_matcher(config));
  const Image first = image(0);
  tracker->step(first);
  const std::vector<Track> live = tracker->live();
  const auto patches = tracker->patches({live[3].id, live[40].id});
  ASSERT_EQ(patches.size(), 2U);
  const cv::Mat small = shrink_for_patches(first.grey);
  EXPECT_EQ(patches[0].grey, cut_patch(small, live[3]).grey);
  EXPECT_EQ(patches[1].grey, cut_patch(small, live[40]).grey);
}

TEST_P(KltFeatureTrackerAtWidth, DescribedFeaturesStartTracksInRawPixels) {
  const TrackerConfig config = {.max_tracks = 20, .most_width_px = 560};
  const auto tracker = klt_feature_tracker(camera_of(size_), config, kNoTags, cpu_matcher(config));
  tracker->step(image(0));
  const std::size_t before = tracker->live().size();
  const DescribedTracks described = tracker->describe_strongest(100)()(100);
  EXPECT_GT(tracker->live().size(), before);
  EXPECT_GT(described.tracks.size(), 30U);
  float farthest = 0;
  for (const Track& t : tracker->live()) farthest = std::max(farthest, t.raw_px.x() / static_cast<float>(size_.width));
  EXPECT_GT(farthest, 0.8);
  EXPECT_LT(farthest, 1);
}

TEST_P(KltFeatureTrackerAtWidth, FeaturesOfAnEarlierImageStartTracksInTheNewest) {
  const TrackerConfig config = {.max_tracks = 20, .most_width_px = 560};
  const auto at_once = klt_feature_tracker(camera_of(size_), config, kNoTags, cpu_matcher(config));
  const auto late = klt_feature_tracker(camera_of(size_), config, kNoTags, cpu_matcher(config));
  using Descriptor = std::vector<std::uint8_t>;
  const auto places = [](const FeatureTracker& tracker, const DescribedTracks& described) {
    std::map<Descriptor, Eigen::Vector2f> out;
    for (const Track& t : tracker.live()) {
      const auto at = std::ranges::find(described.tracks, t.id) - described.tracks.begin();
      if (at == std::ssize(described.tracks)) continue;
      const auto begin = described.descriptors.begin() + at * static_cast<std::ptrdiff_t>(kDescriptorBytes);
      out[Descriptor(begin, begin + kDescriptorBytes)] = t.raw_px;
    }
    return out;
  };
  at_once->step(image(0));
  late->step(image(0));
  const auto start = late->describe_strongest(100)();
  const auto first = places(*at_once, at_once->describe_strongest(100)()(100));
  late->step(image(1));
  late->step(image(2));
  const auto now = places(*late, start(100));
  int right = 0;
  for (const auto& [descriptor, px] : now) {
    const auto before = first.find(descriptor);
    if (before == first.end()) continue;  // at a corner's track instead
    const Eigen::Vector2d moved = (px - before->second).cast<double>();
    right += (moved + 2 * Eigen::Vector2d(kStepX, kStepY)).norm() < 0.5 ? 1 : 0;
  }
  EXPECT_GT(right, 0.8 * static_cast<double>(first.size())) << "of " << first.size() << ", " << now.size() << " now";
}

// A camera that looks at a plane, whose picture gets dim, noisy and soft.
class KltFeatureTrackerInTheDark : public testing::Test {
 protected:
  Image image(int frame, bool dark) const {
    test::View view = test::View::at({400 + 1.3 * frame, 300 + 0.7 * frame}, 0, 1, size_);
    view.gain = dark ? 0.5 : 1;
    view.noise = dark ? 6 : 0.5;
    cv::Mat grey = test::render(texture_, view, size_, static_cast<std::uint64_t>(frame + 1));
    if (dark) cv::GaussianBlur(grey, grey, {}, 1.2);
    return {FrameId(static_cast<std::uint32_t>(frame)), frame * TimeNs{33'000'000}, grey};
  }
  const cv::Size size_{752, 480};  // whose smaller size has no whole number of rows
  static constexpr double kSmaller = 480.0 / 752;
  const cv::Mat texture_ = test::plane_texture(1200, 800, 4);
  const std::unique_ptr<FeatureTracker> tracker_ = klt_feature_tracker(camera_of(size_), {}, kNoTags, cpu_matcher({}));
};

TEST_F(KltFeatureTrackerInTheDark, ImagesAreTrackedSmallerAndTheirTracksGoOn) {
  for (int i = 0; i < 4; ++i) tracker_->step(image(i, true));
  EXPECT_EQ(tracker_->working_scale(), 1);
  std::map<TrackId, Eigen::Vector2f> before;
  for (int i = 4; i < 6; ++i) {
    for (const Track& t : tracker_->step(image(i, true))) before[t.id] = t.raw_px;
  }
  ASSERT_EQ(tracker_->working_scale(), kSmaller);
  for (int i = 6; i < 12; ++i) tracker_->step(image(i, true));
  std::vector<double> errors_px;
  for (const Track& t : tracker_->live()) {
    if (!before.contains(t.id)) continue;
    errors_px.push_back((t.raw_px - before[t.id] + 6 * Eigen::Vector2f(1.3F, 0.7F)).norm());
  }
  ASSERT_GT(errors_px.size(), before.size() / 2);
  std::ranges::nth_element(errors_px, errors_px.begin() + std::ssize(errors_px) / 2);
  EXPECT_LT(errors_px[errors_px.size() / 2], 0.3);
}

TEST_F(KltFeatureTrackerInTheDark, AndAtTheirSizeAgainInTheLight) {
  for (int i = 0; i < 8; ++i) tracker_->step(image(i, true));
  ASSERT_EQ(tracker_->working_scale(), kSmaller);
  for (int i = 8; i < 140; ++i) tracker_->step(image(i, false));
  EXPECT_EQ(tracker_->working_scale(), 1);
  EXPECT_GT(tracker_->live().size(), 200U);
}

TEST_F(KltFeatureTrackerInTheDark, FeaturesOfAnEarlierImageAreFoundAtTheNewSize) {
  for (int i = 0; i < 5; ++i) tracker_->step(image(i, true));
  const auto late = tracker_->describe_strongest(100)();
  tracker_->step(image(5, true));
  ASSERT_EQ(tracker_->working_scale(), kSmaller);
  const DescribedTracks described = late(100);
  EXPECT_GT(described.tracks.size(), 20U);
  for (const Track& t : tracker_->live()) {
    EXPECT_LT(t.raw_px.x(), size_.width);
    EXPECT_LT(t.raw_px.y(), size_.height);
  }
}

TEST_F(KltFeatureTrackerInTheDark, FeaturesOfASmallerImageAreFoundInTheFullOne) {
  int i = 0;
  while (i < 8) tracker_->step(image(i++, true));
  ASSERT_EQ(tracker_->working_scale(), kSmaller);
  std::function<FeatureTracker::StartTracks()> describe;
  while (tracker_->working_scale() != 1) {
    ASSERT_LT(i, 200);
    describe = tracker_->describe_strongest(100);
    tracker_->step(image(i++, false));
  }
  EXPECT_GT(describe()(100).tracks.size(), 20U);
}

}  // namespace
}  // namespace coslam::klt_feature_tracker_test
