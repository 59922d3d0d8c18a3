// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/path_watch.h"

#include <algorithm>
#include <utility>

namespace coslam {
namespace {

using Clock = std::chrono::steady_clock;

// Between two looks: so little of a processor, and still less of the map's thread, goes into it.
constexpr std::chrono::seconds kLeastApart{3};
constexpr int kShareBeside = 20, kShareOfMap = 200;

}  // namespace

void PathWatch::look(const MapServer& server, Clock::time_point now) {
  constexpr std::size_t kLeastKeyFrames = 8;
  if (auto found = beside_ ? beside_->take() : std::nullopt) {
    paths_ = std::move(found->paths);
    due_ = now + std::max<Clock::duration>({kLeastApart, kShareBeside * found->took, kShareOfMap * planning_});
  }
  if ((beside_ && beside_->busy()) || now < due_ || server.map().key_frames().size() < kLeastKeyFrames) return;
  const Clock::time_point begin = Clock::now();
  auto job = plan_path_errors(server.map(), server.largest_map());
  planning_ = Clock::now() - begin;
  if (!job) {
    due_ = now + kLeastApart;
    return;
  }
  if (!beside_) beside_.emplace("paths");
  beside_->start([job = std::move(*job)] {
    const Clock::time_point from = Clock::now();
    PathErrors paths = path_errors(job);
    return Found{std::move(paths), Clock::now() - from};
  });
}

std::optional<PathError> PathWatch::path_error(CameraId camera) const {
  const auto at = paths_.find(camera);
  return at == paths_.end() ? std::nullopt : std::optional(at->second);
}

}  // namespace coslam
