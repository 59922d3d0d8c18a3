// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agent/track/image.h"
#include "common/base/time.h"

namespace coslam {

// Sequence of images of one camera.
class ImageSource {
 public:
  virtual ~ImageSource() = default;
  // Next image, blocking; empty at the end of the source. One that cannot be read, or that the source knows not to be
  // what the camera saw, comes with its fault and perhaps without pixels; it never is the end of the source.
  virtual std::optional<Image> next() = 0;
  // Moves over the next image without decoding it (its frame id is used up); false at the end.
  virtual bool skip() = 0;
  // Capture time of the next image without reading it; empty at the end or for live sources.
  virtual std::optional<TimeNs> peek_ns() const = 0;
  // The file that the next image is, of sources that are lists of them; empty: it is part of one, or of none. By
  // next() images are read ahead, and it is not known any more.
  virtual std::filesystem::path peek_file() const { return {}; }
  // Estimated number of images left, where that is known without going through them.
  virtual std::optional<int> about_left() const { return std::nullopt; }
  virtual bool live() const { return false; }
  // Images passed over so far, as they have no time of their own: no stamp, or one that is not later.
  virtual std::size_t undated() const { return 0; }
  // Makes a next() that waits for a live camera return empty soon after; callable from any thread, unlike the other
  // functions.
  virtual void stop() {}
};

struct SourceOptions {
  double start_s = 0;
  std::optional<double> duration_s;
  double rate_hz = 30;  // for image folders and videos without times
  int width_px = 0;     // width in the calibration: the first readable image must have this size; 0: any size
  int height_px = 0;
  std::string calibration;        // the file of that size, named when the size is another
  std::vector<TimeSpan> covered;  // played times at which the lens is covered: black images with noise, for trials
  bool color = false;             // images in colour too, of files and videos
  bool rate_is_given = true;      // false: rate_hz is a guess, which is said where it matters
};

// Frames with source time in [start_s, start_s + duration_s) are played, the first of them is frame 0. The source time
// is the one in the file; stamps in nanoseconds and UTC seconds count from the first image. Live sources play from now
// on and are reopened when they fail, except gst: pipelines, whose end is the end.
//
// Opens: a folder of images (<6 digits>.jpg|png with times.txt, or names that are nanoseconds), a `t_s,file` CSV, a
// video file (with an optional <file>.timestamps.csv), an EuRoC mav0 or camN folder, a TUM folder (rgb.txt),
// bag:PATH#TOPIC or mcap:PATH#TOPIC (a recording, see common/recording; times count from its start) or its path alone,
// ros2:/TOPIC (by the stamps of its messages), v4l2:N, gst:PIPELINE, rtsp://...
// Throws UserError: nothing there, no image readable, size not that of the calibration.
std::unique_ptr<ImageSource> open_source(const std::string& uri, const SourceOptions& options);

// Next image without a fault.
std::optional<Image> next_readable(ImageSource& source);

// Times of the images of a source that is a list of them.
struct ListedTimes {
  std::vector<std::optional<TimeNs>> source_ns;  // times by image; empty: it is left out
};
std::optional<ListedTimes> listed_times(const std::string& uri, double rate_hz);

// Zero of the times of a source, as they were written: UTC where they are dates or the stamps of a recording. 0: the
// times count from their own 0, or the zero is not known.
TimeNs written_zero_ns(const std::string& uri, double rate_hz);

// The file that tells most about how a source was taken: a video, or the first of its images. Empty: there is none, as
// of live sources.
std::filesystem::path first_file(const std::string& uri, double rate_hz);

// The file of times beside a video: clip.mp4.timestamps.csv or clip.timestamps.csv.
std::optional<std::filesystem::path> times_beside(const std::filesystem::path& video);

}  // namespace coslam
