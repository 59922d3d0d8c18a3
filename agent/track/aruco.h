// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#define COSLAM_OPENCV_SINCE(minor) (CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= (minor)))
#if COSLAM_OPENCV_SINCE(7)
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

// OpenCV's finder of printed tags, which has another module and other functions since version 4.7.
namespace coslam::aruco {

using Corners = std::vector<std::vector<cv::Point2f>>;
using Parameters = cv::aruco::DetectorParameters;

#if COSLAM_OPENCV_SINCE(7)

// OpenCV looks at all outlines that lie this close to each other, as a share of their length, the largest first.
inline constexpr double kCloseOutlines = 0.125;
using Dictionary = cv::aruco::Dictionary;

inline Dictionary dictionary_of(int family) { return cv::aruco::getPredefinedDictionary(family); }
inline int cells_a_side(const Dictionary& dictionary) { return dictionary.markerSize; }
inline void detect(const cv::Mat& grey, const Dictionary& dictionary, const Parameters& parameters, Corners* corners,
                   std::vector<int>* ids) {
  cv::aruco::ArucoDetector(dictionary, parameters).detectMarkers(grey, *corners, *ids);
}
// A pixel a cell, with the black border.
inline void draw(const Dictionary& dictionary, int id, cv::Mat* out) {
  cv::aruco::generateImageMarker(dictionary, id, dictionary.markerSize + 2, *out);
}

#else

// OpenCV keeps the largest of outlines that lie this close to each other: the edge of the paper, not the tag on it.
inline constexpr double kCloseOutlines = 0.01;
using Dictionary = cv::Ptr<cv::aruco::Dictionary>;

inline Dictionary dictionary_of(int family) { return cv::aruco::getPredefinedDictionary(family); }
inline int cells_a_side(const Dictionary& dictionary) { return dictionary->markerSize; }
inline void detect(const cv::Mat& grey, const Dictionary& dictionary, const Parameters& parameters, Corners* corners,
                   std::vector<int>* ids) {
  cv::aruco::detectMarkers(grey, dictionary, *corners, *ids, cv::makePtr<Parameters>(parameters));
}
// A pixel a cell, with the black border.
inline void draw(const Dictionary& dictionary, int id, cv::Mat* out) {
  cv::aruco::drawMarker(dictionary, id, dictionary->markerSize + 2, *out);
}

#endif

}  // namespace coslam::aruco
