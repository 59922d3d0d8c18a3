// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/lens_forms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string_view>

namespace coslam::lens_forms_test {
namespace {

CameraModel with(DistortionModel model, const LensTerms& coefficients = {}) {
  return {752, 480, 458, 457, 367, 248, model, coefficients};
}

TEST(LensForms, EachNameIsThatOfOneLensModel) {
  std::set<std::string_view> names;
  for (const DistortionModel model : kDistortionModels) {
    for (const std::string_view name : lens_traits(model).names) {
      EXPECT_TRUE(names.insert(name).second) << name;
      EXPECT_EQ(lens_named(name), model) << name;
    }
  }
  EXPECT_FALSE(lens_named("thin_prism"));
}

TEST(LensForms, AreFoundByTheNamesThatFilesHave) {
  for (const DistortionModel model : kDistortionModels) {
    for (const LensForm& form : lens_traits(model).forms) {
      // What a pinhole in Kalibr's files is, its distortion model says.
      const auto found = lens_named(form.file, form.name);
      ASSERT_TRUE(found) << form.name;
      const bool by_distortion = form.file == LensFile::kKalibr && form.before == 0;
      EXPECT_TRUE(by_distortion || found->model == model) << form.name;
    }
  }
  EXPECT_FALSE(lens_named(LensFile::kColmap, "pinhole-radtan8")) << "the name of another program";
  EXPECT_EQ(lens_named(LensFile::kColmap, "RADIAL")->form.terms, 2U);
  EXPECT_THAT(lens_names(LensFile::kKalibr), testing::IsSupersetOf<std::string_view>({"pinhole", "ds", "omni"}));
}

TEST(LensForms, TheShortestExactOneIsWritten) {
  const auto name = [](LensFile file, const CameraModel& camera) {
    const auto form = exact_form(file, camera);
    return form ? form->name : "none";
  };
  const CameraModel four = with(DistortionModel::kRadTan, {-0.3, 0.1, 1e-3, 1e-3});
  const CameraModel eight = with(DistortionModel::kRadTan, {-0.3, 0.1, 0, 0, 0, 0, 0, 0.1});
  EXPECT_EQ(name(LensFile::kColmap, four), "OPENCV") << "with two focal lengths, though k1 alone may be given";
  EXPECT_EQ(name(LensFile::kColmap, eight), "FULL_OPENCV");
  EXPECT_EQ(name(LensFile::kRos, four), "plumb_bob");
  EXPECT_EQ(name(LensFile::kRos, eight), "rational_polynomial");
  EXPECT_EQ(name(LensFile::kOrbSlam, eight), "none");
  EXPECT_EQ(name(LensFile::kKalibr, with(DistortionModel::kOmni, {0.9})), "omni");
  EXPECT_EQ(name(LensFile::kColmap, with(DistortionModel::kOmni, {0.9})), "none");
  EXPECT_EQ(name(LensFile::kColmap, with(DistortionModel::kNone)), "PINHOLE");
  EXPECT_EQ(name(LensFile::kRos, with(DistortionModel::kNone)), "plumb_bob") << "of zeros";
  EXPECT_EQ(most_terms(LensFile::kKalibr, DistortionModel::kRadTan), 4U);
  EXPECT_EQ(most_terms(LensFile::kColmap, DistortionModel::kOmni), 0U);
}

TEST(LensForms, PlainFilesHaveAsFewCoefficientsAsTheModelMayHave) {
  EXPECT_EQ(coefficient_count(with(DistortionModel::kRadTan)), 4U);
  EXPECT_EQ(coefficient_count(with(DistortionModel::kRadTan, {0, 0, 0, 0, 0.1})), 5U);
  EXPECT_EQ(coefficient_count(with(DistortionModel::kRadTan, {0, 0, 0, 0, 0, 0.1})), 8U);
  EXPECT_EQ(coefficient_count(with(DistortionModel::kOmni, {0.9})), 5U);
  EXPECT_EQ(coefficient_count(with(DistortionModel::kUnknown)), 0U);
}

TEST(LensForms, FilesOfSpheresHaveTheFocalLengthOfTheSphere) {
  EXPECT_EQ(focal_in_files(with(DistortionModel::kOmni, {0.9})), 1.9);
  EXPECT_EQ(focal_in_files(with(DistortionModel::kDoubleSphere, {-0.25, 0.6})), 0.75);
  EXPECT_EQ(focal_in_files(with(DistortionModel::kEquidistant, {0.1})), 1.0);
}

}  // namespace
}  // namespace coslam::lens_forms_test
