// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Tracks on a plane under known motion: how exact they are, and how many survive.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>

#include "agent/track/tracker.h"
#include "tests/support/synthetic_view.h"

namespace coslam::tracker_motion_test {
namespace {

const cv::Size kImage(640, 480);

struct Outcome {
  double median_px_per_image = 0;  // error of the motion between two images
  double median_px = 0;            // error against where the track was found, all ages above 0
  double worst_px = 0;             // the same, 99 of 100 are below
  double survival = 0;             // of tracks still in view, from image to image
};

double percentile(std::vector<double>& values, double p) {
  if (values.empty()) return 0;
  const auto k = static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

bool well_inside(const Eigen::Vector2d& px) {
  return px.minCoeff() > 20 && px.x() < kImage.width - 21 && px.y() < kImage.height - 21;
}

Outcome run(const std::function<test::View(int)>& view_at, int images, bool outlines = false) {
  const cv::Mat texture = test::plane_texture(1400, 1100, 11, outlines);
  Tracker tracker({});
  std::map<TrackId, Eigen::Vector2d> origin;  // on the texture
  std::map<TrackId, Eigen::Vector2d> before;  // on the texture, from the image before
  std::vector<double> step_errors, errors;
  double expected = 0, survived = 0;
  for (int i = 0; i < images; ++i) {
    const test::View view = view_at(i);
    std::map<TrackId, Eigen::Vector2d> now;
    for (const Track& t : tracker.step(test::render(texture, view, kImage, static_cast<std::uint64_t>(i + 1)))) {
      const Eigen::Vector2d px = t.raw_px.cast<double>();
      now[t.id] = view.plane_px(px);
      if (t.age_frames == 0) {
        origin[t.id] = now[t.id];
        continue;
      }
      step_errors.push_back((px - view.image_px(before.at(t.id))).norm());
      errors.push_back((px - view.image_px(origin.at(t.id))).norm());
    }
    for (const auto& [id, place] : before) {
      if (!well_inside(view.image_px(place))) continue;
      ++expected;
      if (now.contains(id)) ++survived;
    }
    before = now;
  }
  return {percentile(step_errors, 0.5), percentile(errors, 0.5), percentile(errors, 0.99), survived / expected};
}

test::View view_of(double x, double y, double angle_rad = 0, double zoom = 1) {
  return test::View::at({700 + x, 550 + y}, angle_rad, zoom, kImage);
}

TEST(TrackerMotion, CleanShift) {
  const Outcome o = run([](int i) { return view_of(3.3 * i, 1.7 * i); }, 30);
  EXPECT_LT(o.median_px_per_image, 0.05);
  EXPECT_LT(o.median_px, 0.08);
  EXPECT_GT(o.survival, 0.995);
}

TEST(TrackerMotion, Rotation) {
  const Outcome o = run([](int i) { return view_of(0, 0, 0.03 * i); }, 50);
  EXPECT_LT(o.median_px_per_image, 0.05);
  EXPECT_LT(o.median_px, 0.1);
  EXPECT_GT(o.survival, 0.99);
}

TEST(TrackerMotion, ScaleInAndOut) {
  const Outcome in = run([](int i) { return view_of(0, 0, 0, std::exp(0.01 * i)); }, 60);
  EXPECT_LT(in.median_px, 0.1);
  EXPECT_GT(in.survival, 0.99);
  const Outcome out = run([](int i) { return view_of(0, 0, 0, std::exp(0.4 - 0.01 * i)); }, 60);
  EXPECT_LT(out.median_px, 0.1);
  EXPECT_GT(out.survival, 0.97);
}

TEST(TrackerMotion, ExposureChanges) {
  const Outcome o = run(
      [](int i) {
        test::View v = view_of(2.2 * i, -1.3 * i);
        v.gain = i % 2 != 0 ? 0.8 : 1.0;
        v.offset = i % 2 != 0 ? 10 : 0;
        return v;
      },
      30);
  EXPECT_LT(o.median_px_per_image, 0.05);
  EXPECT_GT(o.survival, 0.99);
}

TEST(TrackerMotion, LongTracksDoNotDrift) {
  const Outcome o = run(
      [](int i) {
        test::View v = view_of(90 * std::sin(0.06 * i), 60 * std::sin(0.045 * i), 0.25 * std::sin(0.05 * i),
                               std::exp(0.25 * std::sin(0.03 * i)));
        v.gain = 1 - 0.15 * std::sin(0.1 * i);
        v.noise = 3;
        return v;
      },
      200, true);
  EXPECT_LT(o.median_px, 0.2);
  EXPECT_LT(o.worst_px, 1.0);
  EXPECT_GT(o.survival, 0.99);
}

TEST(TrackerMotion, FastTurnThatStartsAndReversesAtOnce) {
  const Outcome o = run(
      [](int i) {
        const int phase = i % 12, way = phase < 6 ? phase : 12 - phase;  // 0 1 ... 6 5 ... 1
        test::View v = view_of(40.0 * way, 20.0 * way);
        v.noise = 2;
        return v;
      },
      48, true);
  EXPECT_GT(o.survival, 0.97);
  EXPECT_LT(o.median_px, 0.2);
}

}  // namespace
}  // namespace coslam::tracker_motion_test
