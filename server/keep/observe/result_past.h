// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "server/estimator/map/past.h"
#include "server/keep/observe/spill_file.h"

namespace coslam {

// Points that moved as one object at an instant.
struct SeenObject {
  TimeNs t_ns = 0;
  ObjectId id;
  std::vector<PointId> members;
};

// The part of a run that is no longer in memory, as far as a result needs it. Positions are read as the map now has
// them. Reading throws UserError. Thread-compatible.
class ResultPast {
 public:
  explicit ResultPast(const std::filesystem::path& folder) : file_(folder) {}

  // Each block of frames counts once.
  void add(const PastPart& past);
  // Poses as an agent published them, in the frame of that map. Ascending, from one call to the next too.
  void add_live(CameraId camera, MapId map, const Trajectory& part);
  void add_objects(const std::vector<SeenObject>& objects);  // likewise
  std::optional<std::string> take_problem() { return file_.take_problem(); }

  bool empty() const { return frames_.empty() && live_.empty() && places_.empty() && objects_.empty(); }
  // The camera's poses in that map, from the set `since` on.
  Trajectory trajectory(const Map& map, CameraId camera, MapId map_id, SetId from_set) const;
  Trajectory live(CameraId camera, MapId map) const;
  // Places of points that move, in that map; ascending time.
  void for_each_place(const Map& map, MapId map_id, const std::function<void(const ResultDynamicRow&)>& visit) const;
  // Number of blocks of objects, as they were added.
  std::size_t object_blocks() const { return objects_.size(); }
  std::vector<SeenObject> objects(std::size_t block) const;

 private:
  struct FrameBlock {
    SetId first;
    SpillFile::Ticket ticket = 0;
  };
  class Poses;

  SpillFile file_;
  std::map<CameraId, std::vector<FrameBlock>> frames_;
  std::map<std::pair<CameraId, MapId>, std::vector<SpillFile::Ticket>> live_;
  std::vector<SpillFile::Ticket> places_, objects_;
};

}  // namespace coslam
