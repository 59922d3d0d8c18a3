// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <unordered_map>
#include <vector>

#include "common/dataset/result.h"
#include "server/estimator/map/map.h"

namespace coslam {

// tracks/<agent>.csv of a result: states as they are known at the time, while the run goes on. What went along with the
// camera before it was found to move is marked when the file is closed.
class TrackStore {
 public:
  // Begins the file. Throws UserError.
  explicit TrackStore(std::filesystem::path file) : path_(std::move(file)), file_(path_) {}

  // All tracks of this frame, the camera's newest.
  void record(const TrackFrame& frame, const MapCamera& camera, const Map& map);
  CsvWriter& file() { return file_; }
  // Rewrites the closed file with the motion that was recognised later, if there is any to mark. Throws UserError, and
  // leaves the file as it is then.
  void mark_earlier_motion() const;

 private:
  struct Span {
    TimeNs from_ns, until_ns;
  };
  bool moved_at(TrackId track, TimeNs t_ns) const;

  const std::filesystem::path path_;
  TrackWriter file_;
  std::unordered_map<TrackId, std::vector<Span>> moved_;  // before it was noticed
};

}  // namespace coslam
