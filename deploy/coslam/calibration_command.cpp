// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/dataset/calibration.h"
#include "common/dataset/file.h"
#include "common/image/image_file.h"
#include "deploy/coslam/calibrate/dialects.h"
#include "deploy/coslam/commands.h"

namespace coslam {
namespace {

struct CalibrationArguments {
  std::string file, dialect, out, drawing;
};

constexpr double kDegrees = 180 / std::numbers::pi;

// The direction that is seen at a raw pixel; empty where the lens has no place for one.
std::optional<Eigen::Vector3d> direction_at(const CameraModel& c, const Eigen::Vector2d& raw_px) {
  const auto undistorted = c.undistorted_from_raw(raw_px);
  if (!undistorted) return std::nullopt;
  return c.normalized_from_pixel(*undistorted).homogeneous().normalized();
}

std::string angle_between(const CameraModel& c, const Eigen::Vector2d& a_px, const Eigen::Vector2d& b_px) {
  const auto a = direction_at(c, a_px), b = direction_at(c, b_px);
  if (!a || !b) return "more than the lens has places for";
  char text[16];
  std::snprintf(text, sizeof text, "%.1f", kDegrees * std::acos(std::clamp(a->dot(*b), -1.0, 1.0)));
  return text;
}

void say_largest_distortion(const CameraModel& c) {
  constexpr int kCells = 40;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double most_px = 0;
  int outside = 0;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      const Eigen::Vector2d px(i * (c.width_px - 1.0) / kCells, j * (c.height_px - 1.0) / kCells);
      const auto undistorted = c.undistorted_from_raw(px);
      outside += !undistorted;
      if (!undistorted || (*undistorted - px).norm() <= most_px) continue;
      most_px = (*undistorted - px).norm();
      at = px;
    }
  }
  if (most_px > 0) {
    std::printf("  distortion       %.1f pixels at most, at (%.0f, %.0f)\n", most_px, at.x(), at.y());
  } else {
    std::printf("  distortion       none\n");
  }
  if (outside > 0) {
    std::printf(
        "  not used         %.0f %% of the picture: rays of more than 86 degrees, or where the lens folds back\n",
        100.0 * outside / ((kCells + 1) * (kCells + 1)));
  }
}

void describe(const std::string& name, const CameraModel& c) {
  const double right = c.width_px - 1, bottom = c.height_px - 1;
  const std::string text = plain_text(c);
  const std::size_t model = text.find("distortion_model: ");
  std::printf("%s: %dx%d pixels\n", name.c_str(), c.width_px, c.height_px);
  std::printf(
      "  focal lengths    %.2f, %.2f pixels\n  principal point  %.2f, %.2f; the middle of the picture is %.1f, %.1f\n",
      c.fx, c.fy, c.cx, c.cy, 0.5 * right, 0.5 * bottom);
  std::printf("  lens             %s\n", text.substr(model + 18, text.find('\n', model) - model - 18).c_str());
  std::printf("  coefficients     %s\n",
              text.substr(text.find('[', model), text.rfind(']') + 1 - text.find('[', model)).c_str());
  std::printf("  field of view    %s degrees across, %s down, %s from corner to corner\n",
              angle_between(c, {0, c.cy}, {right, c.cy}).c_str(), angle_between(c, {c.cx, 0}, {c.cx, bottom}).c_str(),
              angle_between(c, {0, 0}, {right, bottom}).c_str());
  say_largest_distortion(c);
}

// Circles of equal angle from the axis each 10 degrees, and what is straight as the lens bends it.
cv::Mat drawn(const CameraModel& c) {
  cv::Mat out(c.height_px, c.width_px, CV_8UC3, cv::Scalar::all(255));
  const int thick = std::max(1, c.width_px / 640);
  const auto curve = [&](auto&& normalized_of, const cv::Scalar& color) {
    std::optional<cv::Point> last;
    for (int i = 0; i <= 720; ++i) {
      const Eigen::Vector2d px = c.pixel_from_normalized(c.distort_normalized(normalized_of(i / 720.0)));
      const bool near = px.allFinite() && px.cwiseAbs().maxCoeff() < 1e5;
      const std::optional<cv::Point> now =
          near ? std::optional(cv::Point(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y()))))
               : std::nullopt;
      if (last && now) cv::line(out, *last, *now, color, thick, cv::LINE_AA);
      last = now;
    }
  };
  constexpr double kWidest = 3;
  for (int i = -12; i <= 12; ++i) {
    const double at = 0.25 * i;
    curve([at](double t) { return Eigen::Vector2d(kWidest * (2 * t - 1), at); }, {190, 170, 150});
    curve([at](double t) { return Eigen::Vector2d(at, kWidest * (2 * t - 1)); }, {190, 170, 150});
  }
  for (int deg = 10; deg <= 80; deg += 10) {
    const double radius = std::tan(deg / kDegrees);
    const auto ring = [radius](double t) {
      return Eigen::Vector2d(radius * std::cos(2 * std::numbers::pi * t), radius * std::sin(2 * std::numbers::pi * t));
    };
    curve(ring, {60, 60, 200});
    const Eigen::Vector2d px = c.pixel_from_normalized(c.distort_normalized({radius, 0}));
    if (!c.contains_raw(px)) continue;
    cv::putText(out, std::to_string(deg), {static_cast<int>(px.x()) + 3, static_cast<int>(px.y()) - 3},
                cv::FONT_HERSHEY_SIMPLEX, 0.5 * thick, {60, 60, 200}, thick, cv::LINE_AA);
  }
  return out;
}

void save_drawing(const std::filesystem::path& file, const CameraModel& camera) {
  if (file.extension() != ".png") throw UsageError("--draw writes a PNG: " + file.string() + " has to end with .png");
  create_file(file);  // says why it cannot be there
  if (!write_image_file(file, drawn(camera))) throw UserError("cannot write " + file.string());
}

// What is read may hold more than what is written.
void refuse_to_replace(const CalibrationArguments& arguments) {
  std::error_code none;
  const std::string file = arguments.file.substr(0, arguments.file.find('#'));
  if (arguments.out.empty() || !std::filesystem::equivalent(file, arguments.out, none)) return;
  throw UsageError("--out " + arguments.out + " is the calibration itself: name another file");
}

int calibration(const CalibrationArguments& arguments) {
  refuse_to_replace(arguments);
  const auto [camera, doubt] = read_calibration(arguments.file);
  if (!doubt.text.empty()) log_warn(doubt.text + (doubt.hopeless ? " A run leaves it aside" : ""));
  if (!arguments.drawing.empty()) save_drawing(arguments.drawing, camera);
  if (arguments.dialect.empty()) {
    describe(arguments.file, camera);
    return 0;
  }
  const WrittenCalibration written = written_calibration(camera, arguments.dialect);
  if (!std::isfinite(written.miss_px))
    throw UserError(arguments.dialect + " has no lens that is anything like this one");
  if (camera.guessed() && arguments.dialect != "plain") {
    log_warn("this lens is not known: it is written as one without distortion");
  }
  if (written.miss_px > 0) {
    char miss[32];
    std::snprintf(miss, sizeof miss, "%.2g", written.miss_px);
    log_warn(arguments.dialect + " has no such lens: this is the nearest that it has, " + miss + " pixels off at most");
  }
  if (arguments.out.empty()) {
    std::fputs(written.text.c_str(), stdout);
    return 0;
  }
  auto stream = create_file(arguments.out);
  stream << written.text;
  close_file(stream, arguments.out);
  return 0;
}

}  // namespace

void add_calibration_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<CalibrationArguments>();
  CLI::App* command =
      app.add_subcommand("calibration", "Say what a calibration means, or write it for another program");
  command->add_option("FILE", arguments->file, "any that an agent takes; one of several: FILE#CAMERA")->required();
  CLI::Option* to = command->add_option("--to", arguments->dialect, "write it in this form")
                        ->check(CLI::IsMember(calibration_dialects()));
  command->add_option("--out", arguments->out, "to this file")->type_name("FILE")->needs(to);
  command
      ->add_option("--draw", arguments->drawing,
                   "picture of the field of view: a circle each 10 degrees, straight lines bent")
      ->type_name("FILE.png");
  command->callback([arguments, &chosen] { chosen = [arguments] { return calibration(*arguments); }; });
}

}  // namespace coslam
