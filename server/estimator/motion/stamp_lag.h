// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/solve/lag.h"

namespace coslam {

struct StampLagConfig {
  bool enabled = true;
  double most_s = 2;     // largest lag in either direction
  double memory_s = 20;  // age up to which observations count
};

template <class V>
void describe(V& v, StampLagConfig& c) {
  v.field("enabled", c.enabled, "look for cameras whose stamps are off by more than the clocks are estimated for");
  v.field("most_s", c.most_s, {0.1, 60}, "how far off they may be to be found");
  v.field("memory_s", c.memory_s, {5, 600}, "of what was seen to move");
}

struct StampLagReport {
  int found = 0;
  void count(auto&& add) const { add("misdated_cameras", found); }
};

// Finds cameras whose stamps are wrong by more than ClockOffsets handles, as in videos that were not started together:
// then nothing that moves is seen at one place. Compares how things move in two cameras as a whole (solve/lag.h), one
// lag per frame set, and reports what it found; nothing is corrected.
class StampLag {
 public:
  static constexpr std::string_view kName = "stamp_lag";
  using Config = StampLagConfig;
  explicit StampLag(const StampLagConfig& stage_config) : config(stage_config) {}
  StampLagConfig config;

  StampLagReport run(StampLagEdit& edit);
  // Compares at the end of a run, over lags up to half of the memory, whatever pairs are known by then.
  void finish(StampLagEdit& edit);
  // Forgets a camera, whose clock is another one from now on.
  void forget(CameraId camera);
  // Lag of a camera: its images were taken this much later than dated, relative to a camera with a smaller id.
  struct Lag {
    double lag_s = 0;
    CameraId against;
    bool is_off() const;  // larger than clocks are estimated for
  };
  std::optional<Lag> lag(CameraId camera) const;

 private:
  using Pair = std::pair<CameraId, CameraId>;
  // Rays towards what moves in one image, in the camera's frame because poses may still be corrected.
  struct Sight {
    SetId set;
    std::vector<MovingSight::Ray> rays;
  };
  struct Search {
    Pair pair;
    std::vector<MovingSight> first, second;
    std::vector<LagAgreement> lags;
  };
  struct Known {
    TimeNs searched_ns = 0;
    std::optional<double> lag_s;  // result of the last search
    bool reported = false;
  };

  void look(const Map& map, const MapCamera& camera);
  std::vector<MovingSight> in_world(const Map& map, CameraId camera) const;
  bool comparable(const Map& map, const Pair& pair) const;
  TimeNs waited_ns(const Map& map, const Pair& pair) const;
  std::optional<double> lag_at_end(std::span<const MovingSight> first, std::span<const MovingSight> second) const;
  bool begin_search(const Map& map);
  bool end_search(StampLagEdit& edit);
  bool note(StampLagEdit& edit, const Pair& pair, double lag_s);

  std::map<CameraId, std::deque<Sight>> sights_;
  std::map<Pair, Known> known_;
  std::optional<Search> search_;
};

}  // namespace coslam
