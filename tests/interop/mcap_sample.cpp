// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// mcap_sample FILE: writes an MCAP file of known messages, for programs of others to read (mcap_sample.mjs).
#include <cstdio>
#include <fstream>
#include <string>

#include "common/mcap/writer.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/messages.h"
#include "common/ros/type.h"
#include "common/ros/views.h"

namespace coslam {
namespace {

constexpr int kInstants = 300;
constexpr TimeNs kPeriod_ns = 20'000'000;

class Sample {
 public:
  explicit Sample(mcap::Writer& writer) : writer_(writer) {}

  template <class T>
  void put(const char* topic, TimeNs t_ns, const T& message) {
    const ros::TypeText& type = ros::type_text<T>();
    const auto schema = writer_.add_schema(type.name, "ros2msg", type.schema);
    writer_.write(writer_.add_channel(topic, "cdr", schema), t_ns, ros::to_cdr(message));
  }
  void put_json(const char* topic, TimeNs t_ns, const std::string& json) {
    writer_.write(writer_.add_channel(topic, "json", 0), t_ns, json);
  }

 private:
  mcap::Writer& writer_;
};

ros::Odometry odometry(const ros::Header& header, const Rigid3& world_from_cam) {
  ros::Odometry odometry{header, "left/base_link", {}, {}};
  odometry.pose.pose = ros::pose_of(world_from_cam);
  for (std::size_t i = 0; i < 36; ++i) odometry.pose.covariance[i] = static_cast<double>(i);
  odometry.twist.twist.linear.z = 1.5;
  return odometry;
}

ros::CameraInfo camera_info(const ros::Header& header) {
  ros::CameraInfo info;
  info.header = header;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.d = {0.1, -0.2, 0, 0, 0.05};
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  return info;
}

ros::VehicleOdometry vehicle(TimeNs t_ns, float x) {
  ros::VehicleOdometry odometry;
  odometry.timestamp = static_cast<std::uint64_t>(t_ns / 1000);
  odometry.pose_frame = ros::VehicleOdometry::kFrd;
  odometry.position = {x, 2, 3};
  odometry.q = {1, 0, 0, 0};
  odometry.reset_counter = 7;
  odometry.quality = -1;
  return odometry;
}

// Message i is of the time i periods, and i stands in it.
void write_instant(Sample& sample, int i) {
  const TimeNs t_ns = i * kPeriod_ns;
  const ros::Header header = ros::header_of(t_ns, "map");
  const Rigid3 pose(so3_exp({0, 0, 0.01 * i}), {0.5 * i, 2, 3});
  const auto n = static_cast<float>(i);
  sample.put("/odom", t_ns, odometry(header, pose));
  sample.put("/tf", t_ns, ros::TFMessage{{{header, "left/camera_optical_frame", ros::transform_of(pose)}}});
  sample.put("/px4", t_ns, vehicle(t_ns, n));
  sample.put_json("/state", t_ns, "{\"i\":" + std::to_string(i) + "}");
  if (i % 10 != 0) return;
  const std::array<ros::StaticPoint, 2> points = {
      {{{n, 2, 3}, 0.5F, PointId(7), MapId(1), false, 9}, {{4, 5, 6}, 0.25F, PointId(8), MapId(2), true, 65535}}};
  sample.put("/cloud", t_ns, ros::static_cloud(header, points));
  const std::array<ros::MovingObject, 1> objects = {{{ObjectId(3), {1, 2, 3}, {0, 0.5, 0}, {0.5, 0.6, 1.7}}}};
  sample.put("/markers", t_ns, ros::object_markers(header, objects));
  sample.put("/detections", t_ns, ros::object_detections(header, objects));
  ros::Path path{header, {}};
  for (int k = 0; k <= i; ++k) path.poses.push_back({header, ros::pose_of({pose.rotation, {1.0 * k, 0, 0}})});
  sample.put("/path", t_ns, path);
  sample.put("/info", t_ns, camera_info(header));
  sample.put("/image", t_ns, ros::Image{header, 1, 3, "mono8", 0, 3, {1, 2, 3}});
  sample.put("/jpeg", t_ns, ros::CompressedImage{header, "jpeg", {9, 8}});
}

int run(const char* file) {
  std::ofstream stream(file, std::ios::binary);
  mcap::Writer writer([&](std::string_view octets) { stream << octets; }, {.chunk_bytes = 20'000});
  Sample sample(writer);
  for (int i = 0; i < kInstants; ++i) write_instant(sample, i);
  writer.close();
  return stream.flush() ? 0 : 1;
}

}  // namespace
}  // namespace coslam

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: mcap_sample FILE\n");
    return 2;
  }
  return coslam::run(argv[1]);
}
