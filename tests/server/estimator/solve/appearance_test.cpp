// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/appearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/model/track_frame.h"

namespace coslam::appearance_test {
namespace {

using Descriptors = std::vector<std::uint8_t>;

Descriptors random_descriptors(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Descriptors out;
  for (int i = 0; i < n * kDescriptorBytes; ++i)
    out.push_back(static_cast<std::uint8_t>(255 * std::pow(uniform(random), 3)));
  return out;
}

Descriptors noisy(const Descriptors& d, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss(0, sigma);
  Descriptors out;
  for (const std::uint8_t v : d) out.push_back(static_cast<std::uint8_t>(std::clamp(v + gauss(random), 0.0, 255.0)));
  return out;
}

TEST(AppearanceIndex, TheSamePlaceGetsTheVotes) {
  AppearanceIndex index;
  std::vector<Descriptors> places;
  for (unsigned i = 0; i < 40; ++i) {
    places.push_back(random_descriptors(200, i));
    EXPECT_EQ(index.add(places.back()), static_cast<int>(i));
  }
  for (const unsigned place : {0U, 17U, 39U}) {
    // Half of its features are there again, the others are new.
    Descriptors seen = noisy(places[place], 15, 100 + place);
    seen.resize(100 * kDescriptorBytes);
    const Descriptors other = random_descriptors(150, 500 + place);
    seen.insert(seen.end(), other.begin(), other.end());
    const auto votes = index.votes(seen);
    ASSERT_EQ(votes.size(), 40U);
    EXPECT_GT(votes[place], 50);
    for (std::size_t i = 0; i < votes.size(); ++i) {
      if (i == place) continue;
      EXPECT_LT(votes[i], 12);
    }
  }
}

TEST(AppearanceIndex, WhatWasRemovedGetsNoVotesAndNoRoom) {
  AppearanceIndex index;
  for (unsigned i = 0; i < 10; ++i) index.add(random_descriptors(200, i));
  const std::size_t bytes = index.bytes();
  for (unsigned i = 0; i < 5; ++i) index.remove(static_cast<int>(i), random_descriptors(200, i));
  EXPECT_EQ(index.votes(random_descriptors(200, 2))[2], 0);
  EXPECT_GT(index.votes(random_descriptors(200, 7))[7], 150);
  for (unsigned i = 10; i < 15; ++i) EXPECT_EQ(index.add(random_descriptors(200, i)), static_cast<int>(i));
  EXPECT_LT(static_cast<double>(index.bytes()), 1.4 * static_cast<double>(bytes));
  index.skip(3);
  EXPECT_EQ(index.add(random_descriptors(200, 20)), 18);
  EXPECT_GT(index.votes(random_descriptors(200, 20))[18], 150);
}

TEST(AppearanceIndex, EmptyImagesAreHarmless) {
  AppearanceIndex index;
  EXPECT_TRUE(index.votes(random_descriptors(3, 1)).empty());
  index.add({});
  EXPECT_EQ(index.votes(random_descriptors(3, 1)), std::vector<int>{0});
  index.add(random_descriptors(50, 2));
  EXPECT_EQ(index.votes({}), (std::vector<int>{0, 0}));
}

}  // namespace
}  // namespace coslam::appearance_test
