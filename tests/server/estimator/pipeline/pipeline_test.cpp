// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include "common/config/config.h"
#include "tests/support/sim_run.h"
#include "tests/support/wire_equal.h"

namespace coslam::pipeline_test {
namespace {

struct FirstConfig {
  int step = 1;
};
template <class V>
void describe(V& v, FirstConfig& c) {
  v.field("step", c.step, {0, 100}, "that the sum grows by");
}
struct SecondConfig {
  int period = 2;
};
template <class V>
void describe(V& v, SecondConfig& c) {
  v.field("period", c.period, {1, 100}, "frame sets between runs");
}

struct Sum {
  int value = 0;
  void count(auto&& add) const { add("summed", value); }
};
struct Seen {
  int now = 0, before = 0, step = 0;
};

// Tells how often it ran.
struct First {
  static constexpr std::string_view kName = "first";
  using Config = FirstConfig;
  Config config;
  int sum = 0;
  Sum run(const FrameSet&) { return {sum += config.step}; }
};
// Runs now and then; reads the first one's report and configuration.
struct Second {
  static constexpr std::string_view kName = "second";
  using Config = SecondConfig;
  Config config;
  bool due(const Map& map) const { return map.now().value % static_cast<std::uint32_t>(config.period) == 0; }
  Seen run(const Sum& sum, Last<Seen> last, const FirstConfig& first) { return {sum.value, last.of.now, first.step}; }
};
// Reads what comes later, of the set before.
struct Before {
  static constexpr std::string_view kName = "before";
  using Config = NoConfig<Before>;
  Config config;
  struct Report {
    int last_sum = 0;
  };
  Report run(const Map&, Last<Sum> last) { return {last.of.value}; }
};

using Small = Pipeline<Before, First, Second>;

class PipelineTest : public testing::Test {
 protected:
  void step(std::uint32_t set) {
    edit_.ingest({SetId(set), 0, {}});
    pipeline_.step({SetId(set), 0, {}}, edit_, {RunId(1)}, &report_);
  }

  MapEdit edit_{MapConfig{}};
  Small::Configs configs_{NoConfig<Before>{}, FirstConfig{.step = 3}, SecondConfig{}};
  Small pipeline_{configs_};
  PipelineReport report_;
};

TEST_F(PipelineTest, AStageReadsWhatCameBeforeItInTheSetAndTheLastOfWhatComesLater) {
  step(0);
  EXPECT_EQ(pipeline_.report<Before::Report>().last_sum, 0);
  EXPECT_EQ(pipeline_.report<Seen>().now, 3);
  step(1);
  EXPECT_EQ(pipeline_.report<Before::Report>().last_sum, 3);
  EXPECT_EQ(pipeline_.report<Sum>().value, 6);
}

TEST_F(PipelineTest, AStageIsGivenTheConfigurationOfAnother) {
  step(0);
  EXPECT_EQ(pipeline_.report<Seen>().step, 3);
}

TEST_F(PipelineTest, OneThatIsNotDueDoesNotRunAndHasNothingToTell) {
  step(0);
  step(1);
  EXPECT_EQ(pipeline_.report<Seen>().now, 0);
  step(2);
  EXPECT_EQ(pipeline_.report<Seen>().now, 9);
  EXPECT_EQ(report_.times.stages().at("second").count(), 2U);
}

TEST_F(PipelineTest, CountsAreSummedAndTimesTakenByName) {
  for (std::uint32_t i = 0; i < 4; ++i) step(i);
  EXPECT_EQ(report_.counts.at("summed"), 3 + 6 + 9 + 12);
  EXPECT_EQ(report_.times.stages().at("first").count(), 4U);
  EXPECT_EQ(report_.times.stages().at("before").count(), 4U);
}

TEST_F(PipelineTest, ACopyIsTheStateSaved) {
  step(0);
  Small saved = pipeline_;
  step(1);
  saved.step({SetId(1), 0, {}}, edit_, {RunId(1)}, &report_);
  EXPECT_EQ(saved.report<Sum>().value, pipeline_.report<Sum>().value);
}

struct Described {
  Small::Configs configs{NoConfig<Before>{}, FirstConfig{}, SecondConfig{}};
};
template <class V>
void describe(V& v, Described& d) {
  Small::describe_all(v, d.configs);
}

TEST(PipelineConfiguration, IsASectionForEachStage) {
  Described d;
  config::apply_set(d, "first.step=7");
  config::apply_set(d, "second.period=5");
  EXPECT_EQ(std::get<FirstConfig>(d.configs).step, 7);
  EXPECT_EQ(std::get<SecondConfig>(d.configs).period, 5);
}

// No stage hides state: a copy of the server, made in the midst of a run with things that move, gives the same answers
// as the original from then on.
TEST(MapServerIsAValue, ACopyGoesOnLikeTheOriginal) {
  const test::SimWorld world({.points = 300, .moving_points = 40});
  MapServerConfig config;
  config.of<BundleAdjustmentConfig>().enabled = false;  // whose solutions come from outside
  test::SimRun run(world, config);
  for (const auto& path : test::paths_side_by_side(3)) run.add_agent(path);
  run.step(60);
  ASSERT_GT(run.map().moving_points().size(), 3U);
  MapServer copy = run.server();
  for (int i = 0; i < 20; ++i) {
    run.step();
    const std::vector<MapPatch> patches = copy.step(run.last_set());
    ASSERT_EQ(patches.size(), 3U);
    for (std::size_t k = 0; k < patches.size(); ++k) test::expect_same(patches[k], run.last_patches()[k]);
    ASSERT_EQ(copy.map().points().size(), run.map().points().size());
  }
}

}  // namespace
}  // namespace coslam::pipeline_test
