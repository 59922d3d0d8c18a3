// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What a tracker promises of its tracks whatever the motion.
#include "agent/track/tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "tests/support/synthetic_view.h"

namespace coslam::tracker_test {
namespace {

const cv::Size kImage(640, 480);

cv::Mat image_at(const cv::Mat& texture, double x, double y, std::uint64_t noise_seed = 1) {
  test::View view = test::View::at({500 + x, 400 + y}, 0, 1, kImage);
  view.noise = 2;
  return test::render(texture, view, kImage, noise_seed);
}

TEST(Tracker, IdsAscendAndAreNeverUsedAgain) {
  const cv::Mat texture = test::plane_texture(1000, 800, 1);
  Tracker tracker({});
  std::set<TrackId> ended;
  std::set<TrackId> before;
  for (int i = 0; i < 25; ++i) {
    if (i == 15) tracker.reset();
    const auto& tracks = tracker.step(image_at(texture, 12.0 * (i % 9), 7.0 * (i % 5)));
    EXPECT_LE(tracks.size(), 300U);
    EXPECT_GE(tracks.size(), 200U);
    std::set<TrackId> now;
    TrackId last;
    for (const Track& t : tracks) {
      EXPECT_GT(t.id, last);
      last = t.id;
      now.insert(t.id);
      EXPECT_FALSE(ended.contains(t.id));
      EXPECT_EQ(t.age_frames > 0, before.contains(t.id));
      EXPECT_TRUE(i != 15 || t.age_frames == 0);
    }
    for (const TrackId& id : before) {
      if (!now.contains(id)) ended.insert(id);
    }
    before = now;
  }
  EXPECT_FALSE(ended.empty());
}

TEST(Tracker, ALeapThatWindowsCannotFollowIsFollowedByLooks) {
  const cv::Mat texture = test::plane_texture(1400, 1000, 4);
  Tracker tracker({});
  std::map<TrackId, Eigen::Vector2f> before;
  const Eigen::Vector2f leap(-240, 150);
  std::size_t stay = 0, found = 0;
  for (const Track& t : tracker.step(image_at(texture, 0, 0, 1))) {
    before[t.id] = t.raw_px;
    const Eigen::Vector2f to = t.raw_px + leap;
    stay += to.x() > 15 && to.y() > 15 && to.x() < 625 && to.y() < 465;
  }
  for (const Track& t : tracker.step(image_at(texture, 240, -150, 2))) {
    if (t.age_frames == 0) continue;
    ++found;
    EXPECT_LT((t.raw_px - before.at(t.id) - leap).norm(), 0.5f);
  }
  ASSERT_GT(stay, 80U);
  EXPECT_GT(found, stay * 7 / 10);
}

TEST(Tracker, WhatIsNewInTheViewGetsItsShareBesideTracksThatWereAdded) {
  const cv::Mat texture = test::plane_texture(1400, 1000, 4);
  Tracker tracker({});
  tracker.step(image_at(texture, 0, 0, 1));
  std::vector<Eigen::Vector2f> places;
  for (float y = 20; y < 460; y += 20) {
    for (float x = 20; x < 620; x += 20) places.emplace_back(x, y);
  }
  tracker.add(places, 5);
  ASSERT_GT(tracker.live().size(), 450U);
  int begun = 0;
  for (const Track& t : tracker.step(image_at(texture, 260, 0, 2))) begun += t.age_frames == 0;
  EXPECT_GT(begun, 50) << "more were left than are kept usually";
}

TEST(Tracker, TracksThatLeaveTheImageEnd) {
  const cv::Mat texture = test::plane_texture(1000, 800, 2);
  Tracker tracker({});
  std::map<TrackId, float> first_x;
  for (int i = 0; i < 30; ++i) {
    for (const Track& t : tracker.step(image_at(texture, 8.0 * i, 0))) {
      EXPECT_GE(t.raw_px.x(), 7.5);
      EXPECT_LE(t.raw_px.x(), 639 - 7.5);
      if (i == 0) first_x[t.id] = t.raw_px.x();
      const auto first = first_x.find(t.id);
      EXPECT_TRUE(first == first_x.end() || first->second - 8.0F * static_cast<float>(i) > 5)
          << "out of view, yet alive";
    }
  }
}

TEST(Tracker, AnOccluderEndsTracksRatherThanDragsThem) {
  const cv::Mat background = test::plane_texture(1000, 800, 3);
  const cv::Mat block = test::plane_texture(80, 150, 4);
  Tracker tracker({});
  std::map<TrackId, Eigen::Vector2f> first;  // the background stands still
  int slid = 0;
  int still = 0;
  for (int i = 0; i < 60; ++i) {
    cv::Mat image = image_at(background, 0, 0, static_cast<std::uint64_t>(i + 1));
    if (i >= 5) block.copyTo(image(cv::Rect((i - 5) * 8, 90, 160, 300)));
    const auto& tracks = tracker.step(image);
    if (i == 0) {
      for (const Track& t : tracks) first[t.id] = t.raw_px;
      continue;
    }
    if (i < 59) continue;
    for (const Track& t : tracks) {
      if (!first.contains(t.id)) continue;
      ((t.raw_px - first[t.id]).norm() > 1.5F ? slid : still) += 1;
    }
  }
  EXPECT_LE(slid, 1);
  EXPECT_GT(still, 60);  // of about 300, half of which the block swept over
}

// A block passes in front of a floor of planks, which look alike all along: a window beside its outline holds to that.
TEST(Tracker, AnOutlineIsNotFollowed) {
  const cv::Mat room = test::plane_texture(1000, 800, 4);
  cv::Mat planks(1600, 2000, CV_8U);
  cv::RNG rng(5);
  for (int y = 0; y < planks.rows; y += 20) planks.rowRange(y, y + 20).setTo(rng.uniform(100, 160));
  cv::GaussianBlur(planks, planks, cv::Size(), 3);
  const cv::Mat block = test::plane_texture(60, 100, 6);
  Tracker tracker({});
  std::vector<TrackId> beside, inside;
  const auto followed = [&](const std::vector<TrackId>& ids) {
    return std::count_if(tracker.live().begin(), tracker.live().end(), [&](const Track& t) {
      return t.age_frames == 20 && std::find(ids.begin(), ids.end(), t.id) != ids.end();
    });
  };
  for (int i = 0; i <= 30; ++i) {
    cv::Mat image = image_at(room, 0, 0, static_cast<std::uint64_t>(i + 1));
    const cv::Mat floor = image_at(planks, 0, 0, static_cast<std::uint64_t>(i + 1));
    floor.rowRange(80, 400).copyTo(image.rowRange(80, 400));
    const cv::Rect at(100 + 4 * i, 140, 120, 200);
    block.copyTo(image(at));
    tracker.step(image);
    if (i != 10) continue;
    std::vector<Eigen::Vector2f> beside_px, inside_px;
    for (int y = 160; y < 320; y += 16) {
      beside_px.emplace_back(at.x + at.width + 5, y);
      inside_px.emplace_back(at.x + at.width - 40, y);
    }
    beside = tracker.add(beside_px, 0);
    inside = tracker.add(inside_px, 0);
  }
  EXPECT_LE(followed(beside), 2);
  EXPECT_GE(followed(inside), 7);  // of 10
}

TEST(Tracker, CoversEveryPartThatHasTexture) {
  const cv::Mat texture = test::plane_texture(1000, 800, 5);
  Tracker tracker({});
  std::vector<Track> tracks;
  for (int i = 0; i < 12; ++i) tracks = tracker.step(image_at(texture, 9.0 * i, 4.0 * i));
  std::array<int, 48> counts{};
  for (const Track& t : tracks)
    ++counts.at(static_cast<std::size_t>(t.raw_px.y()) / 80 * 8 + static_cast<std::size_t>(t.raw_px.x()) / 80);
  for (const int count : counts) EXPECT_GE(count, 1);
}

TEST(Tracker, SameImagesSameBits) {
  const cv::Mat texture = test::plane_texture(1000, 800, 6);
  Tracker one({});
  Tracker two({});
  for (int i = 0; i < 10; ++i) {
    const cv::Mat image = image_at(texture, 5.0 * i, 3.0 * i, static_cast<std::uint64_t>(i + 1));
    const auto& a = one.step(image);
    const auto& b = two.step(image);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].id, b[k].id);
      EXPECT_EQ(a[k].raw_px, b[k].raw_px);
    }
  }
}

TEST(Tracker, AddedPlacesAreFollowed) {
  const cv::Mat texture = test::plane_texture(1000, 800, 7);
  Tracker tracker({});
  const Track known = tracker.step(image_at(texture, 0, 0)).front();
  const std::vector<TrackId> ids = tracker.add({known.raw_px + Eigen::Vector2f(1, 1), {303.3F, 207.7F}}, 2.5F);
  ASSERT_EQ(ids.size(), 2U);
  EXPECT_EQ(ids[0], known.id);
  const auto follow = tracker.step(image_at(texture, 4, 2));
  for (const TrackId& id : ids) {
    const auto t = std::find_if(follow.begin(), follow.end(), [&](const Track& x) { return x.id == id; });
    ASSERT_NE(t, follow.end());
    EXPECT_EQ(t->age_frames, 1U);
  }
}

TEST(Tracker, BearsImagesWithoutTexture) {
  Tracker tracker({});
  const cv::Mat texture = test::plane_texture(1000, 800, 8);
  EXPECT_FALSE(tracker.step(image_at(texture, 0, 0)).empty());
  EXPECT_TRUE(tracker.step(cv::Mat(kImage, CV_8U, cv::Scalar(0))).empty());
  EXPECT_TRUE(tracker.step(cv::Mat(kImage, CV_8U, cv::Scalar(255))).empty());
  EXPECT_FALSE(tracker.step(image_at(texture, 0, 0)).empty());
}

TEST(Tracker, SmallImagesWork) {
  const cv::Mat texture = test::plane_texture(300, 200, 9);
  for (const cv::Size& size : {cv::Size(64, 48), cv::Size(33, 35)}) {
    Tracker tracker({});
    for (int i = 0; i < 4; ++i) {
      const test::View view = test::View::at({150.0 + i, 100}, 0, 1, size);
      tracker.step(test::render(texture, view, size));
    }
  }
}

TEST(Tracker, GoesOnInImagesOfAnotherSize) {
  const cv::Mat texture = test::plane_texture(1000, 800, 1);
  const cv::Size small(320, 240);
  const auto small_at = [&](double x) {
    return test::render(texture, test::View::at({500 + x, 400}, 0, 0.5, small), small, 1);
  };
  Tracker tracker({});
  for (int i = 0; i < 5; ++i) tracker.step(image_at(texture, 4.0 * i, 0));
  const std::vector<Track> before = tracker.live();
  tracker.resize(small_at(16), 0.5);
  ASSERT_EQ(tracker.live().size(), before.size());
  for (int i = 5; i < 8; ++i) tracker.step(small_at(4.0 * i));
  int kept = 0, right = 0;
  for (const Track& t : tracker.live()) {
    const auto was = std::ranges::find(before, t.id, &Track::id);
    if (was == before.end()) continue;
    ++kept;
    EXPECT_EQ(t.age_frames, was->age_frames + 3);
    const Eigen::Vector2f expected = 0.5F * (was->raw_px.array() + 0.5F) - 0.5F - Eigen::Array2f(6, 0);
    right += (t.raw_px - expected).norm() < 0.3F ? 1 : 0;
  }
  EXPECT_GT(kept, static_cast<int>(before.size()) * 3 / 4);
  EXPECT_GT(right, kept * 9 / 10);
  tracker.resize(image_at(texture, 28, 0), 2);
  tracker.step(image_at(texture, 32, 0));
  EXPECT_GT(tracker.live().size(), 200U);
}

}  // namespace
}  // namespace coslam::tracker_test
