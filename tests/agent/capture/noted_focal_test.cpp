// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/noted_focal.h"

#include <gtest/gtest.h>
#include <libexif/exif-data.h>
#include <libexif/exif-mem.h>

#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "tests/support/temp_folder.h"
#include "tests/support/video_with_sound.h"

namespace coslam::noted_focal_test {
namespace {

constexpr int kWidth = 640, kHeight = 480;

class NotedFocal : public testing::Test {
 public:
  NotedFocal() : exif_(exif_data_new()), memory_(exif_mem_new_default()) {
    exif_data_set_byte_order(exif_, EXIF_BYTE_ORDER_INTEL);
  }
  ~NotedFocal() override {
    exif_data_unref(exif_);
    exif_mem_unref(memory_);
  }
  NotedFocal(const NotedFocal&) = delete;
  NotedFocal& operator=(const NotedFocal&) = delete;

 protected:
  ExifEntry* entry(ExifTag tag, ExifFormat format, unsigned size) {
    ExifEntry* e = exif_entry_new();
    exif_content_add_entry(exif_->ifd[EXIF_IFD_EXIF], e);
    e->tag = tag;
    e->format = format;
    e->components = 1;
    e->size = size;
    e->data = static_cast<unsigned char*>(exif_mem_alloc(memory_, size));
    exif_entry_unref(e);
    return e;
  }
  void note(ExifTag tag, ExifShort value) {
    exif_set_short(entry(tag, EXIF_FORMAT_SHORT, 2)->data, EXIF_BYTE_ORDER_INTEL, value);
  }
  void note(ExifTag tag, ExifRational value) {
    exif_set_rational(entry(tag, EXIF_FORMAT_RATIONAL, 8)->data, EXIF_BYTE_ORDER_INTEL, value);
  }
  // A JPEG file with these notes behind its first two octets.
  std::string photo() {
    const std::string plain = (folder_ / "plain.jpg").string(), noted = (folder_ / "noted.jpg").string();
    cv::imwrite(plain, cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(80)));
    std::ifstream in(plain, std::ios::binary);
    const std::string jpeg(std::istreambuf_iterator<char>(in), {});
    unsigned char* data = nullptr;
    unsigned size = 0;
    exif_data_save_data(exif_, &data, &size);
    const unsigned length = size + 2;
    std::ofstream out(noted, std::ios::binary);
    out << jpeg.substr(0, 2) << '\xff' << '\xe1' << static_cast<char>(length >> 8U)
        << static_cast<char>(length & 0xffU);
    out.write(reinterpret_cast<const char*>(data), size);
    out << jpeg.substr(2);
    exif_mem_free(memory_, data);
    return noted;
  }
  std::string film(const std::string& key, const std::string& value) {
    const std::string mute = (folder_ / "mute.mp4").string(), noted = (folder_ / "noted.mov").string();
    {
      cv::VideoWriter writer(mute, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 20, {64, 48});
      for (int i = 0; i < 5; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(20 * i)));
    }
    test::add_sound(mute, noted, {}, 8000, 0, {{key, value}});
    return noted;
  }

  test::TempFolder folder_;
  ExifData* exif_;
  ExifMem* memory_;
};

TEST_F(NotedFocal, OfAPhotoIsThatOnFilm) {
  note(EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM, ExifShort{26});
  const auto focal_px = noted_focal_px(photo(), kWidth, kHeight);
  ASSERT_TRUE(focal_px);
  EXPECT_NEAR(*focal_px, 26 / 43.27 * 800, 0.1);
}

TEST_F(NotedFocal, OfAPhotoIsElseByThePixelsOfTheSensor) {
  note(EXIF_TAG_FOCAL_LENGTH, ExifRational{8, 2});
  note(EXIF_TAG_FOCAL_PLANE_X_RESOLUTION, ExifRational{2500, 1});
  note(EXIF_TAG_FOCAL_PLANE_RESOLUTION_UNIT, ExifShort{3});
  note(EXIF_TAG_PIXEL_X_DIMENSION, ExifShort{1280});
  const auto focal_px = noted_focal_px(photo(), kWidth, kHeight);
  ASSERT_TRUE(focal_px);
  EXPECT_NEAR(*focal_px, 4 * 250 * 0.5, 0.1) << "the image is half as wide as it was taken";
}

TEST_F(NotedFocal, OfAVideoIsWhatPhonesWriteInIt) {
  const auto focal_px =
      noted_focal_px(film("com.apple.quicktime.camera.focal_length.35mm_equivalent", "24"), 1920, 1080);
  ASSERT_TRUE(focal_px);
  EXPECT_NEAR(*focal_px, 24 / 43.27 * 2202.9, 1);
}

TEST_F(NotedFocal, IsEmptyWhereNothingIsNotedOrNothingThatCanBe) {
  EXPECT_FALSE(noted_focal_px(photo(), kWidth, kHeight));
  EXPECT_FALSE(noted_focal_px(film("title", "24"), kWidth, kHeight));
  EXPECT_FALSE(noted_focal_px(film("x.focal_length.35mm_equivalent", "wide"), kWidth, kHeight));
  EXPECT_FALSE(noted_focal_px(film("x.focal_length.35mm_equivalent", "4000"), kWidth, kHeight));
  EXPECT_FALSE(noted_focal_px(folder_ / "nowhere.jpg", kWidth, kHeight));
  EXPECT_FALSE(noted_focal_px({}, kWidth, kHeight));
}

}  // namespace
}  // namespace coslam::noted_focal_test
