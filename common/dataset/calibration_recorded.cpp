// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <iomanip>
#include <sstream>

#include "common/base/error.h"
#include "common/dataset/calibration_dialects.h"
#include "common/dataset/recorded_topic.h"
#include "common/recording/message_reader.h"
#include "common/ros/sensor_messages.h"

namespace coslam::calibration {
namespace {

template <class Numbers>
void put(std::ostream& out, const char* key, const Numbers& numbers) {
  out << key << ": [";
  for (std::size_t i = 0; i < numbers.size(); ++i) out << (i == 0 ? "" : ", ") << numbers[i];
  out << "]\n";
}

// The same in the form of a file, so that both are read by the same rules.
std::string as_file(const ros::CameraInfo& info) {
  std::ostringstream text;
  text << std::setprecision(17) << "width: " << info.width << "\nheight: " << info.height << "\ndistortion_model: \""
       << info.distortion_model << "\"\n";
  put(text, "k", info.k);
  put(text, "d", info.d);
  text << "binning_x: " << info.binning_x << "\nbinning_y: " << info.binning_y
       << "\nroi: {x_offset: " << info.roi.x_offset << ", y_offset: " << info.roi.y_offset
       << ", width: " << info.roi.width << ", height: " << info.roi.height << "}\n";
  return text.str();
}

}  // namespace

SensorCamera read_recorded(const RecordedTopic& topic) {
  const auto recording = recording::open(topic.path);
  const std::size_t place = find_topic(*recording, topic, Wanted::kLenses);
  const auto reader = recording::MessageReader::for_topic(recording->topics()[place]).value();
  recording->play(place);
  std::optional<ros::CameraInfo> first;
  while (auto message = recording->next()) {
    const auto info = reader.camera_info(reader.unpacked(std::move(message->octets)));
    if (info && info->k[0] != 0) return read_info(*info, topic.name());
    if (!first && !info) throw UserError(topic.name() + ": its first message is damaged");
    if (!first) first = info;
  }
  if (!first) throw UserError(topic.name() + ": there is no message of it in the recording");
  return read_info(*first, topic.name());
}

SensorCamera read_info(const ros::CameraInfo& info, const std::string& name) {
  std::istringstream text(as_file(info));
  return read_ros(YamlValue::parse(text, name));
}

}  // namespace coslam::calibration
