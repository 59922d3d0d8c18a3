// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/sound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/temp_folder.h"
#include "tests/support/video_with_sound.h"
#include "tests/support/world_sound.h"

namespace coslam::sound_test {
namespace {

constexpr int kRate_hz = Sound::kRate_hz;

TEST(BeganLater, IsFoundWhereBothHearTheSame) {
  const auto first = test::heard(kRate_hz, 0, 8, 1);
  for (const double later_s : {0.0, 1.37, -2.5, 6.0}) {
    const auto found_s = began_later_s(first, test::heard(kRate_hz, later_s, 8, 2), kRate_hz);
    ASSERT_TRUE(found_s) << later_s;
    EXPECT_NEAR(*found_s, later_s, 0.001);
  }
}

TEST(BeganLater, IsEmptyForDifferentSounds) {
  EXPECT_FALSE(began_later_s(test::heard(kRate_hz, 0, 8, 1), test::heard(kRate_hz, 100, 8, 2), kRate_hz));
}

TEST(BeganLater, IsEmptyForASoundThatRepeatsItself) {
  const auto beeps = [](double from_s, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, 0.02);
    std::vector<float> out(8 * kRate_hz);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double t_s = from_s + static_cast<double>(i) / kRate_hz;
      const double beep = std::fmod(t_s, 0.5) < 0.1 ? 0.5 * std::sin(2 * M_PI * 1000 * t_s) : 0;
      out[i] = static_cast<float>(beep + noise(random));
    }
    return out;
  };
  EXPECT_FALSE(began_later_s(beeps(0, 1), beeps(0.2, 2), kRate_hz));
}

TEST(BeganLater, IsEmptyForSilenceAndForLessThanASecond) {
  EXPECT_FALSE(began_later_s(std::vector<float>(8 * kRate_hz), std::vector<float>(8 * kRate_hz), kRate_hz));
  EXPECT_FALSE(began_later_s(test::heard(kRate_hz, 0, 8, 1), test::heard(kRate_hz, 0, 0.5, 2), kRate_hz));
  EXPECT_FALSE(began_later_s({}, {}, kRate_hz));
}

TEST(SoundOf, AVideoIsReadAtOneRateWithItsBeginAgainstTheImages) {
  constexpr int kFilm_hz = 44100;
  const test::TempFolder folder;
  test::write_film(folder / "clip.mov", test::heard(kFilm_hz, 0, 3, 1), kFilm_hz, 0.25);
  const auto sound = sound_of(folder / "clip.mov");
  ASSERT_TRUE(sound);
  EXPECT_NEAR(sound->begins_s, 0.25, 0.01);
  EXPECT_NEAR(static_cast<double>(sound->samples.size()) / kRate_hz, 3, 0.05);
  const auto later_s = began_later_s(test::heard(kRate_hz, 0, 3, 2), sound->samples, kRate_hz);
  ASSERT_TRUE(later_s);
  EXPECT_NEAR(*later_s, 0, 0.003);
}

TEST(SoundOf, AVideoWithoutAndWhatIsNoneIsEmpty) {
  const test::TempFolder folder;
  test::write_film(folder / "clip.mov", {}, kRate_hz);
  EXPECT_FALSE(sound_of(folder / "clip.mov"));
  EXPECT_FALSE(sound_of(folder.write("text.mov", "no video")));
  EXPECT_FALSE(sound_of(folder / "nowhere.mov"));
}

}  // namespace
}  // namespace coslam::sound_test
