// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// docs_inputs FOLDER: writes what the documents' commands read, under the names that the documents use. Two cameras,
// left and right, film one scene for two seconds, without sound; camera.mp4 is the left one's for a minute, in place of
// a camera at work; chessboard/ has a board of 8x6 inner corners.
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/system/small_scene.h"

namespace {

using coslam::test::SmallScene;
using std::filesystem::path;

constexpr int kFrames = 60;
constexpr int kFramesAtWork = 1800;

void film(const SmallScene& scene, int camera, int frames, const path& file) {
  cv::VideoWriter writer(file.string(), cv::VideoWriter::fourcc('m', 'p', '4', 'v'), SmallScene::kRate_hz, {320, 240});
  if (!writer.isOpened()) throw std::runtime_error("cannot write " + file.string());
  for (int f = 0; f < frames; ++f) writer.write(cv::imread(scene.image(camera, f), cv::IMREAD_COLOR));
}

// Seen from twelve places, tilted to all sides.
void chessboard(const path& folder) {
  constexpr int kColumns = 9, kRows = 7, kSquare_px = 40;  // squares
  cv::Mat board((kRows + 2) * kSquare_px, (kColumns + 2) * kSquare_px, CV_8U, cv::Scalar(230));
  for (int r = 0; r < kRows; ++r) {
    for (int c = r % 2; c < kColumns; c += 2)
      board(cv::Rect((c + 1) * kSquare_px, (r + 1) * kSquare_px, kSquare_px, kSquare_px)) = 25;
  }
  std::filesystem::create_directories(folder);
  const cv::Matx33d board_from_pixel(1, 0, -0.5 * board.cols, 0, 1, -0.5 * board.rows, 0, 0, 1);
  const cv::Matx33d camera(280, 0, 160, 0, 280, 120, 0, 0, 1);
  for (int i = 0; i < 12; ++i) {
    const double turn = 0.9 * i, tilt_x = 0.5 * std::sin(turn), tilt_y = 0.5 * std::cos(turn);
    const cv::Matx33d about_x(1, 0, 0, 0, std::cos(tilt_x), -std::sin(tilt_x), 0, std::sin(tilt_x), std::cos(tilt_x));
    const cv::Matx33d about_y(std::cos(tilt_y), 0, std::sin(tilt_y), 0, 1, 0, -std::sin(tilt_y), 0, std::cos(tilt_y));
    const cv::Matx33d turned = about_x * about_y;
    const double away = 620 + 30 * (i % 4);  // in pixels of the board
    const cv::Matx33d seen(turned(0, 0), turned(0, 1), 40 * std::sin(2.0 * i), turned(1, 0), turned(1, 1),
                           30 * std::cos(1.7 * i), turned(2, 0), turned(2, 1), away);
    cv::Mat picture;
    cv::warpPerspective(board, picture, camera * seen * board_from_pixel, {320, 240}, cv::INTER_AREA,
                        cv::BORDER_CONSTANT, 230);
    cv::imwrite((folder / (std::to_string(100 + i) + ".png")).string(), picture);
  }
}

void write_inputs(const path& folder) {
  const SmallScene scene(2, kFrames);
  const std::vector<std::string> names{"left", "right"};
  for (int camera = 0; camera < 2; ++camera) {
    const std::string& name = names[static_cast<std::size_t>(camera)];
    film(scene, camera, kFrames, folder / (name + ".mp4"));
    std::filesystem::copy_file(scene.calibration(), folder / (name + ".yaml"));
    std::filesystem::copy_file(scene.folder() / (SmallScene::name(camera) + ".tum"), folder / (name + ".tum"));
    std::filesystem::create_directories(folder / name);
    for (int f = 0; f < kFrames; ++f)
      std::filesystem::copy_file(scene.image(camera, f), folder / name / (std::to_string(1000 + f) + ".png"));
  }
  film(scene, 0, kFramesAtWork, folder / "camera.mp4");
  chessboard(folder / "chessboard");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::runtime_error("takes a folder");
    write_inputs(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "docs_inputs: " << error.what() << '\n';
    return 1;
  }
}
