// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/printed.h"
#include "common/dataset/file.h"
#include "common/geometry/lens_forms.h"
#include "deploy/coslam/export/colmap_adjust.h"
#include "deploy/coslam/export/colmap_model.h"
#include "deploy/coslam/export/export.h"
#include "deploy/coslam/export/masks.h"
#include "deploy/coslam/export/undistort.h"

namespace coslam::exporting {
namespace {

// The centre of COLMAP's first pixel is (0.5, 0.5), ours is (0, 0).
constexpr double kPixelCenter = 0.5;

std::string camera_text(std::size_t id, const CameraModel& c) {
  CameraModel lens = c;
  if (c.guessed()) lens.distortion = DistortionModel::kNone;
  const auto form = exact_form(LensFile::kColmap, lens);
  if (!form) {
    throw UserError("COLMAP has no model for the lens of camera " + std::to_string(id) + " (" +
                    std::string(lens_traits(c.distortion).name()) + "): add --undistort");
  }
  const double scale = focal_in_files(lens);
  std::string text = printed("%zu %s %d %d %.10g %.10g %.10g %.10g", id, std::string(form->name).c_str(), c.width_px,
                             c.height_px, c.fx * scale, c.fy * scale, c.cx + kPixelCenter, c.cy + kPixelCenter);
  for (std::size_t i = 0; i < form->terms; ++i) text += printed(" %.10g", c.coefficients[i]);
  return text + "\n";
}

std::string image_text(std::size_t id, const ColmapModel::Image& image) {
  const Eigen::Quaterniond& q = image.cam_from_world.rotation;
  const Eigen::Vector3d& t = image.cam_from_world.translation;
  std::string text = printed("%zu %.12f %.12f %.12f %.12f %.9g %.9g %.9g %zu %s\n", id, q.w(), q.x(), q.y(), q.z(),
                             t.x(), t.y(), t.z(), image.camera + 1, image.name.c_str());
  for (const auto& o : image.observations) {
    const long long point = o.point == PointId() ? -1 : static_cast<long long>(o.point.value);
    text += printed("%s%.3f %.3f %lld", &o == image.observations.data() ? "" : " ", o.px.x() + kPixelCenter,
                    o.px.y() + kPixelCenter, point);
  }
  return text + "\n";
}

std::string point_text(const ColmapModel& model, PointId id, const ColmapModel::Point& p) {
  std::string text = printed("%u %.9g %.9g %.9g %d %d %d %.4f", id.value, p.position.x(), p.position.y(),
                             p.position.z(), p.rgb[0], p.rgb[1], p.rgb[2], mean_error_px(model, p));
  for (const auto& e : p.track) text += printed(" %zu %zu", e.image + 1, e.observation);
  return text + "\n";
}

Files write_model(const ColmapModel& model, const std::filesystem::path& folder) {
  Files files = {folder / "cameras.txt", folder / "images.txt", folder / "points3D.txt"};
  std::ofstream cameras = create_file(files[0]);
  cameras << "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  for (std::size_t i = 0; i < model.cameras.size(); ++i) cameras << camera_text(i + 1, model.cameras[i].model);
  close_file(cameras, files[0]);
  std::ofstream images = create_file(files[1]);
  images << "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n";
  for (std::size_t i = 0; i < model.images.size(); ++i) images << image_text(i + 1, model.images[i]);
  close_file(images, files[1]);
  std::ofstream points = create_file(files[2]);
  points << "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
         << printed("# Number of points: %zu, mean reprojection error: %.4f\n", model.points.size(),
                    mean_error_px(model));
  for (const auto& [id, point] : model.points) points << point_text(model, id, point);
  close_file(points, files[2]);
  return files;
}

ColmapModel read_model(const ResultMap& map, const Sequence& sequence, const ColmapOptions& options) {
  ColmapModel model = read_colmap_model(map, sequence, options.every);
  if (model.images.empty()) {
    throw UserError(map.folder.path().string() + ": no image of the sequence has a pose and enough points");
  }
  return model;
}

// Some programs look for the model in sparse, others in sparse/0.
void link_as_first_model(const Files& files) {
  for (const auto& file : files) {
    const auto link = file.parent_path() / "0" / file.filename();
    std::error_code error;
    std::filesystem::create_directories(link.parent_path(), error);
    std::filesystem::remove(link, error);
    std::filesystem::create_symlink(std::filesystem::path("..") / file.filename(), link, error);
    if (error) throw UserError(link.string() + ": cannot be made: " + error.message());
  }
}

// What COLMAP's patch_match_stereo and stereo_fusion look for beside images and model.
void write_stereo_plan(const ColmapModel& model, const std::filesystem::path& folder) {
  const auto plan = folder / "patch-match.cfg", fusion = folder / "fusion.cfg";
  std::ofstream plans = create_file(plan), fusions = create_file(fusion);
  for (const auto& image : model.images) {
    const std::string& name = image.name;
    plans << name << "\n__auto__, 20\n";
    fusions << name << "\n";
    for (const char* maps : {"depth_maps", "normal_maps", "consistency_graphs"}) {
      std::error_code error;
      std::filesystem::create_directories((folder / maps / name).parent_path(), error);
      if (error) throw UserError((folder / maps).string() + ": cannot be made: " + error.message());
    }
  }
  close_file(plans, plan);
  close_file(fusions, fusion);
}

}  // namespace

Files export_colmap(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder,
                    const ColmapOptions& options) {
  ColmapModel model = read_model(map, sequence, options);
  adjust_colmap_model(&model);
  add_images_between(map, options.every, &model);
  const std::filesystem::path images = name_as_files(&model);
  if (images.empty()) {
    log_info("the sequence has no file for each image: --undistort writes them beside the model");
  } else {
    log_info("the images of the model lie in " + images.string() + ": that is COLMAP's --image_path");
  }
  return write_model(model, folder);
}

Files export_colmap_undistorted(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder,
                                const ColmapOptions& options) {
  ColmapModel model = read_model(map, sequence, options);
  std::vector<CameraModel> lenses;
  for (const auto& camera : model.cameras) lenses.push_back(camera.model);
  undistort_model(&model);
  adjust_colmap_model(&model);
  add_images_between(map, options.every, &model);
  name_as_pngs(&model);
  write_undistorted_images(lenses, sequence.rate_hz, folder / "images", &model);
  Files files = write_model(model, folder / "sparse");
  link_as_first_model(files);
  write_stereo_plan(model, folder / "stereo");
  for (const char* more : {"images", "stereo"}) files.push_back(folder / more);
  if (write_masks(map.folder, model, folder / "masks")) files.push_back(folder / "masks");
  return files;
}

}  // namespace coslam::exporting
