// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pipeline/stage_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <concepts>
#include <string_view>

#include "server/estimator/map_pipeline.h"

namespace coslam::stage_table_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const StageAccess& row(const std::vector<StageAccess>& all, const std::string& name) {
  return *std::ranges::find(all, name, &StageAccess::name);
}

TEST(StageTable, SaysWhatTheSignaturesSay) {
  const std::vector<StageAccess> all = stage_access<MapPipeline>();
  EXPECT_EQ(all.front().name, "bundle_adjustment");
  EXPECT_THAT(row(all, "cull").writes, ElementsAre("keep_untracked", "remove_point", "thin_patches"));
  EXPECT_THAT(row(all, "grouping").writes, ElementsAre());
  EXPECT_THAT(row(all, "wide_search").settings, ElementsAre("wide_search", "localise"));
  EXPECT_THAT(row(all, "inter_pose").reads, Contains("`grouping` of the set before"));
  EXPECT_THAT(row(all, "map_inter").reads, AllOf(Contains("`grouping`"), Contains("map"), Contains("frame set")));
}

TEST(StageTable, HasARowForEachStage) {
  const std::string table = markdown_of(stage_access<MapPipeline>());
  EXPECT_THAT(table, HasSubstr("| stage | reads | writes | settings |\n|---|---|---|---|\n| `bundle_adjustment` |"));
  EXPECT_EQ(std::ranges::count(table, '\n'), 2 + static_cast<long>(stage_access<MapPipeline>().size()));
}

template <class Key>
concept MayRemovePoints = requires(Key& key, const MapPoint& point) {
  key.remove_point(point, Why::kTooFewViews);
};
template <class Key>
concept MayMerge = requires(Key& key) {
  key.merge(MapId(), MapId(), Similarity3());
};

// A key lists the verbs of the narrow keys that it derives from, so that the table shows them.
template <class Key, class Narrow>
constexpr bool lists() {
  return std::derived_from<Key, Narrow> && std::ranges::all_of(Narrow::kMay, [](std::string_view verb) {
           return std::ranges::find(Key::kMay, verb) != Key::kMay.end();
         });
}
static_assert(lists<LocaliseEdit, FramePoseEdit>() && lists<StartEdit, FramePoseEdit>());
static_assert(lists<PlaceRecognitionEdit, FramePoseEdit>() && lists<PlaceRecognitionEdit, PointPositionEdit>());
static_assert(lists<StartEdit, BundleEdit>() && lists<BundleEdit, PointPositionEdit>());
static_assert(lists<RegisterEdit, PointPositionEdit>() && lists<ForgetEdit, LateFrameEdit>());
static_assert(lists<ClassifyEdit, MovingPathEdit>() && lists<MapMovingEdit, MovingPathEdit>());

// The keys are types: what a stage may not do does not compile.
static_assert(MayRemovePoints<CullEdit> && !MayRemovePoints<VerifyEdit> && !MayRemovePoints<LocaliseEdit>);
static_assert(MayMerge<PlaceRecognitionEdit> && !MayMerge<CullEdit> && !MayMerge<StartEdit>);
static_assert(MayRemovePoints<MapEdit> && MayMerge<MapEdit>);

}  // namespace
}  // namespace coslam::stage_table_test
