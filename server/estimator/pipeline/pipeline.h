// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/metrics.h"
#include "common/base/workers.h"
#include "server/estimator/map/memory.h"
#include "server/estimator/map/renumber.h"
#include "server/estimator/map/rows.h"
#include "server/estimator/pipeline/stage.h"

namespace coslam {

// Counts of what the stages did, summed over the run, by name; and how long they took.
struct PipelineReport {
  std::map<std::string, long> counts;
  StageTimes times;
};

// A list of stages, run in order at each frame set. Names, times, periods, configuration, counts and state of the
// stages follow from the list.
template <class... Stages>
class Pipeline {
 public:
  using Configs = std::tuple<typename Stages::Config...>;

  explicit Pipeline(const Configs& configs) : stages_{make<Stages>(std::get<typename Stages::Config>(configs))...} {}

  // Sets the workers that share in the work of each stage that asks for Workers; they outlive the pipeline.
  void work_with(Workers& workers) { workers_ = &workers; }

  void step(const FrameSet& set, MapEdit& edit, const ServerRun& server, PipelineReport* report) {
    (run_if_due<Stages>({set, edit, server, *workers_}, report), ...);
  }

  template <class Stage>
  Stage& stage() {
    return std::get<Stage>(stages_);
  }
  template <class Stage>
  const Stage& stage() const {
    return std::get<Stage>(stages_);
  }
  // Report of the newest set; made by default if the stage was not due in it.
  template <class Report>
  const Report& report() const {
    return std::get<index<Report>()>(reports_);
  }
  // Moves the report of the newest set out.
  template <class Report>
  Report take_report() {
    return std::exchange(std::get<index<Report>()>(reports_), {});
  }
  // Runs one stage by itself, also outside the order.
  template <class Stage>
  const stage::ReportOf<Stage>& run(const FrameSet& set, MapEdit& edit, const ServerRun& server,
                                    PipelineReport* report) {
    run_stage<Stage>({set, edit, server, *workers_}, report);
    return std::get<position<Stage>()>(reports_);
  }

  // Calls to all stages that have the function, in their order; see stage.h.
  void save(std::vector<Row>* rows) {
    each([&](auto& stage) {
      if constexpr (requires { stage.save(rows); }) stage.save(rows);
    });
  }
  void restore(const Tables& tables) {
    each([&](auto& stage) {
      if constexpr (requires { stage.restore(tables); }) stage.restore(tables);
    });
  }
  void take_in(const Pipeline& other, const Renumbered& as) {
    each([&]<class Stage>(Stage& stage) {
      if constexpr (requires { stage.take_in(stage, as); }) stage.take_in(other.stage<Stage>(), as);
    });
  }
  void forget(CameraId camera) {
    each([&](auto& stage) {
      if constexpr (requires { stage.forget(camera); }) stage.forget(camera);
    });
  }
  std::vector<ImageKey> held_frames() const {
    std::vector<ImageKey> all;
    each([&](const auto& stage) {
      if constexpr (requires { stage.held_frames(); }) {
        const std::vector<ImageKey> held = stage.held_frames();
        all.insert(all.end(), held.begin(), held.end());
      }
    });
    return all;
  }
  void forget(const std::vector<ImageKey>& images) {
    each([&](auto& stage) {
      if constexpr (requires { stage.forget(images); }) stage.forget(images);
    });
  }
  void add_memory(MemoryUse* use) const {
    each([&](const auto& stage) {
      if constexpr (requires { stage.add_memory(use); }) stage.add_memory(use);
    });
  }

  // Hands a last image to the stages that take one, see stage.h.
  void take_last_image(CameraId camera, const DescriptorReply& reply) {
    each([&](auto& stage) {
      if constexpr (requires { stage.take_last_image(camera, reply); }) stage.take_last_image(camera, reply);
    });
  }

  template <class V>
  static void describe_all(V& v, Configs& configs) {
    (v.section(std::string(Stages::kName), std::get<typename Stages::Config>(configs)), ...);
  }

 private:
  struct Given {
    const FrameSet& set;
    MapEdit& edit;
    const ServerRun& server;
    Workers& workers;
  };

  template <class Visit>
  void each(Visit visit) {
    std::apply([&](auto&... stage) { (visit(stage), ...); }, stages_);
  }
  template <class Visit>
  void each(Visit visit) const {
    std::apply([&](const auto&... stage) { (visit(stage), ...); }, stages_);
  }

  template <class Stage>
  static Stage make(const typename Stage::Config& config) {
    if constexpr (requires { Stage(config); }) {
      return Stage(config);
    } else {
      return Stage{config};
    }
  }
  template <class Stage>
  static constexpr std::size_t position() {
    return stage::index_of<Stage, Stages...>();
  }
  template <class Report>
  static constexpr std::size_t index() {
    constexpr std::size_t i = stage::index_of<Report, stage::ReportOf<Stages>...>();
    static_assert(i < sizeof...(Stages), "no stage gives this report");
    return i;
  }

  template <class Stage, class Wanted>
  Wanted give(const Given& given) {
    using T = std::remove_cvref_t<Wanted>;
    if constexpr (std::same_as<T, FrameSet>) {
      return given.set;
    } else if constexpr (std::derived_from<T, MapPen>) {
      return given.edit;
    } else if constexpr (std::same_as<T, Map>) {
      return given.edit.map();
    } else if constexpr (std::same_as<T, ServerRun>) {
      return given.server;
    } else if constexpr (std::same_as<T, Workers>) {
      return given.workers;
    } else if constexpr (std::same_as<T, HeldFrames>) {
      return HeldFrames{held_frames()};
    } else if constexpr (stage::index_of<T, Stages...>() < sizeof...(Stages)) {
      return std::get<T>(stages_);
    } else if constexpr (stage::is_last<T>) {
      return {std::get<index<std::remove_cvref_t<decltype(std::declval<T>().of)>>()>(reports_)};
    } else if constexpr (stage::index_of<T, typename Stages::Config...>() < sizeof...(Stages)) {
      return std::get<stage::index_of<T, typename Stages::Config...>()>(stages_).config;
    } else {
      static_assert(index<T>() < position<Stage>(),
                    "the stage that gives this report comes later: ask for the Last one");
      return std::get<index<T>()>(reports_);
    }
  }

  template <class Stage>
  void run_if_due(const Given& given, PipelineReport* report) {
    if constexpr (stage::Periodic<Stage>) {
      if (!std::get<Stage>(stages_).due(given.edit.map())) {
        std::get<position<Stage>()>(reports_) = {};
        return;
      }
    }
    run_stage<Stage>(given, report);
  }

  template <class Stage>
  void run_stage(const Given& given, PipelineReport* report) {
    const auto timer = report->times.measure(std::string(Stage::kName));
    auto& out = std::get<position<Stage>()>(reports_);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      using Arguments = typename stage::Signature<decltype(&Stage::run)>::Arguments;
      out = std::get<Stage>(stages_).run(give<Stage, std::tuple_element_t<I, Arguments>>(given)...);
    }
    (std::make_index_sequence<std::tuple_size_v<typename stage::Signature<decltype(&Stage::run)>::Arguments>>());
    if constexpr (requires { out.count([](const char*, long) {}); }) {
      out.count([&](const char* name, long n) { report->counts[name] += n; });
    }
  }

  Workers* workers_ = &Workers::alone();
  std::tuple<Stages...> stages_;
  std::tuple<stage::ReportOf<Stages>...> reports_;
};

}  // namespace coslam
