// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/model/map_patch.h"
#include "server/estimator/map/edit.h"

// What a stage of the pipeline is. A stage is a value:
//
//   struct Example {
//     static constexpr std::string_view kName = "example";  // of its section of the configuration and of its times
//     using Config = ExampleConfig;                         // with describe() beside it
//     Config config;
//     bool due(const Map& map) const;                       // optional: runs at some sets only
//     ExampleReport run(ExampleEdit& edit, const FrameSet& set, const ViewGraph& graph);
//   };
//
// What it may read and write stands in the signature of run(): it is given, by type,
//   const FrameSet&, const Map& or its key to the map (server/estimator/map/keys.h), const ServerRun&;
//   Workers&, who share in what it does camera by camera;
//   the report of a stage before it in the same set, `const ViewGraph&`, or that of any stage from the set before,
//   `Last<ViewGraph>`;
//   the configuration of another stage, `const LocaliseConfig&`;
//   another stage itself, `PlaceRecognition&`, whose state it changes;
//   HeldFrames, what all stages together want kept.
// What it keeps beyond a set it tells by some of these, which a pipeline asks of all stages that have them:
//   save(std::vector<Row>*), restore(const Tables&), take_in(const Example&, const Renumbered&): what outlives the
//   server,
//     and that of another server's;
//   forget(CameraId): the agent behind a camera is another;
//   held_frames(), forget(const std::vector<ImageKey>&): images that have to stay in memory, and those that left it;
//   add_memory(MemoryUse*): bytes, by what they are for.
// What comes to it between sets:
//   take_last_image(CameraId, DescriptorReply): what an agent saw when its run ended;
//   take_job(), give(RefineJob, BundleResult): a bundle adjustment to be solved beside, and its solution;
//   acknowledge(...): the answer to a frame that is too late to be used.
// Its report is what others may read of it; what count() of a report names is summed over the run. State that outlives
// a set is a member of the stage, so that a copy of the stage is its state saved.
namespace coslam {

// Of this process: ids that it gave are scoped by it.
struct ServerRun {
  RunId id;
  std::optional<ContinuedMap> continues;  // it went on with the map of another
};

// The report that a stage gave at the last set it ran in before this one; where it has not run yet, one made by
// default.
template <class Report>
struct Last {
  const Report& of;
};

// Frames that stages will look at again, so that they have to stay in memory.
struct HeldFrames {
  std::vector<ImageKey> frames;
};

// For a stage that cannot be configured.
template <class Stage>
struct NoConfig {};
template <class V, class Stage>
void describe(V&, NoConfig<Stage>&) {}

namespace stage {

template <class Run>
struct Signature;
template <class Stage, class Report, class... Args>
struct Signature<Report (Stage::*)(Args...)> {
  using Result = Report;
  using Arguments = std::tuple<Args...>;
};
template <class Stage, class Report, class... Args>
struct Signature<Report (Stage::*)(Args...) const> : Signature<Report (Stage::*)(Args...)> {};

template <class Stage>
using ReportOf = typename Signature<decltype(&Stage::run)>::Result;

// Position of a type in a list, or its length.
template <class T, class... List>
constexpr std::size_t index_of() {
  std::size_t i = 0;
  (void)((std::same_as<T, List> || (++i, false)) || ...);
  return i;
}

template <class T>
inline constexpr bool is_last = false;
template <class Report>
inline constexpr bool is_last<Last<Report>> = true;

template <class Stage>
concept Periodic = requires(const Stage& s, const Map& map) {
  { s.due(map) } -> std::same_as<bool>;
};

}  // namespace stage
}  // namespace coslam
