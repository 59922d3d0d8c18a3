// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/estimator/map/map.h"
#include "server/estimator/map/rows.h"

// Archived data of a long run, and where it is in the map as it is now. A map keeps moving: it is adjusted, corrected
// by loops and made part of others. Archived frames are anchored to those of their camera that memory still has, and
// positions of moving points to the frames that saw them.
namespace coslam {

// State of the maps as wholes when something was archived.
struct ArchivedPlace {
  std::uint64_t moves = 0;  // number of Map::moves() so far
  TimeNs shifted_ns = 0;    // Map::shifted_ns() so far
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

// Position of a moving point, relative to a camera that saw it.
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
  std::vector<PastPlace> places;  // sorted by time
};
auto fields(Like<PastPlaces> auto& p) { return std::tuple(kept("put", p.put), kept("places", p.places)); }

// All data that leaves memory at one instant.
struct PastPart {
  std::vector<PastFrames> frames;
  std::optional<PastPlaces> places;
  std::vector<ImageKey> views;  // images of which nothing is kept any more
};

inline ArchivedPlace put_down_now(const Map& map) { return {map.moves().size(), map.shifted_ns()}; }

// Map that an earlier map is now, or is part of, and the transform from the earlier one.
struct MovedMap {
  MapId map;
  Similarity3 now_from_then;
};
MovedMap moved_map(const Map& map, const ArchivedPlace& put, MapId earlier_map);

// Returns archived frames as they are now. Corrections of the neighbours that memory still has are interpolated between
// these, as bundle adjustments do it between key frames.
std::vector<FramePose> frames_now(const Map& map, const PastFrames& block);

// Renumbers archived data of a map that was taken in.
struct Renumbered;
void renumber(const Renumbered& renumbered, PastFrames* block);
void renumber(const Renumbered& renumbered, PastPlaces* block);

// Serialises archived data to octets for files, and reads it. Throws UserError for damaged octets.
std::string octets_of_past(const PastFrames& block);
std::string octets_of_past(const PastPlaces& block);
PastFrames past_frames_of(const std::string& octets);
PastPlaces past_places_of(const std::string& octets);

// Tables of the map file whose rows stay on disk.
inline constexpr const char* kPastFramesTable = "past_frame";
inline constexpr const char* kPastPlacesTable = "past_place";
std::vector<Row> rows_of(const PastPart& past);
// Keys of the first and last row of one camera.
std::pair<std::int64_t, std::int64_t> past_frames_rows_of(CameraId camera);

}  // namespace coslam
