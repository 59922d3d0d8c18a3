// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"

// Recordings of ROS 1, ROS 2 and Foxglove, whatever file or folder they lie in.
namespace coslam::recording {

struct Topic {
  std::string name;      // "/left/image_raw"
  std::string type;      // spelled as in the file: "sensor_msgs/msg/Image", "sensor_msgs/Image", "foxglove.RawImage"
  std::string encoding;  // encoding of the messages: "cdr", "ros1", "protobuf", "json"
  friend bool operator==(const Topic&, const Topic&) = default;
};

struct Message {
  TimeNs noted_ns = 0;  // when the recorder received it
  std::string octets;
};

// A recording, to be read from its start. All functions may throw UserError, one sentence that names the file. Not
// thread-safe.
class Recording {
 public:
  virtual ~Recording() = default;

  // Each name, type and encoding once.
  virtual const std::vector<Topic>& topics() const = 0;
  // Time when the first message of all topics was noted; 0: there is none.
  virtual TimeNs first_ns() const = 0;
  // A sentence when the recording was cut off or something of it is missing; the rest is read all the same.
  virtual const std::string& warning() const = 0;

  // Starts playing the messages of one of topics() from the beginning, in the order of the times at which they were
  // noted.
  virtual void play(std::size_t topic) = 0;
  // Next message; empty at the end. Throws UserError where the recording is damaged.
  virtual std::optional<Message> next() = 0;
};

// Opens a file, told by its first octets: MCAP, the SQLite of rosbag2 (.db3), a bag of ROS 1, and any of these
// compressed as a whole with zstd; or a folder of such files, whose metadata.yaml is followed where there is one.
// Throws UserError, one sentence: not there, of no kind that is read, damaged.
std::unique_ptr<Recording> open(const std::filesystem::path& path);

// Whether a path looks like something that open() reads: a file by its first octets (and, where it is compressed, its
// name), a folder with the metadata of rosbag2 or of nothing but such files.
bool is_recording(const std::filesystem::path& path);

}  // namespace coslam::recording
