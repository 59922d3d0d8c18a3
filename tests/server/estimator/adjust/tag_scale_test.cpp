// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/tag_scale.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/sim_map.h"

namespace coslam::tag_scale_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr CameraId kCam0(0);
constexpr double kSide_m = 0.4;

// A camera that moves before printed tags, in a map whose unit of length is 2.5 m at the beginning.
class TagScaleTest : public testing::Test {
 protected:
  explicit TagScaleTest(const test::CameraPath& path = test::wave_path({})) : sim_(world_, {path}) {}

  void hang(int tag, const Eigen::Vector3d& middle_m, double side_m = kSide_m) {
    hung_.push_back({TagId(static_cast<std::uint32_t>(tag)), middle_m, side_m});
  }
  // Frame sets, and what was said in all of them; drift_m: by how much the tags move from set to set.
  TagScaleReport step(int sets, bool merged = false, const Eigen::Vector3d& drift_m = Eigen::Vector3d::Zero()) {
    TagScaleReport all;
    for (int i = 0; i < sets; ++i) {
      sim_.look();
      for (Hung& h : hung_) {
        see(h);
        h.middle_m += drift_m;
      }
      sim_.take();
      sim_.place(kCam0, in_, transform_world(sim_.truth(kCam0, sim_.set.id), map_from_world()));
      add(scale_.step(sim_.edit, sim_.set, merged), &all);
    }
    return all;
  }
  static void add(TagScaleReport r, TagScaleReport* all) {
    all->measured += r.measured;
    all->scaled += r.scaled;
    for (std::string& doubt : r.doubts) all->doubts.push_back(std::move(doubt));
  }
  // Where truth is in the map as it is by now.
  Similarity3 map_from_world() const {
    Similarity3 out = in_from_world_;
    for (std::size_t i = moves_before_; i < sim_.map.moves().size(); ++i)
      out = sim_.map.moves()[i].into_from_from * out;
    return out;
  }

  const test::SimWorld world_{{.points = 30}};
  test::SimMap sim_;
  MapId in_ = sim_.id;
  Similarity3 in_from_world_{1 / 2.5, so3_exp({0.1, 0.4, 0}), {1, 2, 3}};
  std::size_t moves_before_ = 0;
  TagScale scale_{{.side_m = kSide_m}};

 private:
  struct Hung {
    TagId tag;
    Eigen::Vector3d middle_m;
    double side_m;
  };
  void see(const Hung& h) {
    TagObservation seen{h.tag, {}};
    const CameraModel& model = sim_.map.camera(kCam0).model;
    const auto corners = test::tag_corners(h.middle_m, h.side_m);
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d noise(normal_(random_), normal_(random_));
      seen.undistorted_px[k] = (model.project(sim_.truth(kCam0, sim_.set.id) * corners[k]) + noise).cast<float>();
    }
    sim_.set.frames[0].frame.tags.push_back(seen);
  }
  std::vector<Hung> hung_;
  std::mt19937_64 random_{5};
  std::normal_distribution<double> normal_{0, 0.2};
};

TEST_F(TagScaleTest, AMapTakesTheSizeOfItsTags) {
  hang(5, {0.2, -0.3, 3.5});
  hang(6, {-0.5, 0.3, 3});
  const TagScaleReport report = step(60);
  EXPECT_GE(report.scaled, 1);
  EXPECT_GE(report.measured, 2);
  EXPECT_THAT(report.doubts, IsEmpty());
  EXPECT_TRUE(scale_.in_metres(in_));
  EXPECT_THAT(scale_.in_metres(), ElementsAre(in_));
  EXPECT_NEAR(map_from_world().scale, 1, 0.03);
  ASSERT_EQ(scale_.tags(in_).size(), 2U);
  for (const MeasuredTag& t : scale_.tags(in_)) {
    EXPECT_EQ(t.size.status, TagStatus::kOk);
    EXPECT_NEAR(t.size.side, kSide_m, 0.02);
  }
  EXPECT_THAT(scale_.tags(MapId(9)), IsEmpty());
}

TEST_F(TagScaleTest, AtTheEndAllViewsCount) {
  hang(5, {0.2, -0.3, 3.5});
  step(90);
  const int scaled = scale_.finish(sim_.edit).scaled;
  EXPECT_EQ(scaled, 1) << "however certain it was before";
  EXPECT_NEAR(map_from_world().scale, 1, 0.01);
}

TEST_F(TagScaleTest, WithoutASizeTagsTellNothing) {
  scale_ = TagScale({.side_m = 0});
  hang(5, {0.2, -0.3, 3.5});
  EXPECT_EQ(step(30).measured, 0);
  EXPECT_EQ(scale_.finish(sim_.edit).measured, 0);
  EXPECT_DOUBLE_EQ(map_from_world().scale, in_from_world_.scale);
}

TEST_F(TagScaleTest, WithoutTagsNothingIsMeasured) {
  EXPECT_EQ(step(30).measured, 0);
  EXPECT_EQ(scale_.finish(sim_.edit).scaled, 0);
  EXPECT_THAT(scale_.in_metres(), IsEmpty());
}

class TagScaleAtRest : public TagScaleTest {
 protected:
  TagScaleAtRest() : TagScaleTest(test::still_path(test::looking({0, 0, 0}))) {}
};

TEST_F(TagScaleAtRest, ACameraThatStandsStillMeasuresNothing) {
  hang(5, {0.2, -0.3, 3.5});
  const TagScaleReport report = step(60);
  EXPECT_EQ(report.scaled, 0);
  EXPECT_THAT(report.doubts, IsEmpty()) << "there is nothing wrong with the tag";
  EXPECT_FALSE(scale_.in_metres(in_));
  EXPECT_EQ(scale_.finish(sim_.edit).scaled, 0);
}

TEST_F(TagScaleTest, TagsOfUnlikeSizeAreADoubtThatIsSaidOnce) {
  hang(5, {0.2, -0.3, 3.5});
  hang(6, {-0.5, 0.3, 3}, 0.75 * kSide_m);
  const TagScaleReport report = step(150);
  ASSERT_EQ(report.doubts.size(), 1U);
  EXPECT_EQ(report.doubts[0],
            "tag 5 is larger than tag 6, though all should be of one size; the size of the map is not taken from tags");
  EXPECT_FALSE(scale_.in_metres(in_));
  EXPECT_THAT(scale_.finish(sim_.edit).doubts, IsEmpty());
}

TEST_F(TagScaleTest, ATagThatIsTwiceInOneImageIsADoubt) {
  hang(5, {0.2, -0.3, 3.5});
  hang(5, {-0.5, 0.3, 3});
  const TagScaleReport report = step(60);
  ASSERT_EQ(report.doubts.size(), 1U);
  EXPECT_THAT(report.doubts[0], HasSubstr("tag 5 is printed twice"));
  EXPECT_EQ(report.scaled, 0);
}

TEST_F(TagScaleTest, ATagThatIsCarriedAboutTakesTheScaleBack) {
  hang(5, {0.2, -0.3, 3.5});
  step(60);
  ASSERT_TRUE(scale_.in_metres(in_));
  const TagScaleReport report = step(90, false, {0.01, 0, 0.01});
  EXPECT_FALSE(scale_.in_metres(in_));
  ASSERT_EQ(report.doubts.size(), 1U);
  EXPECT_THAT(report.doubts[0], HasSubstr("tag 5 is not in one place"));
}

TEST_F(TagScaleTest, AMapThatBecamePartOfAnotherGivesItsTagsToThat) {
  hang(5, {0.2, -0.3, 3.5});
  step(61);
  ASSERT_TRUE(scale_.in_metres(in_));
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 1);
  sim_.edit.merge(in_, other, {3, so3_exp({0, 0.5, 0}), {1, 0, 0}});
  in_ = other;
  EXPECT_NEAR(map_from_world().scale, 3, 0.1);
  const TagScaleReport report = step(1, true);
  EXPECT_EQ(report.scaled, 1) << "at once";
  EXPECT_THAT(scale_.in_metres(), ElementsAre(other));
  EXPECT_NEAR(map_from_world().scale, 1, 0.03);
}

}  // namespace
}  // namespace coslam::tag_scale_test
