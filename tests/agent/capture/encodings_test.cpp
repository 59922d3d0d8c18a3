// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/encodings.h"

#include <gmock/gmock.h>

#include <numeric>
#include <vector>

namespace coslam::encodings_test {
namespace {

// 4 x 2 pixels of this encoding, in rows of so many octets, which count up.
struct Counting {
  Counting(std::string_view encoding, std::size_t row, std::size_t padding = 0, bool big_endian = false,
           std::size_t more = 0)
      : octets(2 * (row + padding) + more) {
    std::iota(octets.begin(), octets.end(), std::uint8_t{10});
    image = {4, 2, encoding, big_endian, row + padding, octets};
  }
  std::vector<std::uint8_t> octets;
  RawImage image;
};

std::vector<int> values(const cv::Mat& grey) {
  std::vector<int> out;
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      out.push_back(grey.depth() == CV_16U ? grey.at<std::uint16_t>(y, x) : grey.at<std::uint8_t>(y, x));
    }
  }
  return out;
}

using ::testing::ElementsAre;

TEST(Encodings, GreyIsTakenAsItIs) {
  for (const char* encoding : {"mono8", "8UC1", "nv12", "nv21", "nv24", "i420", "yv12"}) {
    EXPECT_THAT(values(grey_of(Counting(encoding, 4, 0, false, 8).image)), ElementsAre(10, 11, 12, 13, 14, 15, 16, 17))
        << encoding;
  }
}

TEST(Encodings, PaddingIsPassedOver) {
  EXPECT_THAT(values(grey_of(Counting("mono8", 4, 3).image)), ElementsAre(10, 11, 12, 13, 17, 18, 19, 20));
}

TEST(Encodings, OfPackedYuvTheLuma) {
  for (const char* encoding : {"yuyv", "yuv422_yuy2"}) {
    EXPECT_THAT(values(grey_of(Counting(encoding, 8).image)), ElementsAre(10, 12, 14, 16, 18, 20, 22, 24)) << encoding;
  }
  for (const char* encoding : {"uyvy", "yuv422"}) {
    EXPECT_THAT(values(grey_of(Counting(encoding, 8).image)), ElementsAre(11, 13, 15, 17, 19, 21, 23, 25)) << encoding;
  }
}

TEST(Encodings, SixteenBitsOfBothOrders) {
  for (const char* encoding : {"mono16", "16UC1"}) {
    const cv::Mat little = grey_of(Counting(encoding, 8, 1).image), big = grey_of(Counting(encoding, 8, 1, true).image);
    ASSERT_EQ(little.type(), CV_16UC1);
    EXPECT_EQ(values(little)[1], 13 * 256 + 12);
    EXPECT_EQ(values(big)[1], 12 * 256 + 13);
    EXPECT_EQ(values(big)[4], 19 * 256 + 20) << "behind one octet of padding";
  }
}

TEST(Encodings, ColoursByTheWeightsOfLuma) {
  // Red alone.
  const auto red = [](std::string_view encoding, std::size_t channels, std::size_t at, int bits) {
    const std::size_t octets_per_value = static_cast<std::size_t>(bits) / 8;
    std::vector<std::uint8_t> octets(8 * channels * octets_per_value, 0);
    for (std::size_t i = 0; i < 8; ++i) octets[(i * channels + at) * octets_per_value + octets_per_value - 1] = 200;
    return values(grey_of({4, 2, encoding, false, 4 * channels * octets_per_value, octets}))[5];
  };
  EXPECT_EQ(red("rgb8", 3, 0, 8), 60);
  EXPECT_EQ(red("bgr8", 3, 2, 8), 60);
  EXPECT_EQ(red("8UC3", 3, 2, 8), 60);
  EXPECT_EQ(red("rgba8", 4, 0, 8), 60);
  EXPECT_EQ(red("bgra8", 4, 2, 8), 60);
  EXPECT_EQ(red("8UC4", 4, 2, 8), 60);
  EXPECT_NEAR(red("rgb16", 3, 0, 16), 0.299 * 200 * 256, 2);
  EXPECT_NEAR(red("bgr16", 3, 2, 16), 0.299 * 200 * 256, 2);
  EXPECT_NEAR(red("rgba16", 4, 0, 16), 0.299 * 200 * 256, 2);
  EXPECT_NEAR(red("bgra16", 4, 2, 16), 0.299 * 200 * 256, 2);
}

// An even colour through a pattern has everywhere the grey that the colour has.
TEST(Encodings, BayerPatternsGiveTheColoursGrey) {
  constexpr int kRed = 200, kGreen = 100, kBlue = 40, kGrey = 123;  // 0.299, 0.587, 0.114
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    for (const int bits : {8, 16}) {
      constexpr std::size_t kSide = 8;
      std::vector<std::uint8_t> octets;
      for (std::size_t y = 0; y < kSide; ++y) {
        for (std::size_t x = 0; x < kSide; ++x) {
          const char color = pattern[2 * (y % 2) + x % 2];
          if (bits == 16) octets.push_back(0);
          octets.push_back(color == 'r' ? kRed : color == 'g' ? kGreen : kBlue);
        }
      }
      const std::string encoding = "bayer_" + pattern + std::to_string(bits);
      const cv::Mat grey = grey_of({kSide, kSide, encoding, false, kSide * octets.size() / (kSide * kSide), octets});
      ASSERT_FALSE(grey.empty()) << encoding;
      for (const int value : values(grey)) EXPECT_NEAR(value / (bits == 16 ? 256.0 : 1.0), kGrey, 1.5) << encoding;
    }
  }
}

TEST(Encodings, WhatIsTooShortOrUnknownIsNone) {
  Counting whole("mono8", 4);
  RawImage image = whole.image;
  image.octets = std::span(whole.octets).first(7);
  EXPECT_TRUE(grey_of(image).empty()) << "an octet is missing";
  EXPECT_EQ(why_not_grey(image), "it has 7 octets, and 2 rows of 4 are needed");
  image = whole.image;
  image.octets_per_row = 3;
  EXPECT_TRUE(grey_of(image).empty()) << "rows shorter than the image is wide";
  EXPECT_EQ(why_not_grey(image), "its rows have 3 octets (step), and 4 pixels of mono8 need 4");
  image = whole.image;
  image.octets_per_row = std::size_t{1} << 63U;
  EXPECT_TRUE(grey_of(image).empty());
  image = whole.image;
  image.width_px = 0;
  EXPECT_TRUE(grey_of(image).empty());
  image = whole.image;
  image.encoding = "32FC1";
  EXPECT_TRUE(grey_of(image).empty());
  EXPECT_THAT(why_not_grey(image), ::testing::StartsWith("its encoding is 32FC1, as of depth or heat: record"));
  image.encoding = "rgb7";
  EXPECT_THAT(why_not_grey(image), ::testing::StartsWith("its encoding is rgb7, known are mono8, 8UC1"));
  EXPECT_FALSE(is_known_encoding("32FC1"));
  EXPECT_TRUE(is_known_encoding("uyvy"));
  EXPECT_THAT(known_encodings(), ::testing::HasSubstr("mono8, 8UC1"));
}

// Twelve bits of a ramp that bends, as a smooth picture has them.
std::vector<std::uint8_t> octets_of_ramp(std::size_t width_px, std::size_t height_px, bool big_endian, int shift) {
  std::vector<std::uint8_t> octets;
  for (std::size_t y = 0; y < height_px; ++y) {
    for (std::size_t x = 0; x < width_px; ++x) {
      const auto value = static_cast<unsigned>(900 + 37 * x + 5 * y + (x * x) % 7) << static_cast<unsigned>(shift);
      octets.push_back(static_cast<std::uint8_t>(big_endian ? value >> 8U : value));
      octets.push_back(static_cast<std::uint8_t>(big_endian ? value : value >> 8U));
    }
  }
  return octets;
}

TEST(Encodings, OctetsThatLieTheOtherWayRoundAreTold) {
  for (const bool lies_big : {false, true}) {
    for (const bool says_big : {false, true}) {
      const auto octets = octets_of_ramp(80, 60, lies_big, 0);
      OctetOrder order;
      const RawImage image{80, 60, "mono16", says_big, 160, octets};
      EXPECT_EQ(order.is_wrong_in(image), lies_big != says_big);
      EXPECT_EQ(order.is_wrong(), lies_big != says_big);
    }
  }
}

TEST(Encodings, WhereBothOrdersAreAsGoodTheOneThatIsSaidCounts) {
  std::vector<std::uint8_t> octets;
  for (int i = 0; i < 80 * 60; ++i) octets.insert(octets.end(), {0, static_cast<std::uint8_t>(3 * (i % 80))});
  for (const bool says_big : {false, true}) {
    OctetOrder order;
    EXPECT_FALSE(order.is_wrong_in({80, 60, "16UC1", says_big, 160, octets}));
    EXPECT_FALSE(order.is_wrong_in({80, 60, "mono8", says_big, 80, octets})) << "which has none";
  }
}

}  // namespace
}  // namespace coslam::encodings_test
