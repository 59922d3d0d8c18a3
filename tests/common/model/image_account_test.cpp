// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/model/image_account.h"

#include <gtest/gtest.h>

#include <set>

namespace coslam::image_account_test {
namespace {

TEST(ImageAccount, EachFateHasAnotherName) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kImageFates; ++i) names.insert(words_of(static_cast<ImageFate>(i)).name);
  EXPECT_EQ(names.size(), kImageFates);
}

TEST(ImageAccount, AddsUp) {
  ImageAccount images;
  EXPECT_EQ(images.percent(ImageFate::kTracked), 0) << "of none";
  for (std::size_t i = 0; i < kImageFates; ++i) images.images[i] = i + 1;
  EXPECT_EQ(images.captured(), 45U);
  images += images;
  EXPECT_EQ(images.captured(), 90U);
  EXPECT_DOUBLE_EQ(images.percent(ImageFate::kWithoutPose), 100.0 * 6 / 90);
}

TEST(ImageAccount, SaysWhatIsNotTracked) {
  ImageAccount images;
  images[ImageFate::kTracked] = 278;
  EXPECT_EQ(images.losses(), "");
  images[ImageFate::kNotSent] = 19;
  images[ImageFate::kLost] = 3;
  EXPECT_EQ(losses_of("cam0", images), "cam0: of 300 images 19 not sent in time, 3 lost on the way");
}

}  // namespace
}  // namespace coslam::image_account_test
