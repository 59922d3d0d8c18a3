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

// clang-format off
// Interface of the pipeline's stages. A stage is a value:
//
//   struct Example {
//     static constexpr std::string_view kName = "example";  // of its section of the configuration and of its times
//     using Config = ExampleConfig;                         // with describe() beside it
//     Config config;
//     bool due(const Map& map) const;                       // optional: runs at some sets only
//     ExampleReport run(ExampleEdit& edit, const FrameSet& set, const ViewGraph& graph);
//   };
//
// The signature of run() says what a stage may read and write: it is given, by type,
//   const FrameSet&, const Map& or its key to the map (server/estimator/map/keys.h), const ServerRun&;
//   Workers&, who share in its work camera by camera;
//   the report of a stage before it in the same set, `const ViewGraph&`, or that of any stage from the set before,
//   `Last<ViewGraph>`;
//   the configuration of another stage, `const LocaliseConfig&`;
//   another stage itself, whose state it reads, `const PlaceRecognition&`, or changes, `PlaceRecognition&`;
//   HeldFrames, the frames that all stages together want kept.
// A pipeline calls these functions of the stages that have them, for state beyond a set:
//   save(std::vector<Row>*), restore(const Tables&), take_in(const Example&, const Renumbered&): state that outlives
//   the server, and that of another server's;
//   forget(CameraId): the agent behind a camera changed;
//   held_frames(), forget(const std::vector<ImageKey>&): images that have to stay in memory, and those that left it;
//   add_memory(MemoryUse*): bytes by kind.
// These functions are called between sets:
//   take_last_image(CameraId, DescriptorReply): last image of an agent's run;
//   take_job(), give(RefineJob, BundleResult): a bundle adjustment to be solved beside, and its solution;
//   acknowledge(...): the answer to a frame that is too late to be used.
// Other stages may read its report alone; the figures that count() of a report names are summed over the run. State
// that outlives a set is a member of the stage, so that a copy of the stage is a copy of its state.
// clang-format on
namespace coslam {

// Identity of this process: ids that it gave are scoped by it.
struct ServerRun {
  RunId id;
  std::optional<ContinuedMap> continues;  // map of an earlier server that this one continues
};

// Report of a stage from the set before; made by default where the stage did not run in that set.
template <class Report>
struct Last {
  const Report& of;
};

// Frames that stages will read again, so that they have to stay in memory.
struct HeldFrames {
  std::vector<ImageKey> frames;
};

// Configuration of a stage without settings.
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
