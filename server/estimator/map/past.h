// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/estimator/map/map.h"
#include "server/estimator/map/rows.h"

// What a long run put out of its memory, and where it is in the map as it is now. A map goes on moving: it is adjusted,
// drawn together and made part of others. Frames that are past hang on those of their camera that memory still has, and
// what was seen to move hangs on the frames that saw it.
namespace coslam {

// What was known of the map as a whole when something was put down.
struct ArchivedPlace {
  std::uint64_t moves = 0;  // of Map::moves() that it had been through
  TimeNs shifted_ns = 0;    // Map::shifted_ns()
};
auto fields(Like<ArchivedPlace> auto& p) {
  return std::tuple(kept("moves", p.moves), kept("shifted_ns", p.shifted_ns));
}

// Successive frames of one camera, without what they held.
struct PastFrames {
  ArchivedPlace put;
  CameraId camera;
  std::vector<FramePose> frames;
};

// A place of a moving point, as a camera saw it.
struct PastPlace {
  TimeNs t_ns = 0;
  PointId point;
  SetId set;
  CameraId camera;
  MapId map;
  Eigen::Vector3d p_in_cam = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_in_cam = Eigen::Matrix3d::Zero();
  int views = 0;
};
auto fields(Like<PastPlace> auto& p) {
  return std::tuple(instant("t_ns", p.t_ns), kept("point", p.point), kept("set", p.set), kept("camera", p.camera),
                    kept("map", p.map), kept("p_in_cam", p.p_in_cam), kept("covariance_in_cam", p.covariance_in_cam),
                    kept("views", p.views));
}

struct PastPlaces {
  ArchivedPlace put;
  std::vector<PastPlace> places;  // ascending time
};
auto fields(Like<PastPlaces> auto& p) { return std::tuple(kept("put", p.put), kept("places", p.places)); }

// All of one instant that leaves memory.
struct PastPart {
  std::vector<PastFrames> frames;
  std::optional<PastPlaces> places;
  std::vector<ImageKey> views;  // images of which nothing is kept any more
};

inline ArchivedPlace put_down_now(const Map& map) { return {map.moves().size(), map.shifted_ns()}; }

// The map that a map of then is now, or is part of, and how it came there.
struct Since {
  MapId map;
  Similarity3 now_from_then;
};
Since since(const Map& map, const ArchivedPlace& put, MapId then);

// The frames as they are now. What was corrected where memory holds their neighbours is shared out evenly between
// these, as bundle adjustments do it between key frames.
std::vector<FramePose> frames_now(const Map& map, const PastFrames& block);

// Of a map that was taken in.
struct Renumbered;
void renumber(const Renumbered& as, PastFrames* block);
void renumber(const Renumbered& as, PastPlaces* block);

// As octets, for files; and back. Throws UserError when they are none.
std::string octets_of_past(const PastFrames& block);
std::string octets_of_past(const PastPlaces& block);
PastFrames past_frames_of(const std::string& octets);
PastPlaces past_places_of(const std::string& octets);

// Rows of the map file: tables that stay on disk.
inline constexpr const char* kPastFramesTable = "past_frame";
inline constexpr const char* kPastPlacesTable = "past_place";
std::vector<Row> rows_of(const PastPart& past);
// Of one camera, from the first to the last such number.
std::pair<std::int64_t, std::int64_t> past_frames_rows_of(CameraId camera);

}  // namespace coslam
