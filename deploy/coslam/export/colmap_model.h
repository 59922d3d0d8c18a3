// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/sequence.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"
#include "deploy/coslam/export/played_images.h"

namespace coslam::exporting {

// Images with their cameras, and the static points that at least two of them see. Pixels are those of the model's
// cameras as captured (raw px); points are in the map frame.
struct ColmapModel {
  struct Observation {
    Eigen::Vector2d px;
    PointId point;  // 0 = none
  };
  struct Image {
    std::size_t camera = 0;  // index
    FrameId frame;
    TimeNs t_ns = 0;
    Rigid3 cam_from_world;
    std::vector<Observation> observations;
    std::string name;  // a path within the folder of images
  };
  struct TrackElement {
    std::size_t image = 0, observation = 0;  // indices
  };
  struct Point {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::array<std::uint8_t, 3> rgb{128, 128, 128};
    std::vector<TrackElement> track;
  };
  struct Camera {
    SequenceAgent agent;
    CameraModel model;
    std::vector<PlayedImage> played;  // all images of it; empty: they are not there any more
  };
  std::vector<Camera> cameras;
  std::vector<Image> images;
  std::map<PointId, Point> points;

  const CameraModel& camera_of(const Image& image) const { return cameras[image.camera].model; }
};

// Images have tracks so seldom, see ResultStore.
inline constexpr int kTracksOfEvery = 10;

// The images of tracks/<agent>.csv that have a pose, and of these one of so many. A track is an observation of its
// point in all of them but those in which it was seen to move. Throws UserError.
ColmapModel read_colmap_model(const ResultMap& map, const Sequence& sequence, int every = kTracksOfEvery);

// Puts images into the adjusted model between those with tracks: one of so many that have a pose, moved as those beside
// it were. None where `every` is no less than kTracksOfEvery. Throws UserError: the images are not there.
void add_images_between(const ResultMap& map, int every, ColmapModel* model);

// Names images as the files of their sources: by the path from the deepest folder that has them all, which is returned.
// Where a source has no files, or one twice: <agent>/<6-digit frame>.png; empty where none has any.
std::filesystem::path name_as_files(ColmapModel* model);
// <agent>/<name of the file>.png, or the 6-digit frame.
void name_as_pngs(ColmapModel* model);

// Makes the tracks of the points from the observations. Images that show too few points to have a place of their own
// go, and points that fewer than two images see.
void link_points(ColmapModel* model);

// Distance in px of an observation from its point's projection; infinite behind the camera.
double error_px(const ColmapModel& model, const ColmapModel::Point& point, const ColmapModel::TrackElement& element);
// Mean over its track.
double mean_error_px(const ColmapModel& model, const ColmapModel::Point& point);
// Mean over the points of the above, as COLMAP counts it.
double mean_error_px(const ColmapModel& model);

}  // namespace coslam::exporting
