// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/fields.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/core.hpp>

#include "tests/agent/capture/interlaced.h"

namespace coslam::fields_test {
namespace {

using test::interlaced;
using test::place_px;
using test::view;

Fields told_of(const std::function<cv::Mat(int)>& image, int count = 20) {
  FieldOrder order;
  Fields told = Fields::kUnknown;
  for (int i = 0; i < count; ++i) told = order.note(image(i));
  return told;
}

TEST(FieldOrder, IsToldByHowThePictureMoves) {
  for (const Fields order : {Fields::kUpperFirst, Fields::kLowerFirst}) {
    EXPECT_EQ(told_of([&](int i) { return interlaced(i, order); }), order);
    EXPECT_EQ(told_of([&](int i) { return interlaced(i, order); }, 6), order) << "soon";
  }
}

TEST(FieldOrder, OfWholeFramesThereIsNone) {
  EXPECT_EQ(told_of([](int i) { return view(place_px(i), i); }), Fields::kNone);
}

TEST(FieldOrder, OfWhatStandsNothingIsTold) {
  EXPECT_EQ(told_of([](int i) { return view(0, i); }), Fields::kUnknown);
}

// As of a colour sensor whose pattern nobody resolved.
TEST(FieldOrder, RowsThatAreDarkerThanTheirNeighboursAreNoFields) {
  const auto striped = [](int i) {
    cv::Mat image = view(place_px(i), i);
    for (int y = 1; y < image.rows; y += 2) image.row(y) *= 0.5;
    return image;
  };
  const Fields told = told_of(striped);
  EXPECT_TRUE(told == Fields::kUnknown || told == Fields::kNone);
}

TEST(FieldOrder, TheFirstFieldIsLeft) {
  for (const Fields order : {Fields::kUpperFirst, Fields::kLowerFirst}) {
    cv::Mat image = interlaced(2, order);
    keep_first_field(image, order);
    const cv::Mat whole = view(place_px(2), 2);
    EXPECT_LT(cv::norm(image, whole, cv::NORM_L1) / static_cast<double>(image.total()), 2);
    const int row = order == Fields::kUpperFirst ? 10 : 11;
    EXPECT_EQ(cv::norm(image.row(row), whole.row(row), cv::NORM_INF), 0);
  }
}

}  // namespace
}  // namespace coslam::fields_test
