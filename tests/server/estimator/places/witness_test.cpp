// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/witness.h"

#include <gtest/gtest.h>

#include <functional>

#include "common/geometry/rigid3.h"

namespace coslam::witness_test {
namespace {

const Witness kWitness{.set = SetId(90),
                       .camera = CameraId(0),
                       .place_image = {SetId(12), CameraId(1)},
                       .into = MapId(1),
                       .into_from_own = {1.1, so3_exp({0.1, 0.8, -0.2}), {5, -2, 1}},
                       .depth = 4,
                       .center = {1, 0, 2}};

bool agrees_when(const std::function<void(Witness&)>& changed) {
  Witness other = kWitness;
  changed(other);
  return agree(kWitness, other);
}

TEST(Witness, AnImageDoesNotConfirmItself) {
  EXPECT_FALSE(agrees_when([](Witness&) {}));
}

TEST(Witness, TheSameCameraConfirmsItLater) {
  EXPECT_TRUE(agrees_when([](Witness& w) { w.set = SetId(91); }));
}

TEST(Witness, AnotherCameraConfirmsItAtOnce) {
  EXPECT_TRUE(agrees_when([](Witness& w) { w.camera = CameraId(1); }));
}

TEST(Witness, TwoImagesThatRecogniseEachOtherAreOneEvidence) {
  const auto of_the_other = [](Witness& w) {
    w.set = kWitness.place_image.first;
    w.camera = kWitness.place_image.second;
    w.place_image = {kWitness.set, kWitness.camera};
  };
  EXPECT_FALSE(agrees_when(of_the_other));
  EXPECT_TRUE(agrees_when([&](Witness& w) {
    of_the_other(w);
    w.place_image.first = SetId(92);
  })) << "it recognises another one";
}

TEST(Witness, NotWhenItSaysSomethingElse) {
  const auto later_and = [](const std::function<void(Witness&)>& changed) {
    return agrees_when([&](Witness& w) {
      w.set = SetId(91);
      changed(w);
    });
  };
  EXPECT_FALSE(later_and([](Witness& w) { w.into = MapId(2); }));
  EXPECT_FALSE(later_and([](Witness& w) { w.into_from_own.scale *= 1.2; }));
  EXPECT_FALSE(later_and([](Witness& w) { w.into_from_own.translation.x() += 1; }));
  EXPECT_FALSE(later_and([](Witness& w) {
    w.into_from_own.rotation = so3_exp({0, 0, 0.06}) * w.into_from_own.rotation;
  }));
}

}  // namespace
}  // namespace coslam::witness_test
