// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/core.hpp>
#include <sstream>
#include <string>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/dataset/calibration_dialects.h"

namespace coslam::calibration {
namespace {

void put_numbers(std::ostream& text, const cv::Mat& values) {
  text << "[";
  for (int i = 0; i < static_cast<int>(values.total()); ++i) {
    text << (i == 0 ? "" : ", ") << format_double(values.at<double>(i / values.cols, i % values.cols));
  }
  text << "]";
}

// A matrix is made as large as it says, whatever it holds.
bool holds_what_it_says(const cv::FileNode& matrix) {
  const double size = matrix["rows"].real() * matrix["cols"].real();
  return size > 0 && size == static_cast<double>(matrix["data"].size());
}

// A value as YAML has it; nothing for what no calibration goes by.
void put(std::ostream& text, const cv::FileNode& node) {
  if (node.isInt() || node.isReal()) {
    text << node.name() << ": " << format_double(node.real()) << "\n";
  } else if (node.isMap() && holds_what_it_says(node)) {
    cv::Mat values;
    node >> values;
    if (values.channels() != 1) return;
    values.convertTo(values, CV_64F);
    text << node.name() << ": {rows: " << values.rows << ", cols: " << values.cols << ", data: ";
    put_numbers(text, values);
    text << "}\n";
  }
}

}  // namespace

CameraModel read_opencv_xml(const std::filesystem::path& file) {
  std::ostringstream text;
  try {
    const cv::FileStorage storage(file.string(), cv::FileStorage::READ | cv::FileStorage::FORMAT_XML);
    for (const cv::FileNode& node : storage.root()) put(text, node);
  } catch (const cv::Exception& e) {
    throw UserError(file.string() + ": is no XML of OpenCV: " + e.err + "; " + kOtherForms);
  }
  if (text.str().empty()) throw UserError(file.string() + ": there is no camera in it");
  std::istringstream yaml(text.str());
  return read_opencv(YamlValue::parse(yaml, file.string()));
}

}  // namespace coslam::calibration
